# Language level, warnings and sanitizers, in one interface target that every module links.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(RELUMBRE_CCACHE ccache)
if(RELUMBRE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${RELUMBRE_CCACHE})
endif()

add_library(relumbre_options INTERFACE)
target_compile_options(relumbre_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                                  $<$<BOOL:${RELUMBRE_WERROR}>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # -Wrestrict: false alarms on std::string since GCC 12 (GCC bug 105651).
  # -Wmissing-field-initializers: designated initializers mean to leave the rest at its defaults.
  target_compile_options(relumbre_options INTERFACE -Wno-restrict -Wno-missing-field-initializers)
endif()
if(RELUMBRE_SANITIZE)
  target_compile_options(relumbre_options INTERFACE -fsanitize=${RELUMBRE_SANITIZE}
                                                    -fno-omit-frame-pointer)
  target_link_options(relumbre_options INTERFACE -fsanitize=${RELUMBRE_SANITIZE})
endif()
