#include "relumbre/octree/brick.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "relumbre/octree/clipped_triangle.h"
#include "relumbre/octree/morton.h"

namespace relumbre {

namespace {

std::uint32_t local_code(const GridPoint& cell, const GridPoint& lower) {
  const GridPoint local = cell - lower;
  return static_cast<std::uint32_t>(
      morton_encode({static_cast<std::uint32_t>(local.x), static_cast<std::uint32_t>(local.y),
                     static_cast<std::uint32_t>(local.z)}));
}
GridPoint cell_of(std::uint64_t code) {
  const Cell cell = morton_decode(code);
  return {cell.x, cell.y, cell.z};
}

/// Of a point in a triangle's plane: the weights of the second and third corner.
Vec2f barycentrics(const std::array<Vec3d, 3>& t, const Vec3d& p) {
  const Vec3d e1 = t[1] - t[0], e2 = t[2] - t[0], d = p - t[0], n = cross(e1, e2);
  const double scale = dot(n, n);
  if (!(scale > 0)) return {1.0F / 3, 1.0F / 3};
  const double u = std::clamp(dot(cross(d, e2), n) / scale, 0.0, 1.0);
  const double v = std::clamp(dot(cross(e1, d), n) / scale, 0.0, 1 - u);
  return {static_cast<float>(u), static_cast<float>(v)};
}

/// In voxels; for a triangle that only touches the voxel, the weight is next to nothing.
constexpr float kTouching = 1e-9F;

}  // namespace

GridTriangle grid_triangle(const TriangleMesh& mesh, const Cube& cube, std::size_t triangle) {
  return {cube.snap(mesh.corner(triangle, 0)), cube.snap(mesh.corner(triangle, 1)),
          cube.snap(mesh.corner(triangle, 2))};
}

BrickFiller::BrickFiller(const TriangleMesh& mesh, const Cube& cube, const VoxelizeConfig& config)
    : mesh_(mesh), cube_(cube), config_(config), masks_(kBlocks), first_(kBlocks) {}

VoxelBlocks BrickFiller::fill(std::uint64_t code, std::span<const std::uint32_t> triangles) {
  const GridPoint lower = cell_of(code) * std::int64_t{1 << kDepth};
  for (const std::uint32_t t : triangles) cover(lower, t);
  VoxelBlocks blocks = collect(code);
  if (config_.surface) blocks.value = values(lower, blocks.voxels());
  clear(blocks);
  return blocks;
}

void BrickFiller::cover(const GridPoint& lower, std::uint32_t triangle) {
  const TriangleCells cells(grid_triangle(mesh_, cube_, triangle), kGridBits - config_.depth,
                            config_.separating);
  const bool keep_hits = static_cast<bool>(config_.surface);
  const CellRange range{lower, lower + GridPoint((1 << kDepth) - 1)};
  cells.for_each(range, [&](const GridPoint& cell) {
    const std::uint32_t voxel = local_code(cell, lower);
    masks_[voxel / 64] |= std::uint64_t{1} << voxel % 64;
    if (keep_hits) hits_.push_back({voxel, triangle});
  });
}

VoxelBlocks BrickFiller::collect(std::uint64_t code) {
  VoxelBlocks blocks;
  std::uint32_t rank = 0;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    if (masks_[b] == 0) continue;
    blocks.code.push_back(code * kBlocks + b);
    blocks.mask.push_back(masks_[b]);
    first_[b] = rank;
    rank += static_cast<std::uint32_t>(std::popcount(masks_[b]));
  }
  return blocks;
}

std::vector<VoxelValue> BrickFiller::values(const GridPoint& lower, std::size_t voxels) {
  means_.assign(voxels, {});
  for (const Hit& hit : hits_) add_to_mean(lower, hit);
  std::vector<VoxelValue> values(voxels);
  for (std::size_t i = 0; i < voxels; ++i) values[i] = means_[i].value();
  return values;
}

void BrickFiller::add_to_mean(const GridPoint& lower, const Hit& hit) {
  std::array<Vec3d, 3> corners;
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = cube_.to_voxels(Vec3d(mesh_.corner(hit.triangle, i)), config_.depth);
  const Vec3d cell(lower + cell_of(hit.voxel));
  const ClippedTriangle part = clip_to_box(corners, cell, cell + Vec3d(1));
  const Vec2f at = barycentrics(corners, part.centroid);
  const SurfaceSample surface = config_.surface(hit.triangle, at.x, at.y);

  const std::uint64_t mask = masks_[hit.voxel / 64];
  const std::uint64_t before = mask & ((std::uint64_t{1} << hit.voxel % 64) - 1);
  const std::size_t rank = first_[hit.voxel / 64] + static_cast<std::size_t>(std::popcount(before));
  means_[rank].add(surface.color, surface.back, normalized(surface.normal),
                   static_cast<float>(part.area) + kTouching);
}

void BrickFiller::clear(const VoxelBlocks& blocks) {
  for (const std::uint64_t code : blocks.code) masks_[code % kBlocks] = 0;
  hits_.clear();
}

}  // namespace relumbre
