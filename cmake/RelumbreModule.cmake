# relumbre_module(NAME [DEPENDS modules...] [LINK libraries...] [PRIVATE libraries...])
#
# A folder is a target: every NAME/*.cpp becomes the static library relumbre_NAME
# (alias relumbre::NAME), every NAME/*_test.cpp the test program NAME_test.
function(relumbre_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;LINK;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${name}/*.cpp)
  file(GLOB tests CONFIGURE_DEPENDS ${name}/*_test.cpp)
  list(REMOVE_ITEM sources ${tests})
  if(RELUMBRE_STD_THREADS) # parallel_std.cpp implements parallel.h instead of parallel.cpp
    list(FILTER sources EXCLUDE REGEX "/parallel\\.cpp$")
  else()
    list(FILTER sources EXCLUDE REGEX "/parallel_std\\.cpp$")
  endif()
  list(TRANSFORM ARG_DEPENDS PREPEND relumbre_)

  add_library(relumbre_${name} STATIC ${sources})
  add_library(relumbre::${name} ALIAS relumbre_${name})
  set_target_properties(relumbre_${name} PROPERTIES EXPORT_NAME ${name} LINKER_LANGUAGE CXX)
  target_compile_features(relumbre_${name} PUBLIC cxx_std_20)
  target_include_directories(relumbre_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                                                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(relumbre_${name} PUBLIC ${ARG_DEPENDS} ${ARG_LINK}
                        PRIVATE $<BUILD_INTERFACE:relumbre_options> ${ARG_PRIVATE})
  set_property(GLOBAL APPEND PROPERTY RELUMBRE_MODULES ${name})

  if(RELUMBRE_BUILD_TESTS AND tests)
    add_executable(${name}_test ${tests})
    target_link_libraries(${name}_test PRIVATE relumbre_${name} relumbre_options GTest::gmock
                                               GTest::gtest_main)
    gtest_discover_tests(${name}_test TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
                         PROPERTIES LABELS ${name} TIMEOUT 600)
  endif()
endfunction()
