/// Neighbouring rays that go much the same way, as one beam: how far all of them go through empty
/// space.
///
/// Along the axis m on which they go farthest, the beam is a rectangle at every s, bounded by
/// straight lines from s = first to s = last: the least of straight lines is concave, so that it
/// lies above the chord between its ends, and the greatest below its own. The tree is searched slab
/// by slab in the order of s for the first child that the beam can touch.
///
/// What a ray pierces by grid_ray.h is within 2^-50 (|o| + edge) of the real line; for tame rays
/// that is far less than the beam's margin.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "relumbre/octree/grid_ray.h"
#include "relumbre/octree/voxel_tree.h"

namespace relumbre {

/// A tame ray and the part of it that counts: within the cube.
struct CubeRay {
  GridRay ray;
  Vec3d direction;
  double now = 0, end = 0;
  double spread = 0;  ///< see CastRay
};

namespace tree_beam_detail {

/// Children whose coordinate along an axis is in [from, to], by Morton code.
constexpr std::uint64_t children(std::size_t axis, unsigned from, unsigned to) {
  std::uint64_t mask = 0;
  for (unsigned bit = 0; bit < 64; ++bit) {
    const unsigned k = (bit >> axis & 1U) | (bit >> (axis + 3) & 1U) << 1;
    if (from <= k && k <= to) mask |= std::uint64_t{1} << bit;
  }
  return mask;
}

inline constexpr auto kChildren = [] {
  std::array<std::array<std::array<std::uint64_t, 4>, 4>, 3> table{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (unsigned from = 0; from < 4; ++from)
      for (unsigned to = from; to < 4; ++to) table[axis][from][to] = children(axis, from, to);
  return table;
}();

}  // namespace tree_beam_detail

class TreeBeam {
 public:
  /// Of at least one ray. Not a beam if they go apart.
  TreeBeam(const VoxelTree& tree, std::span<const CubeRay> rays) : tree_(tree) {
    const Vec3d d = rays[0].direction, size(std::abs(d.x), std::abs(d.y), std::abs(d.z));
    main_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    is_up_ = d[main_] > 0;
    is_beam_ = std::ranges::all_of(rays, [&](const CubeRay& ray) { return goes_along(ray); });
    if (is_beam_) bound(rays);
  }

  [[nodiscard]] bool is_beam() const { return is_beam_; }

  /// The plane of the main axis up to which all rays are in empty space; infinite if all of the
  /// beam is empty.
  [[nodiscard]] double first_plane() const {
    const double depth = first_in(0, 0, {}, kInfinity);
    return is_up_ ? depth : -depth;
  }

  /// When the ray passes that plane.
  [[nodiscard]] double time(const GridRay& ray, double plane) const {
    return (plane - ray.origin()[main_]) * ray.inverse()[main_];
  }

 private:
  static constexpr auto& kChildren = tree_beam_detail::kChildren;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr double kMargin = 0x1p-8;
  static constexpr std::uint32_t kFinest = 4;  ///< edge of the smallest children looked at

  [[nodiscard]] bool goes_along(const CubeRay& ray) const {
    const double main = is_up_ ? ray.direction[main_] : -ray.direction[main_];
    const double limit = 2 * main;
    return main > 0 && std::isfinite(ray.ray.inverse()[main_]) &&
           std::abs(ray.direction.x) <= limit && std::abs(ray.direction.y) <= limit &&
           std::abs(ray.direction.z) <= limit;
  }

  void bound(std::span<const CubeRay> rays) {
    first_ = kInfinity, last_ = -kInfinity;
    for (const CubeRay& r : rays) {
      const double o = r.ray.origin()[main_], d = r.direction[main_];
      first_ = std::min({first_, o + d * r.now, o + d * r.end});
      last_ = std::max({last_, o + d * r.now, o + d * r.end});
    }
    if (!(last_ - first_ > kMargin)) is_beam_ = false;
    for (std::size_t side = 0; side < 2; ++side) bound(rays, side);
    bound_footprint(rays);
  }

  /// The widest of the rays' footprints at every s is below its chord, like any greatest of lines.
  void bound_footprint(std::span<const CubeRay> rays) {
    double widest[2] = {0, 0};
    for (const CubeRay& r : rays)
      for (std::size_t end = 0; end < 2; ++end)
        widest[end] = std::max(widest[end], r.spread * time(r.ray, end == 0 ? first_ : last_));
    footprint_ = {widest[0], (widest[1] - widest[0]) / (last_ - first_)};
  }

  /// Whether some ray may take nodes of this size between two planes as they are.
  [[nodiscard]] bool may_be_within_footprint(double size, double from, double to) const {
    const double widest = std::max(footprint_.at(from - first_), footprint_.at(to - first_));
    return !(size > widest * (1 + 1e-9));  // NaN: maybe
  }

  void bound(std::span<const CubeRay> rays, std::size_t side) {
    const std::size_t axis = (main_ + 1 + side) % 3;
    double low[2] = {kInfinity, kInfinity}, high[2] = {-kInfinity, -kInfinity};  // at both ends
    for (const CubeRay& r : rays) {
      const double slope = r.direction[axis] * r.ray.inverse()[main_];
      for (std::size_t end = 0; end < 2; ++end) {
        const double s = end == 0 ? first_ : last_;
        const double point = r.ray.origin()[axis] + (s - r.ray.origin()[main_]) * slope;
        low[end] = std::min(low[end], point), high[end] = std::max(high[end], point);
      }
    }
    const double widest = std::max(high[0] - low[0], high[1] - low[1]);
    const auto edge = static_cast<double>(std::uint32_t{1} << tree_.depth());
    if (!(widest * 16 <= edge)) is_beam_ = false;
    const double length = last_ - first_;
    low_[side] = {low[0] - kMargin, (low[1] - low[0]) / length};
    high_[side] = {high[0] + kMargin, (high[1] - high[0]) / length};
  }

  /// A bound of the beam along s.
  struct Line {
    double first, slope;
    [[nodiscard]] double at(double s) const { return first + slope * s; }
  };

  /// Those that the beam can touch between two planes.
  [[nodiscard]] std::uint64_t touched(const Vec3d& lower, double size, double from,
                                      double to) const {
    const double per_size = 1 / size;
    std::uint64_t mask = ~std::uint64_t{0};
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t axis = (main_ + 1 + side) % 3;
      const Line &l = low_[side], &h = high_[side];
      const double low = std::min(l.at(from - first_), l.at(to - first_)) - lower[axis];
      const double high = std::max(h.at(from - first_), h.at(to - first_)) - lower[axis];
      if (!(low < 4 * size && high >= 0)) return 0;
      const auto index = [&](double x) { return static_cast<std::size_t>(x * per_size); };
      mask &= kChildren[axis][index(std::max(low, 0.0))][index(std::min(high, 3 * size))];
    }
    return mask;
  }

  /// The least depth, s or -s, of a touched child's near plane in a node; `least` if none is less.
  double first_in(unsigned level, std::uint64_t index, const Cell& lower, double least) const {
    const std::uint32_t size = std::uint32_t{1} << 2 * (tree_.levels() - 1 - level);
    const bool is_leaf = level + 1 == tree_.levels();
    const VoxelTree::Node node =
        is_leaf ? VoxelTree::Node{tree_.leaves()[index], 0} : tree_.nodes(level)[index];
    const Vec3d corner(lower.x, lower.y, lower.z);
    for (std::size_t slab = 0; slab < 4; ++slab) {
      const std::size_t k = is_up_ ? slab : 3 - slab;
      const double low = corner[main_] + static_cast<double>(k * size), high = low + size;
      const double depth = is_up_ ? low : -high;
      if (depth >= least) return least;
      const double from = std::max(low - kMargin, first_), to = std::min(high + kMargin, last_);
      if (from > to) continue;
      const std::uint64_t mask =
          node.mask & kChildren[main_][k][k] & touched(corner, size, from, to);
      if (mask == 0) continue;
      if (size <= kFinest || is_leaf || may_be_within_footprint(size, from, to)) return depth;
      for (std::uint64_t rest = mask; rest != 0; rest &= rest - 1)
        least = first_in_child(level, node, lower, size,
                               static_cast<unsigned>(std::countr_zero(rest)), least);
    }
    return least;
  }

  double first_in_child(unsigned level, const VoxelTree::Node& node, const Cell& lower,
                        std::uint32_t size, unsigned bit, double least) const {
    const Cell in = morton_decode(bit);
    return first_in(level + 1, node.first + VoxelTree::rank(node.mask, bit),
                    {lower.x + in.x * size, lower.y + in.y * size, lower.z + in.z * size}, least);
  }

  const VoxelTree& tree_;
  std::size_t main_ = 0;
  bool is_up_ = false, is_beam_ = false;
  double first_ = 0, last_ = 0;
  std::array<Line, 2> low_{}, high_{};
  Line footprint_{};
};

}  // namespace relumbre
