#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/sat/sat_chain_cuda.cuh"
#include "relumbre/sat/sat_table_cuda.h"
#include "relumbre/sat/test_images.h"
#include "relumbre/sat/tile_order_cuda.cuh"

namespace relumbre::cuda {
namespace {

struct Size {
  std::size_t width, height;
};
std::string text(const Size& s, std::size_t channels) {
  return std::to_string(s.width) + " x " + std::to_string(s.height) + " x " +
         std::to_string(channels);
}

/// Wide, high, smaller than a tile, several tiles, none whole.
const std::vector<Size> kSizes = {{1, 1},   {5, 3},    {64, 64},  {65, 33},
                                  {63, 65}, {300, 70}, {37, 270}, {16, 5}};

template <class In, class T>
struct Built {
  SatLayout layout;
  std::vector<T> table;
  unsigned long long first_outside;
};

template <class T, class In>
Built<In, T> build(const std::vector<In>& image, const Size& size, std::size_t channels,
                   const SatSummands<In>& summands, ScanScratch& scratch, const Stream& stream,
                   std::size_t offset = 0) {
  Built<In, T> built{make_sat_layout(size.width, size.height, channels, sizeof(T)), {}, 0};
  DeviceArray<In> pixels(image.size() + offset);
  copy_to_device(image, pixels.data() + offset, stream);
  const DeviceArray<T> table(built.layout.elements);
  std::vector<unsigned long long> first = {~0ULL};
  const auto outside = to_device(std::span<const unsigned long long>(first), stream);
  build_sat_table(pixels.data() + offset, built.layout, summands, table.data(), outside.data(),
                  scratch, stream);
  built.table.resize(built.layout.elements);
  copy_to_host(table.data(), built.table, stream);
  copy_to_host(outside.data(), first, stream);
  stream.wait();
  built.first_outside = first[0];
  return built;
}

/// t(x, y) for all x and y, from plain loops.
template <class T, class In, class Summand>
std::vector<T> twin(const std::vector<In>& image, const SatLayout& layout, const Summand& summand) {
  const std::size_t c = layout.channels, w = layout.width, h = layout.height;
  std::vector<T> sums((w + 1) * (h + 1) * c, T{});
  for (std::size_t y = 0; y < h; ++y) {
    std::vector<T> row(c, T{});
    for (std::size_t x = 0; x < w; ++x) {
      for (std::size_t i = 0; i < c; ++i) {
        row[i] = static_cast<T>(row[i] + summand(image[(y * w + x) * c + i]));
        sums[((y + 1) * (w + 1) + x + 1) * c + i] =
            static_cast<T>(sums[(y * (w + 1) + x + 1) * c + i] + row[i]);
      }
    }
  }
  return sums;
}

/// `near(sum, expected, pixels)` for all sums, row 0 and column 0 too.
template <class In, class T, class Near>
void expect_table(const Built<In, T>& built, const std::vector<T>& expected,
                  const std::string& what, const Near& near) {
  const SatLayout& l = built.layout;
  std::size_t i = 0;
  for (std::size_t y = 0; y <= l.height; ++y)
    for (std::size_t x = 0; x <= l.width; ++x)
      for (std::size_t c = 0; c < l.channels; ++c, ++i)
        ASSERT_TRUE(near(built.table[l.at(x, y) + c], expected[i], x * y))
            << what << ": t(" << x << ", " << y << ") channel " << c << " is "
            << built.table[l.at(x, y) + c] << ", not " << expected[i];
}

template <class In, class T>
void expect_integers() {
  const Stream stream;
  ScanScratch scratch;
  for (const Size& size : kSizes) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      const auto image = noise<In>(size.width * size.height * channels, 7);
      const auto built = build<T>(image, size, channels, SatSummands<In>{}, scratch, stream);
      expect_table(built, twin<T>(image, built.layout, [](In v) { return static_cast<T>(v); }),
                   text(size, channels), [](T a, T b, std::size_t) { return a == b; });
      EXPECT_EQ(built.first_outside, ~0ULL);
    }
  }
}

TEST(SatCuda, TablesOfIntegersAreThoseOfALoop) {
  RELUMBRE_NEEDS_DEVICE();
  expect_integers<std::uint8_t, std::uint32_t>();
  expect_integers<std::uint16_t, std::uint64_t>();
  expect_integers<std::uint32_t, std::uint32_t>();
}

TEST(SatCuda, RealsAreRoundedToUnits) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const Size size{70, 35};
  for (std::size_t channels = 1; channels <= 4; ++channels) {
    auto image = noise<float>(size.width * size.height * channels, 3);
    image[0] = 0.5F, image[1] = 1.5F, image[2] = -0.5F;  // halves go to even
    const SatSummands<float> small{.scale = 1}, fine{.scale = 0x1p40};
    const auto exact = [](auto a, auto b, std::size_t) { return a == b; };
    const auto table32 = build<std::uint32_t>(image, size, channels, small, scratch, stream);
    expect_table(table32,
                 twin<std::uint32_t>(image, table32.layout,
                                     [](float v) {
                                       return static_cast<std::uint32_t>(
                                           static_cast<std::int32_t>(std::nearbyint(v)));
                                     }),
                 text(size, channels), exact);
    const auto table64 = build<std::uint64_t>(image, size, channels, fine, scratch, stream);
    expect_table(table64,
                 twin<std::uint64_t>(image, table64.layout,
                                     [](float v) {
                                       return static_cast<std::uint64_t>(static_cast<std::int64_t>(
                                           std::nearbyint(double{v} * 0x1p40)));
                                     }),
                 text(size, channels), exact);
  }
}

TEST(SatCuda, FloatSumsAreWithinTheirTolerance) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  for (const Size& size : kSizes) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      const auto image = noise<float>(size.width * size.height * channels, 5);
      const auto steps = static_cast<double>(1 + size.width / 32 + size.height / 32);
      const auto near = [&](double unit) {
        return [=](auto a, double b, std::size_t pixels) {  // summands are from 0 to 1
          return std::abs(static_cast<double>(a) - b) <= unit * steps * static_cast<double>(pixels);
        };
      };
      const auto doubles =
          build<double>(image, size, channels, SatSummands<float>{}, scratch, stream);
      const auto expected = twin<double>(image, doubles.layout, [](float v) { return double{v}; });
      expect_table(doubles, expected, text(size, channels), near(0x1p-52));
      const auto floats =
          build<float>(image, size, channels, SatSummands<float>{}, scratch, stream);
      std::size_t i = 0;
      for (std::size_t y = 0; y <= size.height; ++y)
        for (std::size_t x = 0; x <= size.width; ++x)
          for (std::size_t c = 0; c < channels; ++c, ++i)
            ASSERT_TRUE(near(0x1p-23)(floats.table[floats.layout.at(x, y) + c], expected[i], x * y))
                << text(size, channels) << ": t(" << x << ", " << y << ")";
    }
  }
}

TEST(SatCuda, FloatTablesHaveTheSameBitsInEveryRun) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const Size size{400, 150};
  const auto image = noise<float>(size.width * size.height * 4, 6);
  const auto first = build<float>(image, size, 4, SatSummands<float>{}, scratch, stream);
  for (int run = 0; run < 3; ++run) {
    const auto again = build<float>(image, size, 4, SatSummands<float>{}, scratch, stream);
    for (std::size_t y = 0; y <= size.height; ++y)
      ASSERT_EQ(
          std::memcmp(&first.table[first.layout.at(0, y)], &again.table[again.layout.at(0, y)],
                      (size.width + 1) * 4 * sizeof(float)),
          0);
  }
}

TEST(SatCuda, PixelsMayBeginAnywhere) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const Size size{130, 66};
  const auto image = noise<std::uint8_t>(size.width * size.height * 2, 8);
  for (const std::size_t offset : {1, 2, 5}) {
    const auto built =
        build<std::uint32_t>(image, size, 2, SatSummands<std::uint8_t>{}, scratch, stream, offset);
    expect_table(built, twin<std::uint32_t>(image, built.layout, [](std::uint8_t v) { return v; }),
                 "offset " + std::to_string(offset),
                 [](std::uint32_t a, std::uint32_t b, std::size_t) { return a == b; });
  }
}

TEST(SatCuda, TilesGoByDiagonals) {
  for (const Size& grid :
       std::vector<Size>{{1, 1}, {1, 7}, {7, 1}, {4, 4}, {3, 9}, {9, 3}, {60, 34}}) {
    std::vector<int> ticket(grid.width * grid.height, -1);
    for (std::size_t n = 0; n < ticket.size(); ++n) {
      const TilePlace place = tile_by_diagonals(n, grid.height, grid.width);
      ASSERT_LT(place.row, grid.height);
      ASSERT_LT(place.column, grid.width);
      int& of_tile = ticket[place.row * grid.width + place.column];
      ASSERT_EQ(of_tile, -1);
      of_tile = static_cast<int>(n);
      if (place.row > 0) {
        ASSERT_GE(ticket[(place.row - 1) * grid.width + place.column], 0);
      }
      if (place.column > 0) {
        ASSERT_GE(ticket[place.row * grid.width + place.column - 1], 0);
      }
    }
  }
}

__global__ void look_back(std::uint64_t* words, unsigned before, std::uint32_t tag,
                          std::uint32_t own, std::uint32_t* sum) {
  *sum = SatChain<std::uint32_t>(words, 1, before, tag)(own);
}

TEST(SatCuda, LookBackFindsTheSameWhereverItBegins) {
  RELUMBRE_NEEDS_DEVICE();
  constexpr std::uint32_t kTag = 8, kTile = 7, kOwn = 1000;
  const Stream stream;
  const DeviceArray<std::uint32_t> result(1);
  // Tile i's own sum is 2^i; `summed` tiles have replaced it by the sum up to there.
  for (const std::uint32_t summed : {4U, 5U, 6U, 7U}) {
    std::vector<std::uint64_t> words(kTile + 1);
    for (std::uint32_t i = 0; i < kTile; ++i)
      words[i] = i < summed ? std::uint64_t{kTag + 1} << 32 | ((2U << i) - 1)
                            : std::uint64_t{kTag} << 32 | 1U << i;
    const auto on_gpu = to_device(std::span<const std::uint64_t>(words), stream);
    launch(look_back, {.blocks = 1, .threads = 1}, stream, on_gpu.data() + kTile, kTile, kTag, kOwn,
           result.data());
    std::vector<std::uint32_t> sum(1);
    copy_to_host(result.data(), sum, stream);
    copy_to_host(on_gpu.data(), words, stream);
    stream.wait();
    EXPECT_EQ(sum[0], (1U << kTile) - 1) << summed;
    EXPECT_EQ(words[kTile], std::uint64_t{kTag + 1} << 32 | (sum[0] + kOwn));
  }
}

}  // namespace
}  // namespace relumbre::cuda
