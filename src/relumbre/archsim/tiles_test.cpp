#include "relumbre/archsim/tiles.h"

#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

TEST(Tiles, EdgeTilesAreSmaller) {
  const Tiles tiles(7, 5, 3, 1);
  EXPECT_EQ(tiles.count(), 6U);
  EXPECT_EQ(tiles.tile(0), (PixelRect{0, 0, 3, 3}));
  EXPECT_EQ(tiles.tile(2), (PixelRect{6, 0, 7, 3}));
  EXPECT_EQ(tiles.tile(5), (PixelRect{6, 3, 7, 5}));
}

TEST(Tiles, EveryPixelBelongsToOneUnit) {
  // Loops that left out the last row and column made the tile's size seem to matter.
  for (const std::uint32_t tile : {1U, 2U, 10U, 31U, 40U, 4'000'000'000U})
    for (const std::uint32_t units : {1U, 2U, 3U, 7U, 5000U}) {
      std::vector<int> owners(37 * 23);
      const Tiles tiles(37, 23, tile, units);
      for (std::uint32_t unit = 0; unit < units; ++unit)
        tiles.for_each_run(unit, [&](std::uint32_t y, std::uint32_t x0, std::uint32_t x1) {
          for (std::uint32_t x = x0; x < x1; ++x) ++owners[y * 37 + x];
        });
      EXPECT_EQ(owners, std::vector<int>(37 * 23, 1)) << tile << ", " << units;
    }
}

TEST(Tiles, UnitsOwnTheDefinitionsRuns) {
  const Tiles tiles(50, 30, 10, 4);  // 15 tiles
  for (std::uint32_t unit = 0; unit < 4; ++unit) {
    EXPECT_EQ(tiles.owned_by(unit).begin, unit * 15 / 4);
    EXPECT_EQ(tiles.owned_by(unit).end, (unit + 1) * 15 / 4);
  }
}

TEST(Tiles, SharesDoNotOverflow) {
  const Tiles tiles(4'000'000'000U, 4'000'000'000U, 1, Tiles::kMaxUnits);
  EXPECT_EQ(tiles.owned_by(Tiles::kMaxUnits - 1).end, 16'000'000'000'000'000'000U);
}

TEST(Tiles, RefuseWhatCannotBe) {
  EXPECT_THROW(Tiles(0, 1, 1, 1), ValueError);
  EXPECT_THROW(Tiles(1, 0, 1, 1), ValueError);
  EXPECT_THROW(Tiles(1, 1, 0, 1), ValueError);
  EXPECT_THROW(Tiles(1, 1, 1, 0), ValueError);
  EXPECT_THROW(Tiles(1, 1, 1, Tiles::kMaxUnits + 1), ValueError);
}

}  // namespace
}  // namespace relumbre
