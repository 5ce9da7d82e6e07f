# The GPU side: relumbre_cuda_module(NAME [DEPENDS modules...] [HOST modules...] [LINK libraries...]
#                                    [FULL sources...])
#
# NAME/*.cu is built twice. With RELUMBRE_CUDA, by nvcc: the static library relumbre_NAME_cuda and
# the test program NAME_cuda_test. With the tests, by the C++ compiler and the emulator of
# tests/emulator, which runs kernels on the CPU: NAME_emulated and NAME_emulated_test, so that every
# machine tests them.
#   DEPENDS  modules of which the GPU side is used
#   HOST     CPU modules that the GPU side needs; NAME itself is one where there is such a module
#   FULL     sources that need libraries which RELUMBRE_GPU_CHECK does without
# Tests named *_cuda_full_test.cu also compare with CPU code that needs libraries (Highway, Embree):
# they are left out where RELUMBRE_GPU_CHECK builds without those.
if(RELUMBRE_CUDA)
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES AND NOT DEFINED ENV{CUDAARCHS})
    set(CMAKE_CUDA_ARCHITECTURES 75 80 86 89 90)
  endif()
  enable_language(CUDA)
  if(NOT DEFINED CMAKE_CUDA20_STANDARD_COMPILE_OPTION) # older CMakes do not know that nvcc has it
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
    set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
  endif()
  set(CMAKE_CUDA_STANDARD 20)
  set(CMAKE_CUDA_STANDARD_REQUIRED ON)
  find_package(CUDAToolkit 12 REQUIRED)
  if(RELUMBRE_CCACHE)
    set(CMAKE_CUDA_COMPILER_LAUNCHER ${RELUMBRE_CCACHE})
  endif()

  # Products and sums are only fused where the source says so: then both sides agree.
  add_library(relumbre_cuda_options INTERFACE)
  target_compile_options(
    relumbre_cuda_options
    INTERFACE --expt-relaxed-constexpr --fmad=false -Xcudafe=--display_error_number
              -Xcompiler=-Wall,-Wextra,-Wshadow,-Wno-missing-field-initializers
              "$<$<BOOL:${RELUMBRE_WERROR}>:-Werror=all-warnings;-Xcompiler=-Werror>")
endif()

if(RELUMBRE_BUILD_TESTS AND NOT RELUMBRE_GPU_CHECK)
  find_package(Boost 1.71 REQUIRED COMPONENTS context)
  set(emulator ${PROJECT_SOURCE_DIR}/tests/emulator)
  add_library(emulator STATIC ${emulator}/emulator/machine.cpp ${emulator}/emulator/host_api.cpp)
  target_include_directories(emulator BEFORE PUBLIC ${emulator} ${PROJECT_SOURCE_DIR}/src)
  # "#pragma unroll"; sources that are included.
  target_compile_options(emulator INTERFACE -Wno-unknown-pragmas -Wno-subobject-linkage)
  target_link_libraries(emulator PUBLIC Boost::context PRIVATE relumbre_options)
endif()

# A C++ file for each of the sources, since a source has one language in all targets.
function(relumbre_wrap_cuda result name)
  set(wrappers)
  foreach(source ${ARGN})
    string(REGEX REPLACE "\\.cu$" ".cpp" wrapper ${PROJECT_BINARY_DIR}/emulated/${source})
    file(CONFIGURE OUTPUT ${wrapper} CONTENT "#include \"relumbre/@source@\"\n" @ONLY)
    list(APPEND wrappers ${wrapper})
  endforeach()
  set(${result} ${wrappers} PARENT_SCOPE)
endfunction()

function(relumbre_cuda_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;HOST;LINK;FULL" ${ARGN})
  set(folder ${PROJECT_SOURCE_DIR}/src/relumbre)
  file(GLOB sources RELATIVE ${folder} CONFIGURE_DEPENDS ${folder}/${name}/*.cu)
  set(tests ${sources})
  list(FILTER tests INCLUDE REGEX "_test\\.cu$")
  list(FILTER sources EXCLUDE REGEX "_test\\.cu$")
  if(RELUMBRE_GPU_CHECK)
    list(FILTER tests EXCLUDE REGEX "_full_test\\.cu$")
    list(TRANSFORM ARG_FULL PREPEND ${name}/)
    list(REMOVE_ITEM sources ${ARG_FULL} "")
  endif()
  set(kind STATIC)
  set(inherit PUBLIC)
  if(NOT sources) # templates alone
    set(kind INTERFACE)
    set(inherit INTERFACE)
  endif()
  list(TRANSFORM ARG_HOST PREPEND relumbre_)
  if(TARGET relumbre_${name})
    list(APPEND ARG_HOST relumbre_${name})
  endif()

  if(RELUMBRE_CUDA)
    set(cuda_sources ${sources})
    list(TRANSFORM cuda_sources PREPEND ${folder}/)
    set(cuda_tests ${tests})
    list(TRANSFORM cuda_tests PREPEND ${folder}/)
    set(depends ${ARG_DEPENDS})
    list(TRANSFORM depends PREPEND relumbre_)
    list(TRANSFORM depends APPEND _cuda)
    add_library(relumbre_${name}_cuda ${kind} ${cuda_sources})
    add_library(relumbre::${name}_cuda ALIAS relumbre_${name}_cuda)
    set_target_properties(relumbre_${name}_cuda PROPERTIES EXPORT_NAME ${name}_cuda)
    target_link_libraries(relumbre_${name}_cuda ${inherit} ${depends} ${ARG_HOST} CUDA::cudart_static ${ARG_LINK})
    if(sources)
      target_link_libraries(relumbre_${name}_cuda PRIVATE $<BUILD_INTERFACE:relumbre_cuda_options>)
    endif()
    target_include_directories(relumbre_${name}_cuda ${inherit} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                                                                $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    set_property(GLOBAL APPEND PROPERTY RELUMBRE_CUDA_MODULES ${name}_cuda)
    if(RELUMBRE_BUILD_TESTS AND tests)
      add_executable(${name}_cuda_test ${cuda_tests})
      target_link_libraries(${name}_cuda_test PRIVATE relumbre_${name}_cuda relumbre_cuda_options GTest::gtest_main)
      set_property(GLOBAL APPEND PROPERTY RELUMBRE_CUDA_TESTS ${name}_cuda_test)
      if(RELUMBRE_GPU_CHECK)
        add_test(NAME ${name}_cuda COMMAND ${name}_cuda_test)
      else()
        gtest_discover_tests(${name}_cuda_test TEST_PREFIX ${name}_cuda. DISCOVERY_TIMEOUT 60
                             PROPERTIES LABELS "cuda" TIMEOUT 600)
      endif()
    endif()
  endif()

  if(TARGET emulator)
    set(depends ${ARG_DEPENDS})
    list(TRANSFORM depends APPEND _emulated)
    relumbre_wrap_cuda(wrapped ${name} ${sources})
    add_library(${name}_emulated ${kind} EXCLUDE_FROM_ALL ${wrapped})
    target_link_libraries(${name}_emulated ${inherit} emulator ${depends} ${ARG_HOST})
    if(sources)
      target_link_libraries(${name}_emulated PRIVATE relumbre_options)
    endif()
    if(tests)
      relumbre_wrap_cuda(wrapped ${name} ${tests})
      add_executable(${name}_emulated_test ${wrapped})
      target_link_libraries(${name}_emulated_test PRIVATE ${name}_emulated relumbre_options GTest::gtest_main)
      gtest_discover_tests(${name}_emulated_test TEST_PREFIX ${name}_emulated. DISCOVERY_TIMEOUT 60
                           PROPERTIES LABELS "emulated" TIMEOUT 600)
    endif()
  endif()
endfunction()
