# Every third-party package, found once; modules link the targets named here.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(assimp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(BLAS REQUIRED)
find_package(Boost 1.71 REQUIRED) # only Boost.Math's headers
find_path(RELUMBRE_TOMLPLUSPLUS toml++/toml.h REQUIRED) # headers only
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)

# Embree 4 where the system has it, else 3: visibility/embree.h hides the difference.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()
message(STATUS "Embree ${embree_VERSION}")
