#include "relumbre/octree/location_code.h"

#include <array>
#include <random>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

std::mt19937_64& stream() {
  static std::mt19937_64 random(5);
  return random;
}

LocationCode random_code(int level) {
  return location_code(level, stream()() & ((std::uint64_t{1} << 3 * level) - 1));
}

TEST(LocationCode, RootIsOneAndItsOwnOnlyAncestor) {
  EXPECT_EQ(level_of(kRootCode), 0);
  EXPECT_EQ(cell_of(kRootCode), Cell{});
  EXPECT_EQ(parent_of(kRootCode), 0U);
  EXPECT_EQ(ancestor_of(kRootCode, 0), kRootCode);
}

TEST(LocationCode, ParentUndoesChild) {
  for (int level = 0; level < kMaxDepth; ++level)
    for (unsigned octant = 0; octant < 8; ++octant) {
      const LocationCode code = random_code(level), child = child_of(code, octant);
      EXPECT_EQ(level_of(child), level + 1);
      EXPECT_EQ(parent_of(child), code);
      EXPECT_EQ(octant_of(child), octant);
      const Cell parent_cell = cell_of(code);
      EXPECT_EQ(cell_of(child),
                (Cell{2 * parent_cell.x + (octant & 1), 2 * parent_cell.y + (octant >> 1 & 1),
                      2 * parent_cell.z + (octant >> 2)}));
    }
}

TEST(LocationCode, CellAndLevelGiveTheCodeBack) {
  for (int level = 0; level <= kMaxDepth; ++level) {
    const LocationCode code = random_code(level);
    EXPECT_TRUE(is_location_code(code));
    EXPECT_EQ(location_code(level_of(code), cell_of(code)), code);
    EXPECT_EQ(location_code(level_of(code), morton_of(code)), code);
  }
}

TEST(LocationCode, DescendantsAreThoseWhoseAncestorItIs) {
  for (const int level : {0, 1, 2})
    for (int i = 0; i < 8; ++i) {
      const LocationCode code = random_code(level);
      for (int deeper = level; deeper <= 4; ++deeper) {
        const CodeRange range = descendants_of(code, deeper);
        for (LocationCode d = location_code(deeper, 0); level_of(d) == deeper; ++d)
          ASSERT_EQ(ancestor_of(d, level) == code, range.first <= d && d <= range.last);
      }
    }
}

TEST(LocationCode, DescendantsOfTheRootAreAWholeLevel) {
  const CodeRange deepest = descendants_of(kRootCode, kMaxDepth);
  EXPECT_EQ(deepest, (CodeRange{1ULL << 60, (1ULL << 61) - 1}));
}

std::optional<LocationCode> slow_neighbour(LocationCode code, int axis, Side side) {
  const int level = level_of(code);
  const Cell cell = cell_of(code);
  std::array<std::int64_t, 3> at{cell.x, cell.y, cell.z};
  std::int64_t& along = at[static_cast<std::size_t>(axis)];
  along += side == Side::kUpper ? 1 : -1;
  if (along < 0 || along >= std::int64_t{1} << level) return std::nullopt;
  return location_code(level,
                       Cell{static_cast<std::uint32_t>(at[0]), static_cast<std::uint32_t>(at[1]),
                            static_cast<std::uint32_t>(at[2])});
}

TEST(LocationCode, FaceNeighboursDifferByOneAlongTheAxis) {
  for (int level = 0; level <= kMaxDepth; ++level)
    for (int i = 0; i < 200; ++i) {
      const std::uint64_t last = (std::uint64_t{1} << 3 * level) - 1;
      const LocationCode code = i == 0   ? location_code(level, 0)
                                : i == 1 ? location_code(level, last)
                                         : random_code(level);
      for (int axis = 0; axis < 3; ++axis)
        for (const Side side : {Side::kLower, Side::kUpper})
          ASSERT_EQ(face_neighbour(code, axis, side), slow_neighbour(code, axis, side))
              << code << " axis " << axis;
    }
}

TEST(LocationCode, AnythingElseIsNoLocationCode) {
  for (const std::uint64_t code : {0ULL, 2ULL, 4ULL, 7ULL, 16ULL, 63ULL, 1ULL << 61, 1ULL << 63})
    EXPECT_FALSE(is_location_code(code)) << code;
}

}  // namespace
}  // namespace relumbre
