// Against the CPU's tables, which need Highway.
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/huge_array.h"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/sat/box_filter.h"
#include "relumbre/sat/sat_cuda.h"
#include "relumbre/sat/summed_area_table.h"
#include "relumbre/sat/test_images.h"

namespace relumbre::cuda {
namespace {

struct Size {
  std::size_t width, height;
};
const std::vector<Size> kSizes = {{1, 1}, {70, 66}, {150, 20}, {0, 3}, {3, 0}};

template <class T>
std::vector<T> sums_of(const DeviceSat& table, const Stream& stream) {
  const auto& sums = std::get<DeviceArray<T>>(table.storage());
  std::vector<T> host(sums.size());
  copy_to_host(sums.data(), host, stream);
  stream.wait();
  return host;
}

/// `same(ours, theirs)` for all sums that a query can ask for.
template <class T, class Same>
void expect_same_table(const DeviceSat& table, const SummedAreaTable& cpu, const Stream& stream,
                       const std::string& what, const Same& same) {
  const SatLayout& layout = cpu.layout();
  const auto ours = sums_of<T>(table, stream);
  const T* theirs = std::get<HugeArray<T>>(cpu.storage()).data();
  ASSERT_EQ(ours.size(), layout.elements);
  for (std::size_t y = 0; y <= layout.height; ++y)
    for (std::size_t x = 0; x <= layout.width; ++x)
      for (std::size_t c = 0; c < layout.channels; ++c) {
        const std::size_t i = layout.at(x, y) + c;
        ASSERT_TRUE(same(ours[i], theirs[i]))
            << what << ": t(" << x << ", " << y << ") channel " << c << " is " << ours[i]
            << ", the CPU's " << theirs[i];
      }
}

template <class T, class In, class Same>
void expect_like_cpu(const std::vector<In>& image, const Size& size, std::size_t channels,
                     const SatConfig& config, const Same& same) {
  const Stream stream;
  const auto cpu = SummedAreaTable::build(image, size.width, size.height, channels, config);
  DeviceSat table(size.width, size.height, channels, config);
  const auto pixels = to_device(std::span<const In>(image), stream);
  table.build(pixels.data(), stream);
  table.check(stream);
  EXPECT_EQ(table.fixed_point().scale, cpu.fixed_point().scale);
  EXPECT_EQ(table.fixed_point().lowest_unit, cpu.fixed_point().lowest_unit);
  EXPECT_EQ(table.fixed_point().largest_box, cpu.fixed_point().largest_box);
  expect_same_table<T>(table, cpu, stream, std::string(sat_kind_name(config.kind)), same);
}

TEST(SatCudaFull, FixedTablesHaveTheBitsOfTheCpus) {
  RELUMBRE_NEEDS_DEVICE();
  const auto equal = [](auto a, auto b) { return a == b; };
  for (const Size& size : kSizes) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      const std::size_t values = size.width * size.height * channels;
      const auto reals = noise_image(values, 3, -2, 5);
      const auto bytes = noise_integers<std::uint8_t>(values, 4);
      const auto shorts = noise_integers<std::uint16_t>(values, 5);
      const auto words = noise_integers<std::uint32_t>(values, 6);
      const SatConfig small{.kind = SatKind::kFixed32, .largest_box = 100};
      const SatConfig large{.kind = SatKind::kFixed64};
      expect_like_cpu<std::uint32_t>(reals, size, channels, small, equal);
      expect_like_cpu<std::uint64_t>(reals, size, channels, large, equal);
      expect_like_cpu<std::uint32_t>(bytes, size, channels, small, equal);
      expect_like_cpu<std::uint64_t>(shorts, size, channels, large, equal);
      expect_like_cpu<std::uint64_t>(words, size, channels, large, equal);
    }
  }
}

TEST(SatCudaFull, FloatTablesDifferFromTheCpusByRounding) {
  RELUMBRE_NEEDS_DEVICE();
  const auto near = [](double relative) {
    return [relative](auto a, auto b) {
      return std::abs(static_cast<double>(a) - static_cast<double>(b)) <=
             relative * (1 + std::abs(static_cast<double>(b)));
    };
  };
  for (const Size& size : kSizes) {
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      const auto image = noise_image(size.width * size.height * channels, 8);
      expect_like_cpu<float>(image, size, channels, {.kind = SatKind::kFloat32}, near(1e-6));
      expect_like_cpu<double>(image, size, channels, {.kind = SatKind::kFloat64}, near(1e-15));
      const SatConfig centred{.kind = SatKind::kFloat32Centred,
                              .mean = std::array<float, 4>{0.5F, 0.25F, 0.5F, 0.75F}};
      expect_like_cpu<float>(image, size, channels, centred, near(1e-5));
    }
  }
}

TEST(SatCudaFull, BoxFiltersOfFixedTablesHaveTheBitsOfTheCpus) {
  RELUMBRE_NEEDS_DEVICE();
  const Size size{67, 35};
  const Stream stream;
  for (std::size_t channels = 1; channels <= 4; ++channels) {
    const auto image = noise_image(size.width * size.height * channels, 9);
    const auto radii = noise_image(size.width * size.height, 10, 0, 12);
    const auto pixels = to_device(std::span<const float>(image), stream);
    const auto device_radii = to_device(std::span<const float>(radii), stream);
    const DeviceArray<float> out(image.size());
    std::vector<float> ours(image.size()), theirs(image.size());
    DeviceSat table(size.width, size.height, channels);
    table.build(pixels.data(), stream);
    const auto cpu = SummedAreaTable::build(image, size.width, size.height, channels);
    for (const Border mode : {Border::kClamp, Border::kConstant, Border::kMirror}) {
      const BorderRule border{mode, {0.5F, 1, 2, 3}};
      for (const double radius : {0.0, 1.0, 2.7, 80.5}) {
        box_filter(table, radius, border, out.data(), stream);
        copy_to_host(out.data(), ours, stream);
        stream.wait();
        relumbre::box_filter(cpu, radius, border, theirs);
        EXPECT_EQ(ours, theirs) << "radius " << radius << ", " << channels << " channels";
      }
      box_filter(table, device_radii.data(), border, out.data(), stream);
      copy_to_host(out.data(), ours, stream);
      stream.wait();
      relumbre::box_filter(cpu, radii, border, theirs);
      EXPECT_EQ(ours, theirs) << "a radius a pixel, " << channels << " channels";
    }
  }
}

}  // namespace
}  // namespace relumbre::cuda
