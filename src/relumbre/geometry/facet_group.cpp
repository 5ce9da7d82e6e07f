#include "relumbre/geometry/facet_group.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relumbre {
namespace {

constexpr std::size_t kAxes = 6;
constexpr std::size_t kDirections = 6;

/// The six directions are compared with unequal weights, so that walls at exactly 45 degrees to the
/// axes, which are common, are not torn apart by rounding.
constexpr Vec3f kAxisBias{1.0F, 0.93F, 0.87F};

std::uint32_t direction_of(const Vec3f& n) {
  const Vec3f size{std::abs(n.x) * kAxisBias.x, std::abs(n.y) * kAxisBias.y,
                   std::abs(n.z) * kAxisBias.z};
  const std::uint32_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return 2 * axis + (n[axis] < 0 ? 1 : 0);
}

float coordinate(const GroupItem& item, std::size_t axis) {
  return axis < 3 ? item.centroid[axis] : item.normal[axis - 3];
}

/// Area-weighted moments. Two passes: one would cancel far from the origin.
struct Moments {
  double area = 0;
  double own_inertia = 0;  ///< of the facets about their own centroids
  std::array<double, kAxes> mean{}, variance{};
  std::array<double, kDirections> direction_area{};

  explicit Moments(std::span<const GroupItem> items) {
    for (const GroupItem& item : items) {
      area += item.area;
      own_inertia += item.area * static_cast<double>(item.spread);
      direction_area[item.direction] += item.area;
      for (std::size_t i = 0; i < kAxes; ++i) mean[i] += item.area * double{coordinate(item, i)};
    }
    for (double& m : mean) m /= area;
    for (const GroupItem& item : items) {
      for (std::size_t i = 0; i < kAxes; ++i) {
        const double offset = double{coordinate(item, i)} - mean[i];
        variance[i] += item.area * offset * offset;
      }
    }
    for (double& v : variance) v /= area;
  }
};

/// The direction with the largest area among those whose opposite is there too; kDirections if
/// none.
std::size_t opposed_direction(const Moments& m) {
  std::size_t best = kDirections;
  for (std::size_t d = 0; d < kDirections; ++d) {
    const bool opposed = m.direction_area[d] > 0 && m.direction_area[d ^ 1] > 0;
    if (opposed && (best == kDirections || m.direction_area[d] > m.direction_area[best])) best = d;
  }
  return best;
}

template <class Predicate>
std::size_t part(std::span<GroupItem> items, Predicate in_first) {
  const auto middle = std::partition(items.begin(), items.end(), in_first);
  return static_cast<std::size_t>(middle - items.begin());
}

std::size_t divide_along(std::span<GroupItem> items, const Division& division) {
  for (const double threshold :
       {division.mean + division.margin, division.mean - division.margin}) {
    const std::size_t first = part(items, [&](const GroupItem& item) {
      return double{coordinate(item, division.axis)} <= threshold;
    });
    if (first != 0 && first != items.size()) return first;
  }
  return items.size() / 2;  // a variance that is nothing but rounding
}

}  // namespace

GroupItem::GroupItem(const FacetForest& forest, std::uint32_t cell_)
    : centroid(forest.centroid(cell_)),
      normal(forest.normal(cell_)),
      area(forest[cell_].area),
      spread(static_cast<float>(forest.spread(cell_))),
      cell(cell_),
      direction(direction_of(normal)) {}

Division measure(std::span<const GroupItem> items, double normal_scale) {
  Division division;
  if (items.size() == 1) {
    division.inertia = items[0].area * static_cast<double>(items[0].spread);
    return division;
  }
  const Moments moments(items);
  division.inertia = moments.own_inertia;
  double greatest = 0;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const double scale = axis < 3 ? 1 : normal_scale;
    const double variance = scale * scale * moments.variance[axis];
    division.inertia += moments.area * variance;
    if (!(variance > greatest)) continue;
    greatest = variance;
    division.rule = Division::Rule::kAlong;
    division.axis = axis;
    division.mean = moments.mean[axis];
    // Symmetric sets have facets exactly at the mean. The margin keeps these together whatever
    // their last bits are.
    division.margin = std::sqrt(moments.variance[axis]) / 1024;
  }
  const std::size_t opposed = opposed_direction(moments);
  if (opposed != kDirections) {
    division.rule = Division::Rule::kAside;
    division.direction = static_cast<std::uint32_t>(opposed);
  }
  return division;
}

std::size_t divide(std::span<GroupItem> items, const Division& division) {
  switch (division.rule) {
    case Division::Rule::kAlong:
      return divide_along(items, division);
    case Division::Rule::kAside:
      return part(items, [&](const GroupItem& i) { return i.direction == division.direction; });
    default:
      return items.size() / 2;
  }
}

}  // namespace relumbre
