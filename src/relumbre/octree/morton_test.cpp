#include "relumbre/octree/morton.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

constexpr std::uint32_t kEdge = 1U << kMaxDepth;

/// A bit at a time.
std::uint64_t slow_encode(const Cell& cell) {
  std::uint64_t code = 0;
  for (unsigned bit = 0; bit < 21; ++bit)
    code |= std::uint64_t{cell.x >> bit & 1U} << (3 * bit) |
            std::uint64_t{cell.y >> bit & 1U} << (3 * bit + 1) |
            std::uint64_t{cell.z >> bit & 1U} << (3 * bit + 2);
  return code;
}

std::vector<Cell> random_cells(std::size_t count) {
  std::mt19937_64 random(count);
  std::uniform_int_distribution<std::uint32_t> uniform(0, kEdge - 1);
  std::vector<Cell> cells(count);
  for (Cell& cell : cells) cell = {uniform(random), uniform(random), uniform(random)};
  return cells;
}

TEST(Morton, BitsOfAnOctantAreXThenYThenZ) {
  EXPECT_EQ(morton_encode(Cell{1, 0, 0}), 1U);
  EXPECT_EQ(morton_encode(Cell{0, 1, 0}), 2U);
  EXPECT_EQ(morton_encode(Cell{0, 0, 1}), 4U);
  EXPECT_EQ(morton_encode(Cell{2, 1, 3}), 0b101'110U);
  EXPECT_EQ(morton_encode(Cell{kEdge - 1, kEdge - 1, kEdge - 1}), (1ULL << 60) - 1);
}

TEST(Morton, EqualsABitAtATimeAndDecodesToItself) {
  for (const Cell& cell : random_cells(20'000)) {
    ASSERT_EQ(morton_encode(cell), slow_encode(cell));
    ASSERT_EQ(morton_decode(morton_encode(cell)), cell);
  }
}

TEST(Morton, NeighbouringBitsDoNotMix) {
  for (unsigned bit = 0; bit < 21; ++bit) {
    const std::uint32_t one = 1U << bit;
    for (const Cell cell : {Cell{one, 0, 0}, Cell{0, one, 0}, Cell{0, 0, one}}) {
      EXPECT_EQ(morton_encode(cell), slow_encode(cell));
      EXPECT_EQ(morton_decode(slow_encode(cell)), cell);
    }
  }
}

TEST(Morton, ManyAtOnceEqualOneByOne) {
  for (const std::size_t size : {0U, 1U, 7U, 1009U}) {
    const std::vector<Cell> cells = random_cells(size);
    std::vector<std::uint64_t> codes(size);
    morton_encode(cells, codes);
    for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(codes[i], morton_encode(cells[i]));
    std::vector<Cell> decoded(size);
    morton_decode(codes, decoded);
    EXPECT_EQ(decoded, cells);
  }
}

TEST(Morton, ManyAtOnceDropTheSameBitsAsOneByOne) {
  const std::vector<Cell> cells{{0xFFFF'FFFF, 0, 0x8020'0001}, {0x20'0000, 0x1F'FFFF, 7}};
  std::vector<std::uint64_t> codes(2);
  morton_encode(cells, codes);
  EXPECT_EQ(codes, (std::vector{morton_encode(cells[0]), morton_encode(cells[1])}));
}

TEST(Morton, UnequalSizesAreRefused) {
  std::vector<Cell> cells(3);
  std::vector<std::uint64_t> codes(2);
  EXPECT_THROW(morton_encode(cells, codes), ShapeError);
  EXPECT_THROW(morton_decode(codes, cells), ShapeError);
}

}  // namespace
}  // namespace relumbre
