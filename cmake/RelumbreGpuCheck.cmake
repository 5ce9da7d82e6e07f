# The GPU side's tests and benchmarks on a machine that has the CUDA toolkit and a C++ compiler, and
# none of the libraries: of every module those CPU sources that need none, and tests/bare in place of
# GoogleTest and {fmt}.
set(RELUMBRE_CUDA ON)
set(RELUMBRE_BUILD_TESTS ON)
enable_testing()
find_package(Threads REQUIRED)

add_library(bare_gtest STATIC tests/bare/main.cpp)
target_include_directories(bare_gtest SYSTEM PUBLIC tests/bare)
add_library(GTest::gtest_main ALIAS bare_gtest)

# relumbre_portable(NAME SOURCES sources... DEPENDS modules...)
function(relumbre_portable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND src/relumbre/${name}/)
  list(TRANSFORM ARG_DEPENDS PREPEND relumbre_)
  add_library(relumbre_${name} STATIC ${ARG_SOURCES})
  target_include_directories(relumbre_${name} PUBLIC src)
  target_include_directories(relumbre_${name} SYSTEM PUBLIC tests/bare)
  target_link_libraries(relumbre_${name} PUBLIC ${ARG_DEPENDS} Threads::Threads PRIVATE relumbre_options)
endfunction()

relumbre_portable(base SOURCES atomic_file.cpp atomic_stream.cpp content_hash.cpp huge_array.cpp mapped_file.cpp
                               parallel_std.cpp progress.cpp sampling.cpp)
relumbre_portable(scan SOURCES ../../../tests/bare/scan_kernels.cpp DEPENDS base)
relumbre_portable(sat SOURCES fixed_point.cpp sat_layout.cpp DEPENDS base)
relumbre_portable(image SOURCES image.cpp thin_lens.cpp DEPENDS base)
relumbre_portable(dof SOURCES aperture_kernel.cpp blur_steps.cpp depth_layers.cpp depth_picture.cpp focus.cpp fragments.cpp
                              infill.cpp mixed_pixel.cpp outline.cpp picture_channels.cpp revealed.cpp
                              skewed_outline.cpp spread.cpp surface_edges.cpp
                  DEPENDS image)
relumbre_portable(geometry SOURCES cluster.cpp facet.cpp facet_forest.cpp facet_group.cpp hierarchy.cpp
                                   label_locator.cpp position_index.cpp tessellation.cpp
                  DEPENDS base)
relumbre_portable(octree SOURCES brick.cpp brick_lists.cpp clipped_triangle.cpp cube.cpp morton.cpp rlo_file.cpp
                                 triangle_cells.cpp voxel_tree.cpp voxel_tree_builder.cpp voxel_value.cpp voxelize.cpp
                  DEPENDS geometry scan)
relumbre_portable(visibility SOURCES bvh.cpp bvh_binary.cpp bvh_tracer.cpp ray_scene.cpp DEPENDS geometry)
relumbre_portable(radiosity SOURCES emitting_surface.cpp form_factor_rows.cpp operator_input.cpp ray_pattern.cpp
                                    relight_operator.cpp scalar_form_factors.cpp sparse_counts.cpp
                  DEPENDS visibility)

include(RelumbreCuda)
include(RelumbreCudaModules)
add_subdirectory(benchmarks/cuda)
