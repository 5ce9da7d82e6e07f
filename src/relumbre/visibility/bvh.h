/// A compact bounding volume hierarchy over triangles that CPU and GPU traverse alike.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/geometry/triangle_mesh.h"

namespace relumbre {

/// An inner node of up to eight children, 80 bytes. A child is a node, or a leaf of one to three
/// triangles. Boxes lie on a grid of 256 cells a side from `origin` on, rounded outwards; a cell's
/// side is 2^(exponent - 127). Source: Ylitie, Karras and Laine 2017, §3.
///
///   word   0             1                2                   3
///   0      origin x      origin y         origin z            exponent x y z | inner
///   1      first_child   first_triangle   meta 0-3            meta 4-7
///   2      lower x 0-3   lower x 4-7      lower y 0-3         lower y 4-7
///   3      lower z 0-3   lower z 4-7      upper x 0-3         upper x 4-7
///   4      upper y 0-3   upper y 4-7      upper z 0-3         upper z 4-7
///
///   meta of slot s    a node    001 | 24 + s
///                     a leaf    001, 011 or 111: one, two or three triangles | which is the first
///                     empty     0
///
/// So (meta >> 5) << (meta & 31), summed over the children that a ray meets, is a set of bits: the
/// upper 8 are nodes, the lower 24 triangles. Nodes are numbered in the order of their slots. Slots
/// are chosen so that those whose bits are 0 lie towards the lower ends of x, y and z.
struct alignas(16) BvhNode {
  std::array<float, 3> origin;
  std::array<std::uint8_t, 3> exponent;
  std::uint8_t inner;  ///< bit s: slot s holds a node
  std::uint32_t first_child;
  std::uint32_t first_triangle;
  std::array<std::uint8_t, 8> meta;
  std::array<std::array<std::uint8_t, 8>, 3> lower;
  std::array<std::array<std::uint8_t, 8>, 3> upper;
};
static_assert(sizeof(BvhNode) == 80);

/// A triangle as a traversal reads it, 48 bytes.
struct alignas(16) BvhTriangle {
  std::array<float, 3> a;
  std::uint32_t index;  ///< in the mesh
  std::array<float, 3> b;
  std::uint32_t unused1;
  std::array<float, 3> c;
  std::uint32_t unused2;
};
static_assert(sizeof(BvhTriangle) == 48);

struct Bvh {
  /// A traversal's stack is never deeper than that, whatever the mesh.
  static constexpr std::size_t kMaxDepth = 48;
  static constexpr std::size_t kMaxTriangles = std::size_t{1} << 28;

  std::vector<BvhNode> nodes;  ///< the root first; never empty
  std::vector<BvhTriangle> triangles;
  std::size_t depth = 0;  ///< levels of nodes

  [[nodiscard]] std::size_t bytes() const {
    return nodes.size() * sizeof(BvhNode) + triangles.size() * sizeof(BvhTriangle);
  }
};

/// Splits by the surface area heuristic in 16 bins an axis, to depth kMaxDepth at most, then merges
/// binary nodes into wide ones, always opening the largest. The same for any number of threads.
/// Triangles with a corner that is not finite, or beyond 10^18, are left out, so that no ray meets
/// them; nor do rays meet triangles without area. Throws ValueError if a triangle refers to a
/// position that is not there, or for more than kMaxTriangles. O(triangles · log triangles); about
/// 110 bytes a triangle meanwhile.
Bvh build_bvh(const TriangleMesh& mesh);

/// Throws ValueError if a triangle refers to a position that is not there.
void check_positions(const TriangleMesh& mesh);

}  // namespace relumbre
