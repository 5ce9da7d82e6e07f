#include "relumbre/octree/triangle_cells.h"

#include <cstdlib>

namespace relumbre {

TriangleCells::TriangleCells(const GridTriangle& triangle, unsigned size_bits,
                             Separating separating)
    : size_bits_(size_bits), separating_(separating) {
  set_bounds(triangle);
  set_plane(triangle);
  for (unsigned axis = 0; axis < 3; ++axis) set_projection(axis, triangle);
}

void TriangleCells::set_bounds(const GridTriangle& triangle) {
  const GridPoint lower = min(triangle[0], min(triangle[1], triangle[2]));
  const GridPoint upper = max(triangle[0], max(triangle[1], triangle[2]));
  const std::int64_t last = (std::int64_t{1} << (kGridBits - size_bits_)) - 1;
  for (std::size_t a = 0; a < 3; ++a) {
    // Closed cells: a coordinate between two of them touches both.
    bounds_.lower[a] = std::max<std::int64_t>(0, ((lower[a] - 1) >> size_bits_));
    bounds_.upper[a] = std::min(last, upper[a] >> size_bits_);
  }
}

void TriangleCells::set_plane(const GridTriangle& triangle) {
  const GridPoint n = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const GridPoint size(std::abs(n.x), std::abs(n.y), std::abs(n.z));
  axis_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const Wide at = Wide{n.x} * triangle[0].x + Wide{n.y} * triangle[0].y + Wide{n.z} * triangle[0].z;
  const Wide sum = Wide{n.x} + n.y + n.z, reach = Wide{size.x} + size.y + size.z;
  const Wide width = Wide{1} << size_bits_;
  // Both doubled, so that the half of a cell is a whole number.
  const Wide extent = separating_ == Separating::k26 ? reach : Wide{max_component(size)};
  plane_low_ = 2 * at - width * (sum + extent);
  plane_high_ = 2 * at - width * (sum - extent);
  normal_ = Vec3<Wide>(n) * (2 * width);
}

void TriangleCells::set_projection(unsigned axis, const GridTriangle& triangle) {
  const unsigned u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto edge = [&](std::size_t i) { return triangle[(i + 1) % 3] - triangle[i]; };
  const GridPoint e0 = edge(0), e1 = edge(1);
  // A triangle seen from its edge turns neither way. Its edges run forth and back, so their inner
  // sides have the segment in common whichever way is taken.
  const std::int64_t turn = e0[u] * e1[v] - e0[v] * e1[u] >= 0 ? 1 : -1;
  const std::int64_t width = std::int64_t{1} << size_bits_;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t a = -turn * edge(i)[v], b = turn * edge(i)[u];
    const std::int64_t reach = separating_ == Separating::k26 ? std::abs(a) + std::abs(b)
                                                              : std::max(std::abs(a), std::abs(b));
    sides_[axis][i] = {2 * width * a, 2 * width * b,
                       width * (a + b + reach) - 2 * (a * triangle[i][u] + b * triangle[i][v])};
  }
}

void TriangleCells::narrow_to_plane(std::int64_t u, std::int64_t v, std::int64_t& first,
                                    std::int64_t& last) const {
  const Wide along = normal_[axis_];
  if (along == 0) return;
  const Wide column = normal_[(axis_ + 1) % 3] * u + normal_[(axis_ + 2) % 3] * v;
  const double scale = 1 / static_cast<double>(along);
  const double a = static_cast<double>(plane_low_ - column) * scale;
  const double b = static_cast<double>(plane_high_ - column) * scale;
  // The quotients are right to far less than a cell.
  const auto low = static_cast<double>(first), high = static_cast<double>(last);
  first = static_cast<std::int64_t>(std::clamp(std::floor(std::min(a, b)), low, high + 1));
  last = static_cast<std::int64_t>(std::clamp(std::ceil(std::max(a, b)), low - 1, high));
}

}  // namespace relumbre
