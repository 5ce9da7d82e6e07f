/// Location codes: one integer that names a node of an octree, level and place. No pointers: family
/// and neighbours are arithmetic.
///
///   root 1, child = (code << 3) | octant:    1 ooo ooo ... ooo
///                                            │ └ Morton code of the node's cell at its level
///                                            └ marks the level: its bit index is 3·level
///
/// Functions take valid codes (is_location_code) of levels 0 to kMaxDepth. Source: Gargantini 1982;
/// neighbours by dilated integers, Schrack 1992.
#pragma once

#include <bit>
#include <cassert>
#include <cstdint>
#include <optional>

#include "relumbre/octree/morton.h"

namespace relumbre {

using LocationCode = std::uint64_t;

inline constexpr LocationCode kRootCode = 1;

/// A run of codes of one level, or of Morton codes; both ends belong to it.
struct CodeRange {
  std::uint64_t first = 0, last = 0;
  friend constexpr bool operator==(const CodeRange&, const CodeRange&) = default;
};

/// Which of its two neighbours along an axis.
enum class Side { kLower, kUpper };

constexpr int level_of(LocationCode code) { return (63 - std::countl_zero(code)) / 3; }

constexpr bool is_location_code(std::uint64_t code) {
  return code != 0 && level_of(code) <= kMaxDepth && code >> 3 * level_of(code) == 1;
}

constexpr LocationCode child_of(LocationCode code, unsigned octant) { return code << 3 | octant; }
/// 0 for the root, which has none.
constexpr LocationCode parent_of(LocationCode code) { return code >> 3; }
constexpr unsigned octant_of(LocationCode code) { return static_cast<unsigned>(code & 7); }

/// The node itself at its own level. `level` must not be deeper.
constexpr LocationCode ancestor_of(LocationCode code, int level) {
  assert(level >= 0 && level <= level_of(code));
  return code >> 3 * (level_of(code) - level);
}

/// All descendants at a level, which must not be higher than the node's own.
constexpr CodeRange descendants_of(LocationCode code, int level) {
  assert(level >= level_of(code) && level <= kMaxDepth);
  const int shift = 3 * (level - level_of(code));
  return {code << shift, ((code + 1) << shift) - 1};
}

/// The node of a Morton code at a level, and back.
constexpr LocationCode location_code(int level, std::uint64_t morton) {
  return std::uint64_t{1} << 3 * level | morton;
}
constexpr LocationCode location_code(int level, const Cell& cell) {
  return location_code(level, morton_encode(cell));
}
constexpr std::uint64_t morton_of(LocationCode code) {
  return code ^ std::uint64_t{1} << 3 * level_of(code);
}
constexpr Cell cell_of(LocationCode code) { return morton_decode(morton_of(code)); }

/// The node of the same level beyond a face (axis 0, 1, 2), none outside the root. In place among
/// the interleaved bits: with ones in the bits of the other axes a carry runs through them, with
/// zeros a borrow does.
constexpr std::optional<LocationCode> face_neighbour(LocationCode code, int axis, Side side) {
  const int level = level_of(code);
  const std::uint64_t all = (std::uint64_t{1} << 3 * level) - 1;
  const std::uint64_t mine = all & (0x1249'2492'4924'9249ULL << axis);
  const std::uint64_t one = std::uint64_t{1} << axis, here = code & mine;
  const bool at_edge = side == Side::kUpper ? here == mine : here == 0;
  if (at_edge) return std::nullopt;
  const std::uint64_t moved = side == Side::kUpper ? (code | ~mine) + one : here - one;
  return (code & ~mine) | (moved & mine);
}

}  // namespace relumbre
