#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/sat/sat_cuda.h"
#include "relumbre/sat/sat_table_cuda.h"
#include "relumbre/sat/tile_order_cuda.cuh"

namespace relumbre::cuda {
namespace {

template <class In>
std::vector<In> random_image(std::size_t values, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<In> image(values);
  for (In& v : image) {
    if constexpr (std::is_same_v<In, float>)
      v = static_cast<float>(random() >> 8) * 0x1p-24F;
    else
      v = static_cast<In>(random());
  }
  return image;
}

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
      const auto image = random_image<In>(size.width * size.height * channels, 7);
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
}

}  // namespace
}  // namespace relumbre::cuda
