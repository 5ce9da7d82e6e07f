#include "relumbre/sat/sat_table.h"

#include <cstring>
#include <limits>
#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/huge_array.h"
#include "relumbre/base/parallel.h"
#include "relumbre/sat/sat_kernels.h"
#include "relumbre/sat/test_images.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Size {
  std::size_t width, height;
};
// Around groups of 16 and strips of 128 and more.
constexpr Size kSizes[] = {{1, 1},   {1, 37},   {41, 1},   {15, 3},   {16, 9},
                           {17, 8},  {63, 65},  {127, 5},  {128, 17}, {129, 11},
                           {257, 9}, {1025, 6}, {1151, 7}, {4097, 3}};

template <class In, class T>
std::vector<T> built(std::span<const In> image, const SatLayout& layout,
                     const SatSummands<In>& summands) {
  HugeArray<T> table(layout.elements);
  EXPECT_TRUE(build_sat_table(image, layout, summands, table.span()));
  std::vector<T> sums;  // without what is unused
  for (std::size_t y = 0; y <= layout.height; ++y) {
    const T* row = table.data() + layout.at(0, y);
    sums.insert(sums.end(), row, row + (layout.width + 1) * layout.channels);
  }
  return sums;
}

/// The slow twin: every sum from its neighbours, in Sum.
template <class Sum, class Summand>
std::vector<Sum> by_recurrence(const SatLayout& layout, Summand&& summand) {
  const std::size_t c = layout.channels, stride = (layout.width + 1) * c;
  std::vector<Sum> t((layout.height + 1) * stride, Sum{});
  for (std::size_t y = 0; y < layout.height; ++y) {
    for (std::size_t i = 0; i < layout.width * c; ++i) {
      const std::size_t at = (y + 1) * stride + c + i;
      t[at] = summand(y * layout.width * c + i) + t[at - c] + t[at - stride] - t[at - stride - c];
    }
  }
  return t;
}

template <class T>
void expect_like_slow_twin(const Size& size, std::size_t channels) {
  SCOPED_TRACE(::testing::Message() << size.width << "x" << size.height << "x" << channels);
  const SatLayout layout = make_sat_layout(size.width, size.height, channels, sizeof(T));
  const auto image = noise_image(layout.pixels() * channels, size.width + channels, -1, 2);
  SatSummands<float> summands;
  summands.scale = std::is_integral_v<T> ? 1 << 20 : 1;
  const auto sums = built<float, T>(image, layout, summands);
  if constexpr (std::is_integral_v<T>) {
    const auto expected = by_recurrence<T>(layout, [&](std::size_t i) {
      return static_cast<T>(std::llrint(double{image[i]} * summands.scale));
    });
    EXPECT_EQ(sums, expected);
  } else {
    const auto expected =
        by_recurrence<double>(layout, [&](std::size_t i) { return double{image[i]}; });
    const double tolerance =
        8 * std::numeric_limits<T>::epsilon() * static_cast<double>(layout.pixels() + 8);
    for (std::size_t i = 0; i < sums.size(); ++i)
      ASSERT_NEAR(static_cast<double>(sums[i]), expected[i], tolerance) << i;
  }
}

TEST(SatTable, EqualsTheRecurrenceAtAwkwardSizes) {
  for (const Size& size : kSizes) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      expect_like_slow_twin<std::uint32_t>(size, channels);
      expect_like_slow_twin<std::uint64_t>(size, channels);
      expect_like_slow_twin<float>(size, channels);
      expect_like_slow_twin<double>(size, channels);
    }
  }
}

template <class In, class T>
void expect_integers_like_slow_twin(const Size& size, std::size_t channels) {
  const SatLayout layout = make_sat_layout(size.width, size.height, channels, sizeof(T));
  const auto image = noise_integers<In>(layout.pixels() * channels, 7);
  const auto sums = built<In, T>(image, layout, {});
  const auto expected =
      by_recurrence<T>(layout, [&](std::size_t i) { return static_cast<T>(image[i]); });
  EXPECT_EQ(sums, expected);
}

TEST(SatTable, TakesIntegersExactly) {
  for (const Size& size : kSizes) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      expect_integers_like_slow_twin<std::uint8_t, std::uint32_t>(size, channels);
      expect_integers_like_slow_twin<std::uint16_t, std::uint32_t>(size, channels);
      expect_integers_like_slow_twin<std::uint32_t, std::uint32_t>(size, channels);
      expect_integers_like_slow_twin<std::uint32_t, std::uint64_t>(size, channels);
      expect_integers_like_slow_twin<std::uint16_t, double>(size, channels);
      expect_integers_like_slow_twin<std::uint8_t, float>({size.width, 3}, channels);
    }
  }
}

template <class T>
void expect_same_bits(const Size& size, std::size_t channels) {
  const SatLayout layout = make_sat_layout(size.width, size.height, channels, sizeof(T));
  const auto image = noise_image(layout.pixels() * channels, 3);
  std::vector<T> first;
  for (const std::size_t threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    const auto sums = built<float, T>(image, layout, {});
    if (first.empty()) first = sums;
    EXPECT_EQ(std::memcmp(first.data(), sums.data(), sums.size() * sizeof(T)), 0);
  }
}

TEST(SatTable, HasTheSameBitsWhateverTheNumberOfThreads) {
  for (const Size& size : {Size{1029, 67}, Size{1551, 41}, Size{4800, 19}}) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      expect_same_bits<std::uint32_t>(size, channels);
      expect_same_bits<std::uint64_t>(size, channels);
      expect_same_bits<float>(size, channels);
      expect_same_bits<double>(size, channels);
    }
  }
}

/// Larger than what is kept in the caches.
TEST(SatTable, EqualsTheRecurrenceWhereItIsStreamed) {
  for (std::size_t channels = 1; channels <= 4; ++channels) {
    expect_like_slow_twin<std::uint32_t>({2111, 1201 / channels}, channels);
    expect_like_slow_twin<double>({1111, 1201 / channels}, channels);
  }
}

template <class T>
void expect_kernels_agree() {
  constexpr std::size_t kPixels = 48;
  const auto image = noise_image(4 * kPixels + 4, 11, -1, 1);
  const std::vector<float> subtrahend(kSatGroup * 4, 0.25F);
  std::vector<std::vector<T>> results;
  for (const SatKernels<T>& kernels : available_sat_kernels<T>()) {
    std::vector<T> result;
    for (std::size_t c = 1; c <= 4; ++c) {
      for (const auto kernel : {kernels.store_floats[c - 1], kernels.stream_floats[c - 1]}) {
        HugeArray<T> sums(c * kPixels + 16), row(c * kPixels);
        std::fill_n(sums.data(), sums.size(), T{1});
        T carry[4] = {3, 5, 7, 9};
        EXPECT_TRUE(kernel({image.data(), kPixels, 0, carry, sums.data(), row.data()},
                           {65536, subtrahend.data(), -1, 1}));
        result.insert(result.end(), row.data(), row.data() + row.size());
        result.insert(result.end(), carry, carry + c);
      }
    }
    results.push_back(std::move(result));
  }
  for (const auto& result : results)
    EXPECT_EQ(std::memcmp(result.data(), results[0].data(), result.size() * sizeof(T)), 0);
}

TEST(SatKernels, HaveTheSameBitsOnAllInstructionSets) {
  expect_kernels_agree<std::uint32_t>();
  expect_kernels_agree<std::uint64_t>();
  expect_kernels_agree<float>();
  expect_kernels_agree<double>();
}

TEST(SatTable, RefusesValuesOutsideTheRangeWhereverTheyAre) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const SatLayout layout = make_sat_layout(150, 3, 3, 4);
  HugeArray<std::uint32_t> table(layout.elements);
  SatSummands<float> summands;
  summands.lowest = 0, summands.highest = 1;
  for (const float bad : {-0.001F, 1.001F, kNan, std::numeric_limits<float>::infinity()}) {
    for (std::size_t at = 0; at < layout.pixels() * 3; at += 7) {
      auto image = noise_image(layout.pixels() * 3, 1);
      image[at] = bad;
      EXPECT_FALSE(build_sat_table<float>(image, layout, summands, table.span())) << at;
    }
  }
}

TEST(SatLayout, RefusesWhatDoesNotFit) {
  constexpr std::size_t kHuge = std::numeric_limits<std::size_t>::max();
  const auto layout = [](std::size_t w, std::size_t h, std::size_t c) {
    return [=] { (void)make_sat_layout(w, h, c, 8); };
  };
  EXPECT_THAT(layout(4, 4, 0), ThrowsMessage<ShapeError>(HasSubstr("channels")));
  EXPECT_THAT(layout(4, 4, 5), ThrowsMessage<ShapeError>(HasSubstr("channels")));
  EXPECT_THAT(layout(kHuge, 2, 1), ThrowsMessage<ShapeError>(HasSubstr("2^24")));
  EXPECT_THAT(layout(2, kHuge, 1), ThrowsMessage<ShapeError>(HasSubstr("2^24")));
  EXPECT_THAT(layout(1 << 24, 1 << 24, 4), ThrowsMessage<ShapeError>(HasSubstr("2^36 bytes")));
  EXPECT_NO_THROW(make_sat_layout(30000, 20000, 4, 8));
}

TEST(SatTable, RefusesSizesThatDisagree) {
  const SatLayout layout = make_sat_layout(4, 3, 2, 4);
  const std::vector<float> image(23);
  HugeArray<float> table(layout.elements), small(layout.elements - 1);
  EXPECT_THAT([&] { (void)build_sat_table<float>(image, layout, {}, table.span()); },
              ThrowsMessage<ShapeError>(HasSubstr("24 values, not 23")));
  const std::vector<float> right(24);
  EXPECT_THROW((void)build_sat_table<float>(right, layout, {}, small.span()), ShapeError);
}

}  // namespace
}  // namespace relumbre
