# The GPU sides of the modules in src/relumbre, lowest first.
relumbre_cuda_module(cuda HOST base)
relumbre_cuda_module(scan DEPENDS cuda)
relumbre_cuda_module(sat DEPENDS scan)
relumbre_cuda_module(dof DEPENDS sat)
relumbre_cuda_module(octree DEPENDS cuda)
relumbre_cuda_module(visibility DEPENDS cuda)
relumbre_cuda_module(radiosity DEPENDS visibility scan LINK CUDA::cublas FULL relight_operator_cuda.cu)

if(RELUMBRE_CUDA)
  get_property(tests GLOBAL PROPERTY RELUMBRE_CUDA_TESTS)
  add_custom_target(gpu_tests DEPENDS ${tests})
endif()
if(TARGET emulator)
  add_executable(emulator_test ${PROJECT_SOURCE_DIR}/tests/emulator/emulator_test.cpp)
  target_link_libraries(emulator_test PRIVATE cuda_emulated relumbre_options GTest::gtest_main)
  gtest_discover_tests(emulator_test TEST_PREFIX emulator. DISCOVERY_TIMEOUT 60 PROPERTIES LABELS "emulated"
                       TIMEOUT 600)
endif()
