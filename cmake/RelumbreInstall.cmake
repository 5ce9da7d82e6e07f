# One exported package: find_package(relumbre), link relumbre::relumbre (or single modules).
include(CMakePackageConfigHelpers)
get_property(modules GLOBAL PROPERTY RELUMBRE_MODULES)
get_property(cuda_modules GLOBAL PROPERTY RELUMBRE_CUDA_MODULES) # none without RELUMBRE_CUDA
list(TRANSFORM modules PREPEND relumbre_ OUTPUT_VARIABLE targets)
list(TRANSFORM cuda_modules PREPEND relumbre_ OUTPUT_VARIABLE cuda_targets)
list(APPEND targets ${cuda_targets})

add_library(relumbre INTERFACE)
add_library(relumbre::relumbre ALIAS relumbre)
target_link_libraries(relumbre INTERFACE ${targets})

install(TARGETS relumbre ${targets} EXPORT relumbreTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT relumbreTargets NAMESPACE relumbre:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/relumbre)
install(DIRECTORY src/relumbre DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h" PATTERN "*.cuh")
if(TARGET relumbre_program)
  install(TARGETS relumbre_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

configure_package_config_file(cmake/relumbreConfig.cmake.in ${PROJECT_BINARY_DIR}/relumbreConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/relumbre)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/relumbreConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/relumbreConfig.cmake ${PROJECT_BINARY_DIR}/relumbreConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/relumbre)
