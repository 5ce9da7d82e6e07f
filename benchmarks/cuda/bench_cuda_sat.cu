// Summed-area tables of 4K images, against a copy on the device of as many bytes as are read and
// written; and box filters from them. Tables are compared with a few sums made on the host before
// any time is taken.
#include <cstdint>
#include <string>
#include <type_traits>

#include "bench.cuh"
#include "relumbre/sat/sat_cuda.h"
#include "relumbre/sat/test_images.h"

namespace relumbre::bench {
namespace {

using cuda::DeviceArray;
using cuda::DeviceSat;
using cuda::Stream;

constexpr std::size_t kWidth = 3840, kHeight = 2160;

/// Sums over a few boxes, the largest from corner to corner.
template <class In>
void expect_right(const DeviceSat& table, const std::vector<In>& image, const Stream& stream) {
  const std::vector<cuda::PixelBox> boxes = {
      {0, 0, kWidth, kHeight}, {0, 0, 1, 1}, {63, 63, 65, 66}, {1000, 7, 3800, 2100}};
  const auto device_boxes = cuda::to_device(std::span<const cuda::PixelBox>(boxes), stream);
  const DeviceArray<SatSums> device_sums(boxes.size());
  cuda::box_sums(table, device_boxes.data(), boxes.size(), device_sums.data(), stream);
  std::vector<SatSums> sums(boxes.size());
  cuda::copy_to_host(device_sums.data(), sums, stream);
  stream.wait();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const cuda::PixelBox& b = boxes[i];
    for (std::size_t c = 0; c < table.channels(); ++c) {
      double expected = 0;
      for (std::size_t y = b.y0; y < b.y1; ++y)
        for (std::size_t x = b.x0; x < b.x1; ++x)
          expected += static_cast<double>(image[(y * kWidth + x) * table.channels() + c]);
      // float32 tables lose small boxes: what they may lose is that of the whole table.
      const double whole = static_cast<double>(kWidth * kHeight);
      const double allowed = sum_bytes(table.kind()) == 4 && !is_fixed(table.kind())
                                 ? 1e-5 * whole
                                 : 1e-6 * (1 + expected);
      if (!(std::abs(sums[i][c] - expected) <= allowed))
        throw Error("box " + std::to_string(i) + " channel " + std::to_string(c) + " sums to " +
                    std::to_string(sums[i][c]) + ", not " + std::to_string(expected));
    }
  }
}

template <class In>
Row table_of(const char* name, std::size_t channels, SatConfig config, const Stream& stream) {
  const auto image = noise<In>(kWidth * kHeight * channels, 1);
  const auto pixels = cuda::to_device(std::span<const In>(image), stream);
  if (std::is_same_v<In, float>) config.range = SatRange{0, 1};
  DeviceSat table(kWidth, kHeight, channels, config);
  table.build(pixels.data(), stream);
  table.check(stream);
  if (config.kind != SatKind::kFixed32 || !std::is_same_v<In, float>)
    expect_right(table, image, stream);
  const std::size_t bytes = image.size() * (sizeof(In) + sum_bytes(config.kind));
  const std::vector<Work> candidates = {[&](const Stream& s) { table.build(pixels.data(), s); },
                                        DeviceCopy(bytes / 2)};
  const auto seconds = median_seconds(candidates, stream);
  Row row;
  row.name = name, row.seconds = seconds[0], row.bytes = static_cast<double>(bytes);
  row.limit = "copy on the device", row.limit_seconds = seconds[1];
  print(row);
  return row;
}

/// Reads 4 or 16 sums a value, which neighbours share.
void filters(const Stream& stream) {
  constexpr std::size_t kChannels = 4;
  const auto image = noise<float>(kWidth * kHeight * kChannels, 1);
  const auto pixels = cuda::to_device(std::span<const float>(image), stream);
  std::vector<float> each(kWidth * kHeight);
  for (std::size_t i = 0; i < each.size(); ++i)
    each[i] = 20 + 20 * std::sin(static_cast<float>(i % kWidth) * 0.01F);
  const auto radii = cuda::to_device(std::span<const float>(each), stream);
  const DeviceArray<float> out(image.size());
  DeviceSat table(kWidth, kHeight, kChannels, {.kind = SatKind::kFloat64});
  table.build(pixels.data(), stream);
  table.check(stream);
  const std::size_t bytes = image.size() * (sizeof(double) + sizeof(float));
  const std::vector<Work> candidates = {
      [&](const Stream& s) { cuda::box_filter(table, 10.0, {}, out.data(), s); },
      [&](const Stream& s) { cuda::box_filter(table, 10.5, {}, out.data(), s); },
      [&](const Stream& s) { cuda::box_filter(table, radii.data(), {}, out.data(), s); },
      DeviceCopy(bytes / 2)};
  const auto seconds = median_seconds(candidates, stream);
  const char* const names[] = {"box filter, float64, radius 10", "box filter, float64, radius 10.5",
                               "box filter, float64, a radius a pixel"};
  for (std::size_t i = 0; i < 3; ++i) {
    Row row;
    row.name = names[i], row.seconds = seconds[i], row.bytes = static_cast<double>(bytes);
    row.limit = "copy on the device", row.limit_seconds = seconds[3];
    print(row);
  }
}

void run() {
  const Stream stream;
  print_heading("summed-area tables, 3840 x 2160");
  const Row row = table_of<float>("float32 RGBA, float32", 4, {.kind = SatKind::kFloat32}, stream);
  table_of<float>("float32 RGBA, float64", 4, {.kind = SatKind::kFloat64}, stream);
  table_of<float>("float32 RGBA, fixed64", 4, {.kind = SatKind::kFixed64}, stream);
  table_of<float>("float32 RGBA, fixed32, boxes to 10,000", 4,
                  {.kind = SatKind::kFixed32, .largest_box = 10000}, stream);
  table_of<std::uint8_t>("uint8 RGBA, fixed32", 4, {.kind = SatKind::kFixed32}, stream);
  table_of<float>("float32 grey, float32", 1, {.kind = SatKind::kFloat32}, stream);
  table_of<float>("float32 RGB, float32", 3, {.kind = SatKind::kFloat32}, stream);
  filters(stream);
  print_figure("sat_float32_4k_rgba_against_copy", row.fraction_of_limit(), 0.70, "x");
}

}  // namespace
}  // namespace relumbre::bench

int main() { return relumbre::bench::run_benchmark(relumbre::bench::run); }
