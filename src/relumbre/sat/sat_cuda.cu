#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include "relumbre/sat/image_statistics_cuda.h"
#include "relumbre/sat/sat_cuda.h"
#include "relumbre/sat/sat_table_cuda.h"

namespace relumbre::cuda {

namespace {

constexpr std::array<unsigned long long, 1> kNone = {~0ULL};

DeviceSat::Storage allocate(SatKind kind, std::size_t elements) {
  switch (kind) {
    case SatKind::kFixed32:
      return DeviceArray<std::uint32_t>(elements);
    case SatKind::kFixed64:
      return DeviceArray<std::uint64_t>(elements);
    case SatKind::kFloat64:
      return DeviceArray<double>(elements);
    case SatKind::kFloat32:
    case SatKind::kFloat32Centred:
      return DeviceArray<float>(elements);
  }
  throw ValueError("summed-area table: no kind " + std::to_string(static_cast<int>(kind)));
}

/// Whatever is not finite goes on to all sums right of it and below.
template <class T>
void check_last(const DeviceArray<T>& sums, const SatLayout& layout, const Stream& stream) {
  if constexpr (std::is_floating_point_v<T>) {
    std::array<T, kSatMaxChannels> last{};
    copy_to_host(sums.data() + layout.at(layout.width, layout.height),
                 std::span<T>(last).first(layout.channels), stream);
    stream.wait();
    for (std::size_t c = 0; c < layout.channels; ++c)
      if (!std::isfinite(last[c]))
        throw ValueError("summed-area table: channel " + std::to_string(c) +
                         " is not finite or its sum overflows");
  }
}

}  // namespace

DeviceSat::DeviceSat(std::size_t width, std::size_t height, std::size_t channels,
                     const SatConfig& config)
    : config_(config),
      layout_(make_sat_layout(width, height, channels, sum_bytes(config.kind))),
      storage_(allocate(config.kind, layout_.elements)),
      first_outside_(to_device(std::span<const unsigned long long>(kNone), Stream())) {}

template <class In>
void DeviceSat::fill(const In* pixels, const Stream& stream) {
  const SatPlan<In> plan = plan_sat<In>(
      config_, layout_,
      [&] {
        if constexpr (std::is_same_v<In, float>) return find_range(pixels, layout_, stream);
        return SatRange{};
      },
      [&] { return find_mean(pixels, layout_, stream); });
  fixed_ = plan.fixed, range_ = plan.range, mean_ = plan.summands.mean;
  std::visit(
      [&](const auto& sums) {
        build_sat_table(pixels, layout_, plan.summands, sums.data(), first_outside_.data(),
                        scratch_, stream);
      },
      storage_);
}

void DeviceSat::build(const float* pixels, const Stream& stream) { fill(pixels, stream); }
void DeviceSat::build(const std::uint8_t* pixels, const Stream& stream) { fill(pixels, stream); }
void DeviceSat::build(const std::uint16_t* pixels, const Stream& stream) { fill(pixels, stream); }
void DeviceSat::build(const std::uint32_t* pixels, const Stream& stream) { fill(pixels, stream); }

void DeviceSat::check(const Stream& stream) {
  std::array<unsigned long long, 1> first = kNone;
  copy_to_host(first_outside_.data(), first, stream);
  stream.wait();
  if (first != kNone) {
    copy_to_device(kNone, first_outside_.data(), stream);
    throw_outside(first[0], layout_, range_);
  }
  std::visit([&](const auto& sums) { check_last(sums, layout_, stream); }, storage_);
}

}  // namespace relumbre::cuda
