#include "textbook_voxelizer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "relumbre/octree/morton.h"

namespace relumbre::bench {

namespace {

using Triangle = std::array<Vec3d, 3>;

bool separates(const Vec3d& axis, const Triangle& t, double reach) {
  const double a = dot(axis, t[0]), b = dot(axis, t[1]), c = dot(axis, t[2]);
  return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

/// The box is centred on the origin and one voxel wide.
bool overlaps(const Triangle& t) {
  const auto reach = [](const Vec3d& axis) {
    return 0.5 * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d edge = t[(i + 1) % 3] - t[i];
    for (const Vec3d& axis :
         {Vec3d(0, -edge.z, edge.y), Vec3d(edge.z, 0, -edge.x), Vec3d(-edge.y, edge.x, 0)})
      if (separates(axis, t, reach(axis))) return false;
  }
  for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
    if (separates(axis, t, 0.5)) return false;
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
  return std::abs(dot(normal, t[0])) <= reach(normal);
}

}  // namespace

std::vector<std::uint64_t> textbook_voxels(const TriangleMesh& mesh, const Cube& cube,
                                           unsigned depth) {
  std::vector<std::uint64_t> codes;
  const double last = std::ldexp(1.0, static_cast<int>(depth)) - 1;
  const auto cell = [last](double c) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(c), 0.0, last));
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle t;
    for (std::size_t v = 0; v < 3; ++v) t[v] = cube.to_voxels(Vec3d(mesh.corner(i, v)), depth);
    const Vec3d lower = min(t[0], min(t[1], t[2])), upper = max(t[0], max(t[1], t[2]));
    for (std::uint32_t z = cell(lower.z); z <= cell(upper.z); ++z) {
      for (std::uint32_t y = cell(lower.y); y <= cell(upper.y); ++y) {
        for (std::uint32_t x = cell(lower.x); x <= cell(upper.x); ++x) {
          const Vec3d center(x + 0.5, y + 0.5, z + 0.5);
          if (overlaps({t[0] - center, t[1] - center, t[2] - center}))
            codes.push_back(morton_encode({x, y, z}));
        }
      }
    }
  }
  std::ranges::sort(codes);
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  return codes;
}

}  // namespace relumbre::bench
