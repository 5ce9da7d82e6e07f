/// Morton codes: the bits of a cell's coordinates, interleaved, so that an octant of the grid is a
/// run of codes.
///
///   code bit     ... 8  7  6   5  4  3   2  1  0
///   of           ... z2 y2 x2  z1 y1 x1  z0 y0 x0     bit 0 of an octant: upper half in x,
///                    octant    octant    octant       bit 1: in y, bit 2: in z
///
/// Source: Morton 1966.
#pragma once

#include <cstdint>
#include <span>

namespace relumbre {

/// Deepest level of any grid or octree: 2^20 cells per edge.
inline constexpr int kMaxDepth = 20;

/// A cell of a grid of 2^level cells per edge, counted from the minimum corner.
struct Cell {
  std::uint32_t x, y, z;
  friend constexpr bool operator==(const Cell&, const Cell&) = default;
};

namespace morton_detail {

/// abc → ..a..b..c, for 21 bits.
constexpr std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1F'FFFF;
  bits = (bits | bits << 32) & 0x001F'0000'0000'FFFF;
  bits = (bits | bits << 16) & 0x001F'0000'FF00'00FF;
  bits = (bits | bits << 8) & 0x100F'00F0'0F00'F00F;
  bits = (bits | bits << 4) & 0x10C3'0C30'C30C'30C3;
  return (bits | bits << 2) & 0x1249'2492'4924'9249;
}

/// ..a..b..c → abc; whatever is in the other bits is dropped.
constexpr std::uint32_t gather(std::uint64_t bits) {
  bits &= 0x1249'2492'4924'9249;
  bits = (bits | bits >> 2) & 0x10C3'0C30'C30C'30C3;
  bits = (bits | bits >> 4) & 0x100F'00F0'0F00'F00F;
  bits = (bits | bits >> 8) & 0x001F'0000'FF00'00FF;
  bits = (bits | bits >> 16) & 0x001F'0000'0000'FFFF;
  return static_cast<std::uint32_t>((bits | bits >> 32) & 0x1F'FFFF);
}

}  // namespace morton_detail

/// Coordinates below 2^21; higher bits are dropped.
constexpr std::uint64_t morton_encode(const Cell& cell) {
  using morton_detail::spread;
  return spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2;
}

/// The cell of a code below 2^63.
constexpr Cell morton_decode(std::uint64_t code) {
  using morton_detail::gather;
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

/// The same for many cells, by the instructions pdep and pext where the processor is fast at them.
/// One thread. Throws ShapeError where sizes differ.
void morton_encode(std::span<const Cell> cells, std::span<std::uint64_t> codes);
void morton_decode(std::span<const std::uint64_t> codes, std::span<Cell> cells);

}  // namespace relumbre
