#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/sat/sat_chain_cuda.cuh"
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
  expect_integers<std::uint16_t, std::uint64_t>();
  expect_integers<std::uint32_t, std::uint32_t>();
}

TEST(SatCuda, RealsAreRoundedToUnits) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const Size size{70, 35};
  for (std::size_t channels = 1; channels <= 4; ++channels) {
    auto image = random_image<float>(size.width * size.height * channels, 3);
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
      const auto image = random_image<float>(size.width * size.height * channels, 5);
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
  const auto image = random_image<float>(size.width * size.height * 4, 6);
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
  const auto image = random_image<std::uint8_t>(size.width * size.height * 2, 8);
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

std::string message_of_check(DeviceSat& table, const Stream& stream) {
  try {
    table.check(stream);
  } catch (const ValueError& error) {
    return error.what();
  }
  return "";
}

TEST(DeviceSat, NamesTheFirstPixelThatItRefuses) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  const Size size{70, 80};
  std::vector<float> image(size.width * size.height * 2, 0.5F);
  for (const SatKind kind : {SatKind::kFixed32, SatKind::kFixed64}) {
    DeviceSat table(size.width, size.height, 2,
                    {.kind = kind, .range = SatRange{0, 1}, .largest_box = 100});
    for (const float bad : {2.0F, -0.5F, NAN, INFINITY}) {
      auto spoilt = image;
      spoilt[2 * (71 * size.width + 66) + 1] = bad;
      spoilt[2 * (79 * size.width + 2)] = bad;
      const auto pixels = to_device(std::span<const float>(spoilt), stream);
      table.build(pixels.data(), stream);
      EXPECT_NE(message_of_check(table, stream).find("pixel (66, 71) channel 1 is not from 0 to 1"),
                std::string::npos);
      EXPECT_EQ(message_of_check(table, stream), "") << "reported twice";
    }
    const auto pixels = to_device(std::span<const float>(image), stream);
    table.build(pixels.data(), stream);
    EXPECT_EQ(message_of_check(table, stream), "");
  }
}

TEST(DeviceSat, RefusesWhatIsNotFinite) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  std::vector<float> image(40 * 40, 1);
  image[41 * 12] = NAN;
  const auto pixels = to_device(std::span<const float>(image), stream);
  DeviceSat fixed(40, 40, 1);
  EXPECT_THROW(fixed.build(pixels.data(), stream), ValueError);  // looks for the range
  DeviceSat sums(40, 40, 1, {.kind = SatKind::kFloat64});
  sums.build(pixels.data(), stream);
  EXPECT_NE(message_of_check(sums, stream).find("channel 0 is not finite"), std::string::npos);
}

TEST(DeviceSat, RefusesSizesAndKinds) {
  RELUMBRE_NEEDS_DEVICE();
  EXPECT_THROW(DeviceSat(3, 3, 5), ShapeError);
  EXPECT_THROW(DeviceSat(3, 3, 0), ShapeError);
  EXPECT_THROW(DeviceSat(std::size_t{1} << 25, 3, 1), ShapeError);
  EXPECT_THROW(DeviceSat(3, 3, 1, {.kind = static_cast<SatKind>(9)}), ValueError);
}

TEST(DeviceSat, FindsRangeAndMeanOfTheImage) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  const Size size{90, 100};
  auto image = random_image<float>(size.width * size.height * 2, 12);
  image[5000] = -3, image[12000] = 7;
  const auto pixels = to_device(std::span<const float>(image), stream);
  DeviceSat fixed(size.width, size.height, 2);
  fixed.build(pixels.data(), stream);
  const FixedPoint expected = fixed_point_for_reals({-3, 7}, size.width * size.height, 64);
  EXPECT_EQ(fixed.fixed_point().scale, expected.scale);
  DeviceSat centred(size.width, size.height, 2, {.kind = SatKind::kFloat32Centred});
  centred.build(pixels.data(), stream);
  for (std::size_t c = 0; c < 2; ++c) {
    double sum = 0;
    for (std::size_t i = c; i < image.size(); i += 2) sum += double{image[i]};
    EXPECT_NEAR(double{centred.mean()[c]}, sum * 2 / static_cast<double>(image.size()), 1e-6);
  }
}

TEST(DeviceSat, BoxSumsAndMeansAreThoseOfLoops) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  const Size size{50, 41};
  for (std::size_t channels = 1; channels <= 4; ++channels) {
    const auto image = random_image<std::uint8_t>(size.width * size.height * channels, 4);
    const auto pixels = to_device(std::span<const std::uint8_t>(image), stream);
    DeviceSat table(size.width, size.height, channels, {.kind = SatKind::kFixed32});
    table.build(pixels.data(), stream);
    const std::vector<PixelBox> boxes = {{0, 0, 50, 41}, {3, 4, 20, 5}, {7, 7, 7, 9},
                                         {9, 0, 8, 3},   {0, 0, 51, 1}, {0, 0, 1, 42}};
    std::vector<RealBox> same;
    for (const PixelBox& b : boxes)
      same.push_back({double(b.x0), double(b.y0), double(b.x1), double(b.y1)});
    const auto device_boxes = to_device(std::span<const PixelBox>(boxes), stream);
    const auto device_same = to_device(std::span<const RealBox>(same), stream);
    const DeviceArray<SatSums> sums(boxes.size()), means(boxes.size());
    box_sums(table, device_boxes.data(), boxes.size(), sums.data(), stream);
    box_means(table, device_same.data(), boxes.size(), {}, means.data(), stream);
    std::vector<SatSums> sum(boxes.size()), mean(boxes.size());
    copy_to_host(sums.data(), sum, stream);
    copy_to_host(means.data(), mean, stream);
    stream.wait();
    for (std::size_t i = 0; i < 3; ++i) {
      const PixelBox& b = boxes[i];
      for (std::size_t c = 0; c < channels; ++c) {
        double expected = 0;
        for (std::size_t y = b.y0; y < b.y1; ++y)
          for (std::size_t x = b.x0; x < b.x1; ++x)
            expected += image[(y * size.width + x) * channels + c];
        EXPECT_EQ(sum[i][c], expected);
        const double area = (b.x1 - b.x0) * (b.y1 - b.y0);
        if (area > 0) {
          EXPECT_NEAR(mean[i][c], expected / area, 1e-12 * expected);
        }
      }
    }
    for (std::size_t i = 3; i < boxes.size(); ++i) EXPECT_TRUE(std::isnan(sum[i][0])) << i;
    EXPECT_TRUE(std::isnan(mean[2][0])) << "a box without area";
  }
}

TEST(DeviceSat, FiltersAConstantImageIntoItself) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  const Size size{45, 23};
  const std::vector<float> image(size.width * size.height * 3, 0.75F);
  std::vector<float> radii(size.width * size.height);
  for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = static_cast<float>(i % 97) * 0.375F;
  radii[3] = NAN, radii[4] = -1;
  const auto pixels = to_device(std::span<const float>(image), stream);
  const auto device_radii = to_device(std::span<const float>(radii), stream);
  const DeviceArray<float> out(image.size());
  DeviceSat table(size.width, size.height, 3, {.kind = SatKind::kFloat64});
  table.build(pixels.data(), stream);
  for (const Border mode : {Border::kClamp, Border::kConstant, Border::kMirror}) {
    box_filter(table, device_radii.data(), {mode, {0.75F, 0.75F, 0.75F}}, out.data(), stream);
    std::vector<float> result(image.size());
    copy_to_host(out.data(), result, stream);
    stream.wait();
    for (const float v : result) ASSERT_NEAR(v, 0.75F, 1e-6F);
  }
}

TEST(DeviceSat, RefusesRadii) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  DeviceSat table(30, 30, 1, {.range = SatRange{0, 1}, .largest_box = 25});
  const std::vector<float> image(900, 0.5F);
  const auto pixels = to_device(std::span<const float>(image), stream);
  table.build(pixels.data(), stream);
  const DeviceArray<float> out(900);
  for (const double radius : {-1.0, double{NAN}, 2e6, 3.0})
    EXPECT_THROW(box_filter(table, radius, {}, out.data(), stream), ValueError) << radius;
  EXPECT_NO_THROW(box_filter(table, 2.0, {}, out.data(), stream));
}

}  // namespace
}  // namespace relumbre::cuda
