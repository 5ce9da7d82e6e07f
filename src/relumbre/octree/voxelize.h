/// From triangles to voxels.
///
/// A voxel at depth D is there if a triangle covers it, by one of the definitions of
/// triangle_cells.h: exactly, whatever the order of the triangles and the number of threads. Its
/// colour and normal are the means of the triangles' parts within it, weighted by their areas.
///
/// The cube is cut into bricks of 64³ voxels. Each brick's triangles are listed, lists are sorted
/// by the bricks' Morton codes (radix_sort), and bricks are filled one by one on all threads, so
/// that voxels come out in the order of their Morton codes. Where the lists would take more than
/// `list_bytes`, the cube is worked through in several passes, each a run of Morton codes.
///
/// Source: Schwarz and Seidel 2010, "Fast Parallel Surface and Solid Voxelization on GPUs", for the
/// tests and for working in two levels.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/octree/cube.h"
#include "relumbre/octree/triangle_cells.h"
#include "relumbre/octree/voxel_blocks.h"

namespace relumbre {

/// A brick's number must fit 32 bits beside its depth.
inline constexpr unsigned kMaxVoxelDepth = 16;

struct SurfaceSample {
  Rgb color;                               ///< linear; radiosity may be stored as it is
  Vec3f normal;                            ///< of any length
  std::optional<Rgb> back = std::nullopt;  ///< from the other side, if that can be seen
};
/// The surface at barycentrics (u, v) of a triangle: the weights of its second and third vertex.
/// Called by several threads at once.
using SurfaceSampler = std::function<SurfaceSample(std::uint32_t triangle, float u, float v)>;

struct VoxelizeConfig {
  unsigned depth = 8;  ///< 2^depth voxels a side, at most kMaxVoxelDepth
  Separating separating = Separating::k26;
  SurfaceSampler surface;  ///< without one, voxels have no values
  std::uint64_t list_bytes = std::uint64_t{1} << 30;
};

/// Takes blocks as they come, in ascending order over all calls; only by one thread at a time.
using VoxelSink = std::function<void(VoxelBlocks&& blocks)>;

struct VoxelizeReport {
  std::uint64_t voxels = 0;
  std::uint64_t passes = 0;
};

/// Throws ValueError for a depth that is too large and for vertices that are not finite.
/// Progress counts bricks' lists.
VoxelizeReport voxelize(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config,
                        const VoxelSink& sink, Progress& progress = no_progress());

/// All blocks at once.
VoxelBlocks voxelize(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config,
                     Progress& progress = no_progress());

/// What a run will take; from the triangles' areas, so more where they are smaller than voxels or
/// lie one in the other, and less where triangles' outlines count.
struct VoxelizeEstimate {
  std::uint64_t voxels = 0;
  std::uint64_t memory_bytes = 0;  ///< of an RloWriter and of the smallest lists, beside the mesh
  std::uint64_t disk_bytes = 0;    ///< of the file
};
VoxelizeEstimate estimate_voxelize(const TriangleMesh& mesh, const Cube& cube,
                                   const VoxelizeConfig& config);

/// The estimate counts on lists of so many bytes.
inline constexpr std::uint64_t kLeastListBytes = std::uint64_t{64} << 20;

}  // namespace relumbre
