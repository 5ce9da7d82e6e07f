/// Which cells of a grid a triangle covers (see separating.h): exact, in integers.
///
/// Triangles without area count as the segment or the point that they are.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "relumbre/octree/cube.h"
#include "relumbre/octree/separating.h"

namespace relumbre {

/// Vertices on the grid, in [0, 2^kGridBits].
using GridTriangle = std::array<GridPoint, 3>;

/// Cells lower ≤ c ≤ upper on every axis; empty where lower > upper.
struct CellRange {
  GridPoint lower, upper;
};

/// The cells that are 2^size_bits units wide and closed, and one triangle.
class TriangleCells {
 public:
  TriangleCells(const GridTriangle& triangle, unsigned size_bits, Separating separating);

  /// Those that the triangle's bounding box touches, within the cube.
  [[nodiscard]] const CellRange& bounds() const { return bounds_; }

  /// Whether the triangle covers a cell of bounds().
  [[nodiscard]] bool covers(const GridPoint& cell) const {
    return meets_plane(cell) && in_projection(0, cell) && in_projection(1, cell) &&
           in_projection(2, cell);
  }

  /// Calls visit(cell) for each cell of `range` that the triangle covers.
  template <class Visit>
  void for_each(const CellRange& range, Visit&& visit) const;

 private:
  __extension__ using Wide = __int128;  // of 83 bits

  /// u·a + v·b + c ≥ 0 for the cells (u, v) on the inner side of an edge's projection, 55 bits.
  struct Side {
    std::int64_t a = 0, b = 0, c = 0;
    [[nodiscard]] std::int64_t at(std::int64_t u, std::int64_t v) const {
      return u * a + v * b + c;
    }
  };

  void set_bounds(const GridTriangle& triangle);
  void set_plane(const GridTriangle& triangle);
  void set_projection(unsigned axis, const GridTriangle& triangle);

  [[nodiscard]] bool meets_plane(const GridPoint& cell) const {
    const Wide at = normal_.x * cell.x + normal_.y * cell.y + normal_.z * cell.z;
    return at <= plane_high_ && at >= plane_low_;
  }
  [[nodiscard]] bool in_projection(unsigned axis, const GridPoint& cell) const {
    const std::int64_t u = cell[(axis + 1) % 3], v = cell[(axis + 2) % 3];
    return std::ranges::all_of(sides_[axis], [&](const Side& side) { return side.at(u, v) >= 0; });
  }
  /// Cells of one column along the dominant axis that the plane may meet: a superset.
  void narrow_to_plane(std::int64_t u, std::int64_t v, std::int64_t& first,
                       std::int64_t& last) const;

  unsigned size_bits_;
  Separating separating_;
  CellRange bounds_;
  Vec3<Wide> normal_;  // times twice a cell's width
  Wide plane_low_, plane_high_;
  std::array<std::array<Side, 3>, 3> sides_;  // of the projection along each axis
  unsigned axis_;                             // the normal's longest
};

template <class Visit>
void TriangleCells::for_each(const CellRange& range, Visit&& visit) const {
  const GridPoint lower = max(range.lower, bounds_.lower), upper = min(range.upper, bounds_.upper);
  const unsigned u_axis = (axis_ + 1) % 3, v_axis = (axis_ + 2) % 3;
  GridPoint cell;
  for (std::int64_t v = lower[v_axis]; v <= upper[v_axis]; ++v) {
    for (std::int64_t u = lower[u_axis]; u <= upper[u_axis]; ++u) {
      cell[u_axis] = u, cell[v_axis] = v;
      if (!in_projection(axis_, cell)) continue;
      std::int64_t first = lower[axis_], last = upper[axis_];
      narrow_to_plane(u, v, first, last);
      for (std::int64_t w = first; w <= last; ++w) {
        cell[axis_] = w;
        if (meets_plane(cell) && in_projection(u_axis, cell) && in_projection(v_axis, cell))
          visit(cell);
      }
    }
  }
}

}  // namespace relumbre
