#include "relumbre/sat/summed_area_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/sat/box_reader.h"
#include "relumbre/sat/image_statistics.h"
#include "relumbre/sat/sat_table.h"

namespace relumbre {

namespace {

constexpr double kFarthest = 1 << 30;

std::size_t sum_bytes(SatKind kind) {
  return kind == SatKind::kFixed64 || kind == SatKind::kFloat64 ? 8 : 4;
}

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

/// The kernels compare floats, and units must not lie outside what they let pass.
SatRange as_floats(const SatRange& range) {
  constexpr double most = std::numeric_limits<float>::max();
  if (!(std::abs(range.lowest) <= most && std::abs(range.highest) <= most)) return range;
  return {static_cast<float>(range.lowest), static_cast<float>(range.highest)};
}

template <class In>
FixedPoint choose_fixed_point(std::span<const In> pixels, const SatLayout& layout,
                              const SatConfig& config, SatRange& range) {
  const int bits = config.kind == SatKind::kFixed32 ? 32 : 64;
  if constexpr (std::is_floating_point_v<In>) {
    range = config.range ? as_floats(*config.range) : find_range(pixels, layout);
    const std::size_t box = config.largest_box > 0 ? config.largest_box : layout.pixels();
    return fixed_point_for_reals(range, box, bits);
  } else {
    range = config.range.value_or(SatRange{0, std::numeric_limits<In>::max()});
    range = {std::max(std::ceil(range.lowest), 0.0),
             std::min(std::floor(range.highest), double{std::numeric_limits<In>::max()})};
    return fixed_point_for_integers(range, config.largest_box, layout.pixels(), bits);
  }
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

std::string_view sat_kind_name(SatKind kind) {
  switch (kind) {
    case SatKind::kFixed32:
      return "fixed32";
    case SatKind::kFixed64:
      return "fixed64";
    case SatKind::kFloat64:
      return "float64";
    case SatKind::kFloat32:
      return "float32";
    case SatKind::kFloat32Centred:
      return "float32-centred";
  }
  return "unknown";
}

bool is_fixed(SatKind kind) { return kind == SatKind::kFixed32 || kind == SatKind::kFixed64; }

SummedAreaTable::SummedAreaTable(std::size_t width, std::size_t height, std::size_t channels,
                                 const SatConfig& config)
    : config_(config),
      layout_(make_sat_layout(width, height, channels, sum_bytes(config.kind))),
      storage_(allocate(config.kind, layout_.elements)) {}

template <class In>
void SummedAreaTable::fill(std::span<const In> pixels) {
  check_pixel_count(layout_, pixels.size());
  SatSummands<In> summands;
  SatRange range{0, 0};
  if (is_fixed(config_.kind)) {
    fixed_ = choose_fixed_point(pixels, layout_, config_, range);
    summands.scale = fixed_.scale;
    summands.lowest = static_cast<In>(range.lowest);
    summands.highest = static_cast<In>(range.highest);
  }
  if (config_.kind == SatKind::kFloat32Centred)
    mean_ = config_.mean ? *config_.mean : find_mean(pixels, layout_);
  summands.mean = mean_;
  std::visit(
      [&]<class T>(HugeArray<T>& sums) {
        if (!build_sat_table(pixels, layout_, summands, sums.span()))
          report_outside(pixels, layout_, range);
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
