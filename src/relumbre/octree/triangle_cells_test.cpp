#include "relumbre/octree/triangle_cells.h"

#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

__extension__ using Wide = __int128;
using WideVector = std::array<Wide, 3>;
using CellSet = std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>>;

Wide along(const WideVector& axis, const WideVector& p) {
  return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
}
WideVector crossed(const WideVector& a, const WideVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Whether an axis separates the triangle's shadow on it from the cell's.
bool separates(const WideVector& axis, const std::array<WideVector, 3>& triangle,
               const std::vector<WideVector>& corners) {
  Wide low = along(axis, triangle[0]), high = low;
  for (const WideVector& p : triangle)
    low = std::min(low, along(axis, p)), high = std::max(high, along(axis, p));
  Wide cell_low = along(axis, corners[0]), cell_high = cell_low;
  for (const WideVector& p : corners)
    cell_low = std::min(cell_low, along(axis, p)), cell_high = std::max(cell_high, along(axis, p));
  return low > cell_high || cell_low > high;
}

/// The closed box's corners, or the octahedron's.
std::vector<WideVector> corners_of(const GridPoint& cell, Wide width, Separating separating) {
  std::vector<WideVector> corners;
  for (int c = 0; c < 8 && separating == Separating::k26; ++c) {
    corners.push_back({(2 * cell.x + 2 * (c & 1)) * width, (2 * cell.y + (c & 2)) * width,
                       (2 * cell.z + (c & 4) / 2) * width});
  }
  for (std::size_t f = 0; f < 6 && separating == Separating::k6; ++f) {
    WideVector p = {(2 * cell.x + 1) * width, (2 * cell.y + 1) * width, (2 * cell.z + 1) * width};
    p[f / 2] += f % 2 == 0 ? width : -width;
    corners.push_back(p);
  }
  return corners;
}

/// Whether the cell's shadow lies beyond edge i's, seen from the triangle.
bool beyond_edge(const WideVector& axis, const std::array<WideVector, 3>& triangle, std::size_t i,
                 const std::vector<WideVector>& corners) {
  const Wide edge = along(axis, triangle[i]), opposite = along(axis, triangle[(i + 2) % 3]);
  const auto is_below = [&](const WideVector& p) { return along(axis, p) < edge; };
  const auto is_above = [&](const WideVector& p) { return along(axis, p) > edge; };
  return (opposite >= edge && std::ranges::all_of(corners, is_below)) ||
         (opposite <= edge && std::ranges::all_of(corners, is_above));
}

/// Separating axes, one after another: the cell's three, the plane's normal, and the normals of the
/// edges' projections (for the thin test on their outer sides only, as published). Coordinates are
/// doubled, so that centres are whole numbers.
bool slowly_covered(const GridTriangle& triangle, const GridPoint& cell, unsigned size_bits,
                    Separating separating) {
  std::array<WideVector, 3> t, edges;
  for (std::size_t i = 0; i < 3; ++i)
    t[i] = {2 * Wide{triangle[i].x}, 2 * Wide{triangle[i].y}, 2 * Wide{triangle[i].z}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t a = 0; a < 3; ++a) edges[i][a] = (t[(i + 1) % 3][a] - t[i][a]) / 2;
  const auto corners = corners_of(cell, Wide{1} << size_bits, separating);
  if (separates(crossed(edges[0], edges[1]), t, corners)) return false;
  for (const WideVector& unit : {WideVector{1, 0, 0}, WideVector{0, 1, 0}, WideVector{0, 0, 1}}) {
    if (separates(unit, t, corners)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      const WideVector axis = crossed(edges[i], unit);
      if (separating == Separating::k26 ? separates(axis, t, corners)
                                        : beyond_edge(axis, t, i, corners))
        return false;
    }
  }
  return true;
}

CellSet slow_cells(const GridTriangle& triangle, unsigned depth, Separating separating) {
  CellSet cells;
  const std::int64_t width = std::int64_t{1} << depth;
  for (std::int64_t x = 0; x < width; ++x)
    for (std::int64_t y = 0; y < width; ++y)
      for (std::int64_t z = 0; z < width; ++z)
        if (slowly_covered(triangle, {x, y, z}, kGridBits - depth, separating))
          cells.emplace(x, y, z);
  return cells;
}

CellSet fast_cells(const GridTriangle& triangle, unsigned depth, Separating separating) {
  CellSet cells;
  const TriangleCells covered(triangle, kGridBits - depth, separating);
  covered.for_each(covered.bounds(), [&](const GridPoint& c) {
    EXPECT_TRUE(cells.emplace(c.x, c.y, c.z).second);
    EXPECT_TRUE(covered.covers(c));
  });
  return cells;
}

void expect_same_cells(const GridTriangle& triangle, unsigned depth) {
  for (const Separating separating : {Separating::k6, Separating::k26}) {
    EXPECT_EQ(fast_cells(triangle, depth, separating), slow_cells(triangle, depth, separating))
        << "depth " << depth << (separating == Separating::k6 ? ", thin" : ", conservative");
  }
}

/// On a lattice of 2^-bits of the cube: coarse ones touch many faces, edges and corners.
GridTriangle random_triangle(RandomStream& random, unsigned bits) {
  GridTriangle triangle;
  for (GridPoint& p : triangle) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto k =
          static_cast<std::int64_t>(random.uniform() * static_cast<float>((1 << bits) + 1));
      p[a] = std::min<std::int64_t>(k, 1 << bits) << (kGridBits - bits);
    }
  }
  return triangle;
}

TEST(TriangleCells, AreThoseThatNoAxisSeparates) {
  RandomStream random(5);
  for (int i = 0; i < 60; ++i) {
    expect_same_cells(random_triangle(random, 20), 3);
    expect_same_cells(random_triangle(random, 22), 4);
  }
}

TEST(TriangleCells, AreExactWhereVerticesLieOnFacesEdgesAndCorners) {
  RandomStream random(6);
  for (int i = 0; i < 150; ++i) {
    for (const unsigned bits : {1U, 2U, 3U, 4U})
      expect_same_cells(random_triangle(random, bits), 3);
  }
}

TEST(TriangleCells, SegmentsAndPointsCountAsSuch) {
  RandomStream random(7);
  for (int i = 0; i < 60; ++i) {
    GridTriangle t = random_triangle(random, i % 2 == 0 ? 3 : 20);
    t[2] = t[0];
    expect_same_cells(t, 3);
    t[2] = {(t[0].x + t[1].x) / 2, (t[0].y + t[1].y) / 2, (t[0].z + t[1].z) / 2};
    expect_same_cells(t, 3);
    t[1] = t[2] = t[0];
    expect_same_cells(t, 3);
  }
}

TEST(TriangleCells, AWallBetweenCellsTouchesBothSides) {
  constexpr std::int64_t half = std::int64_t{1} << (kGridBits - 1), whole = 2 * half;
  const GridTriangle wall{{{half, 0, 0}, {half, whole, 0}, {half, 0, whole}}};
  EXPECT_EQ(fast_cells(wall, 1, Separating::k26).size(), 8U);  // the last two by a corner
  for (const auto& [x, y, z] : fast_cells(wall, 1, Separating::k6)) EXPECT_LT(y + z, 2) << x;
}

TEST(TriangleCells, OneCellHoldsAllAtDepthZero) {
  RandomStream random(8);
  for (int i = 0; i < 10; ++i) expect_same_cells(random_triangle(random, 26), 0);
}

}  // namespace
}  // namespace relumbre
