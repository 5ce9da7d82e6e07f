/// The quadtrees of a mesh's sides while they are being cut.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "relumbre/geometry/position_index.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre {

/// One quadtree a side: the front of every triangle, and its back where it is two-sided.
///
///        c                 cells: [root of side 0][root of side 1] ... [4 children][4 children]
///        ...
///       / \                children are consecutive: corner a, corner b, corner c, middle
///      / 2 \               the back side of (a, b, c) is the side (a, c, b)
///    ca-----bc
///    / \ 3 / \             .
///   / 0 \ / 1 \            .
///  a-----ab----b
class FacetForest {
 public:
  struct Cell {
    Index3 corners;              ///< into positions(), in the side's own orientation
    std::uint32_t side = 0;      ///< 2 * triangle + back
    std::uint32_t children = 0;  ///< index of the first of four; 0 for a leaf
    double area = 0;             ///< the side's area / 4^depth: all of one depth are exactly equal
  };

  /// Throws ValueError for an empty mesh, too many sides (2^28), an index out of range, or a
  /// triangle without a finite positive area; ShapeError if two_sided is neither empty nor one a
  /// triangle. O(sides).
  explicit FacetForest(const TriangleMesh& mesh);

  /// Cells [0, sides()) are the roots, in the order of their sides.
  [[nodiscard]] std::uint32_t sides() const { return sides_; }
  [[nodiscard]] std::size_t triangles() const { return normals_.size(); }
  [[nodiscard]] const Cell& operator[](std::uint32_t cell) const { return cells_[cell]; }
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] const std::vector<Vec3f>& positions() const { return points_.positions(); }

  /// Cuts a leaf 4-way at its edges' midpoints and returns the first child; nothing, and the leaf
  /// stays whole, if it is so small that rounding moves a midpoint onto another corner.
  std::optional<std::uint32_t> cut(std::uint32_t cell);

  /// Appends the leaves under a cell, depth first.
  void append_leaves(std::uint32_t cell, std::vector<std::uint32_t>& leaves) const;

  /// Unit, pointing to where the cell's side reflects.
  [[nodiscard]] Vec3f normal(std::uint32_t cell) const;
  [[nodiscard]] Vec3d centroid(std::uint32_t cell) const;
  /// Mean squared distance of a cell's points from its centroid: the sum of its squared edges / 36.
  [[nodiscard]] double spread(std::uint32_t cell) const;
  /// Sum of all sides' areas.
  [[nodiscard]] double area() const;

 private:
  void add_side(const Index3& corners, std::size_t triangle, std::uint32_t back, double area);

  PositionIndex points_;
  std::vector<Cell> cells_;
  std::vector<Vec3f> normals_;  ///< per triangle, of the front
  std::uint32_t sides_ = 0;
};

}  // namespace relumbre
