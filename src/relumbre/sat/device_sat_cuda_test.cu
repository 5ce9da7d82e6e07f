#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/sat/sat_cuda.h"
#include "relumbre/sat/test_images.h"

namespace relumbre::cuda {
namespace {

struct Size {
  std::size_t width, height;
};

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
  auto image = noise<float>(size.width * size.height * 2, 12);
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
    const auto image = noise<std::uint8_t>(size.width * size.height * channels, 4);
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
