#include "relumbre/dof/skewed_outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relumbre {

namespace {

/// What differs by less is the same height, the same slope, or level.
constexpr double kSame = 1e-9;

std::size_t slope_index(std::vector<double>& slopes, double slope) {
  const auto found = std::ranges::find_if(
      slopes, [slope](double known) { return std::abs(known - slope) < kSame; });
  if (found != slopes.end()) return static_cast<std::size_t>(found - slopes.begin());
  slopes.push_back(slope);
  return slopes.size() - 1;
}

SkewedOutline::Level& level_at(std::vector<SkewedOutline::Level>& levels, double y) {
  const auto found = std::ranges::find_if(
      levels, [y](const SkewedOutline::Level& level) { return std::abs(level.y - y) < kSame; });
  if (found != levels.end()) return *found;
  return levels.emplace_back(SkewedOutline::Level{y, {}});
}

/// The polygon is convex and lies around (0, 0): an edge's middle tells its side.
void add_edge(SkewedOutline& outline, Vec2d top, Vec2d bottom) {
  if (std::abs(top.y - bottom.y) < kSame) return;
  if (top.y > bottom.y) std::swap(top, bottom);
  const double across = (bottom.x - top.x) / (bottom.y - top.y);
  const std::size_t slope = slope_index(outline.slopes, std::abs(across) < kSame ? 0.0 : across);
  const double side = top.x + bottom.x < 0 ? 1 : -1;
  SkewedOutline::Level& begin = level_at(outline.levels, top.y);
  begin.changes.push_back({slope, top.x, side, true});
  begin.begins = true;
  level_at(outline.levels, bottom.y).changes.push_back({slope, bottom.x, side, false});
}

}  // namespace

std::optional<SkewedOutline> skewed_outline(const OutlineCorners& corners) {
  if (corners.empty() || corners.size() % 2 != 0) return std::nullopt;
  SkewedOutline outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    add_edge(outline, a, b);
    outline.area += (a.x * b.y - b.x * a.y) / 2;
    outline.half_width = std::max(outline.half_width, std::abs(a.x));
    outline.half_height = std::max(outline.half_height, std::abs(a.y));
  }
  outline.area = std::abs(outline.area);
  const bool steep = std::ranges::any_of(
      outline.slopes, [](double slope) { return std::abs(slope) > SkewedOutline::kSteepest; });
  if (steep || outline.slopes.size() > SkewedOutline::kMostSlopes) return std::nullopt;
  return outline;
}

bool SkewedOutline::upright() const { return slopes.size() == 1 && slopes.front() == 0; }

}  // namespace relumbre
