#include "relumbre/sat/summed_area_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/sat/image_statistics.h"
#include "relumbre/sat/sat_table.h"
#include "relumbre/sat/table_reader.h"

namespace relumbre {

namespace {

constexpr double kFarthest = 1 << 30;

SummedAreaTable::Storage allocate(SatKind kind, std::size_t elements) {
  switch (kind) {
    case SatKind::kFixed32:
      return HugeArray<std::uint32_t>(elements);
    case SatKind::kFixed64:
      return HugeArray<std::uint64_t>(elements);
    case SatKind::kFloat64:
      return HugeArray<double>(elements);
    case SatKind::kFloat32:
    case SatKind::kFloat32Centred:
      return HugeArray<float>(elements);
  }
  throw ValueError(fmt::format("summed-area table: no kind {}", static_cast<int>(kind)));
}

template <class T>
void check_finite(const HugeArray<T>& sums, const SatLayout& layout) {
  if constexpr (std::is_floating_point_v<T>) {
    for (std::size_t c = 0; c < layout.channels; ++c) {
      // Whatever is not finite goes on to all sums right of it and below.
      if (!std::isfinite(sums.data()[layout.at(layout.width, layout.height) + c]))
        throw ValueError(
            fmt::format("summed-area table: channel {} is not finite or its sum "
                        "overflows",
                        c));
    }
  }
}

}  // namespace

SummedAreaTable::SummedAreaTable(std::size_t width, std::size_t height, std::size_t channels,
                                 const SatConfig& config)
    : config_(config),
      layout_(make_sat_layout(width, height, channels, sum_bytes(config.kind))),
      storage_(allocate(config.kind, layout_.elements)) {}

template <class In>
void SummedAreaTable::fill(std::span<const In> pixels) {
  check_pixel_count(layout_, pixels.size());
  const SatPlan<In> plan = plan_sat<In>(
      config_, layout_,
      [&] {
        if constexpr (std::is_same_v<In, float>) return find_range(pixels, layout_);
        return SatRange{};
      },
      [&] { return find_mean(pixels, layout_); });
  fixed_ = plan.fixed, mean_ = plan.summands.mean;
  std::visit(
      [&]<class T>(HugeArray<T>& sums) {
        if (!build_sat_table(pixels, layout_, plan.summands, sums.span()))
          report_outside(pixels, layout_, plan.range);
        check_finite(sums, layout_);
      },
      storage_);
}

#define RELUMBRE_BUILD(In)                                                              \
  SummedAreaTable SummedAreaTable::build(std::span<const In> pixels, std::size_t width, \
                                         std::size_t height, std::size_t channels,      \
                                         const SatConfig& config) {                     \
    SummedAreaTable table(width, height, channels, config);                             \
    table.fill(pixels);                                                                 \
    return table;                                                                       \
  }                                                                                     \
  void SummedAreaTable::rebuild(std::span<const In> pixels) { fill(pixels); }
RELUMBRE_BUILD(float)
RELUMBRE_BUILD(std::uint8_t)
RELUMBRE_BUILD(std::uint16_t)
RELUMBRE_BUILD(std::uint32_t)
#undef RELUMBRE_BUILD

void SummedAreaTable::check_box(std::size_t x0, std::size_t y0, std::size_t x1,
                                std::size_t y1) const {
  if (x0 > x1 || y0 > y1 || x1 > width() || y1 > height())
    throw ValueError(fmt::format("box from ({}, {}) to ({}, {}) in an image of {} x {}", x0, y0, x1,
                                 y1, width(), height()));
  if (is_fixed(kind()) && (x1 - x0) * (y1 - y0) > fixed_.largest_box)
    throw ValueError(fmt::format("box of {} x {} pixels in a {} table made for boxes of {}",
                                 x1 - x0, y1 - y0, sat_kind_name(kind()), fixed_.largest_box));
}

SatSums SummedAreaTable::box_sum(std::size_t x0, std::size_t y0, std::size_t x1,
                                 std::size_t y1) const {
  check_box(x0, y0, x1, y1);
  SatSums total{};
  with_reader(*this, [&](const auto& reader) { reader.add(x0, y0, x1, y1, 1, total); });
  return total;
}

std::array<std::int64_t, kSatMaxChannels> SummedAreaTable::box_units(std::size_t x0, std::size_t y0,
                                                                     std::size_t x1,
                                                                     std::size_t y1) const {
  check_box(x0, y0, x1, y1);
  std::array<std::int64_t, kSatMaxChannels> total{};
  with_reader(*this, [&]<class T>(const BoxReader<T>& reader) {
    if constexpr (std::is_integral_v<T>) {
      for (std::size_t c = 0; c < channels(); ++c) total[c] = reader.units(x0, y0, x1, y1, c);
    } else {
      throw ValueError(fmt::format("a {} table has no units", sat_kind_name(kind())));
    }
  });
  return total;
}

SatSums SummedAreaTable::box_mean(double x0, double y0, double x1, double y1,
                                  const BorderRule& border) const {
  if (layout_.pixels() == 0) throw ShapeError("box mean of an image without pixels");
  const auto within = [](double v) { return std::abs(v) <= kFarthest; };  // NaN is not
  if (!(x0 < x1 && y0 < y1 && within(x0) && within(y0) && within(x1) && within(y1)))
    throw ValueError(fmt::format("mean over the box from ({}, {}) to ({}, {})", x0, y0, x1, y1));
  const AxisWindow across(x0, x1, width(), border.mode), down(y0, y1, height(), border.mode);
  for (const AxisSegment& v : down.segments()) {
    for (const AxisSegment& h : across.segments()) check_box(h.begin, v.begin, h.end, v.end);
  }
  return with_reader(*this, [&](const auto& reader) { return reader.mean(across, down, border); });
}

}  // namespace relumbre
