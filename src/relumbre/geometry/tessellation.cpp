#include "relumbre/geometry/tessellation.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/descend.h"
#include "relumbre/geometry/facet_forest.h"
#include "relumbre/geometry/grouping.h"

namespace relumbre {
namespace {

constexpr std::size_t kMaxElements = std::size_t{1} << 27;

void check(const TriangleMesh& mesh, const TessellationConfig& config) {
  const std::size_t k = config.patches, n = config.elements;
  if (k == 0) throw ValueError("patches: 0 asked, at least 1 is needed");
  if (n < k) throw ValueError(fmt::format("elements: {} asked, fewer than {} patches", n, k));
  if (n > kMaxElements) {
    throw ValueError(fmt::format("elements: {} asked, the limit is {}", n, kMaxElements));
  }
  if (!config.separate.empty() && config.separate.size() != mesh.triangles.size()) {
    throw ShapeError(fmt::format("separate: {} labels for {} triangles", config.separate.size(),
                                 mesh.triangles.size()));
  }
}

std::vector<Facet> make_facets(const FacetForest& forest, const Grouping& grouping) {
  std::vector<Facet> facets;
  facets.reserve(grouping.leaves.size());
  for (const std::uint32_t leaf : grouping.leaves) {
    const auto& cell = forest[leaf];
    facets.push_back({cell.corners, cell.side / 2, cell.side % 2});
  }
  return facets;
}

/// Area, centroid and normal of every element.
void measure_elements(const FacetForest& forest, const Grouping& grouping, Tessellation& result) {
  const std::size_t n = grouping.facet_offsets.size() - 1;
  result.area.reserve(n), result.centroid.reserve(n), result.normal.reserve(n);
  for (std::size_t e = 0; e < n; ++e) {
    double area = 0;
    Vec3d moment, normal;
    std::uint32_t largest = grouping.leaves[grouping.facet_offsets[e]];
    for (std::uint32_t f = grouping.facet_offsets[e]; f < grouping.facet_offsets[e + 1]; ++f) {
      const std::uint32_t leaf = grouping.leaves[f];
      area += forest[leaf].area;
      moment += forest.centroid(leaf) * forest[leaf].area;
      normal += Vec3d(forest.normal(leaf)) * forest[leaf].area;
      if (forest[leaf].area > forest[largest].area) largest = leaf;
    }
    // A closed surface has no mean normal: what is left is rounding.
    const bool cancels = length(normal) < 1e-4 * area;
    result.area.push_back(static_cast<float>(area));
    result.centroid.emplace_back(moment / area);
    result.normal.push_back(cancels ? forest.normal(largest) : Vec3f(normalized(normal)));
  }
}

/// Numbers the inner cells in depth-first order.
struct LocatorBuilder {
  const FacetForest& forest;
  std::vector<std::uint32_t> facet_of_cell;
  std::vector<std::int32_t> nodes{};

  std::int32_t copy(std::uint32_t cell) {
    const std::uint32_t children = forest[cell].children;
    if (children == 0) return ~static_cast<std::int32_t>(facet_of_cell[cell]);
    const std::size_t block = nodes.size();
    nodes.resize(block + 4);
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::int32_t child = copy(children + i);
      nodes[block + i] = child;
    }
    return static_cast<std::int32_t>(block / 4);
  }
};

FacetLocator make_locator(const FacetForest& forest, const Grouping& grouping) {
  LocatorBuilder builder{forest, std::vector<std::uint32_t>(forest.size())};
  for (std::size_t f = 0; f < grouping.leaves.size(); ++f) {
    builder.facet_of_cell[grouping.leaves[f]] = static_cast<std::uint32_t>(f);
  }
  std::vector<std::int32_t> roots(2 * forest.triangles(), FacetLocator::kMissing);
  for (std::uint32_t side = 0; side < forest.sides(); ++side) {
    roots[forest[side].side] = builder.copy(side);
  }
  return {std::move(roots), std::move(builder.nodes)};
}

/// Elements of less area than float can tell from 0 would be divided by later.
void check_areas(const Tessellation& result) {
  for (const float area : result.area) {
    if (!(area > 0 && std::isfinite(area))) {
      throw ValueError(
          fmt::format("elements: one has area {}: the mesh's scale is not in metres", area));
    }
  }
}

Tessellation assemble(const FacetForest& forest, Grouping grouping) {
  Tessellation result;
  result.facets = make_facets(forest, grouping);
  result.locator = make_locator(forest, grouping);
  measure_elements(forest, grouping, result);
  check_areas(result);
  result.positions = forest.positions();
  result.facet_offsets = std::move(grouping.facet_offsets);
  result.patch_offsets = std::move(grouping.patch_offsets);
  return result;
}

/// For ascending offsets of segments: the segment of every entry.
std::vector<std::uint32_t> segment_of_entry(std::span<const std::uint32_t> offsets) {
  std::vector<std::uint32_t> segment;
  if (!offsets.empty()) segment.reserve(offsets.back());
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    segment.insert(segment.end(), offsets[i + 1] - offsets[i], static_cast<std::uint32_t>(i));
  }
  return segment;
}

}  // namespace

std::uint32_t Tessellation::locate(std::uint32_t triangle, bool back, float u, float v) const {
  const std::int32_t root = locator.roots[2 * std::size_t{triangle} + (back ? 1 : 0)];
  if (root == FacetLocator::kMissing) return kNone;
  if (back) std::swap(u, v);
  return static_cast<std::uint32_t>(~descend(locator.nodes.data(), root, u, v));
}

std::vector<std::uint32_t> Tessellation::element_of_facet() const {
  return segment_of_entry(facet_offsets);
}

std::vector<std::uint32_t> Tessellation::patch_of_element() const {
  return segment_of_entry(patch_offsets);
}

Tessellation tessellate(const TriangleMesh& mesh, const TessellationConfig& config) {
  check(mesh, config);
  FacetForest forest(mesh);
  const bool hierarchy = config.method == PatchMethod::kHierarchy;
  return assemble(
      forest, hierarchy ? group_by_hierarchy(forest, config) : group_by_clusters(forest, config));
}

}  // namespace relumbre
