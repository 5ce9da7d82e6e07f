/// How pixels become summands, and what a config asks for in that.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "relumbre/sat/sat_config.h"

namespace relumbre {

/// What is summed instead of the pixels' values themselves.
template <class In>
struct SatSummands {
  /// Real values in unsigned tables: round(value · scale), half to even. A power of two.
  double scale = 1;
  /// float32 tables: what is taken from every value of each channel.
  std::array<float, kSatMaxChannels> mean{};
  /// Unsigned tables: values that lie outside, and NaN, are refused. |value · scale| must be below
  /// 2^31 (32 bits) or 2^51 within.
  In lowest = std::numeric_limits<In>::lowest(), highest = std::numeric_limits<In>::max();
};

/// Everything about a table that its config and its image decide.
template <class In>
struct SatPlan {
  FixedPoint fixed;
  SatRange range;  ///< fixed kinds: what is let pass
  SatSummands<In> summands;
};

namespace sat_detail {

/// Values are compared as floats, and units must not lie outside what is let pass.
inline SatRange as_floats(const SatRange& range) {
  constexpr double most = std::numeric_limits<float>::max();
  if (!(std::abs(range.lowest) <= most && std::abs(range.highest) <= most)) return range;
  return {static_cast<float>(range.lowest), static_cast<float>(range.highest)};
}

template <class In>
SatRange as_integers(const SatRange& range) {
  return {std::max(std::ceil(range.lowest), 0.0),
          std::min(std::floor(range.highest), double{std::numeric_limits<In>::max()})};
}

}  // namespace sat_detail

/// find_range() and find_mean() read the image, where the config does not say. Throws ValueError:
/// see SummedAreaTable.
template <class In, class FindRange, class FindMean>
SatPlan<In> plan_sat(const SatConfig& config, const SatLayout& layout, const FindRange& find_range,
                     const FindMean& find_mean) {
  SatPlan<In> plan;
  if (is_fixed(config.kind)) {
    const int bits = config.kind == SatKind::kFixed32 ? 32 : 64;
    if constexpr (std::is_floating_point_v<In>) {
      plan.range = config.range ? sat_detail::as_floats(*config.range) : find_range();
      const std::size_t box = config.largest_box > 0 ? config.largest_box : layout.pixels();
      plan.fixed = fixed_point_for_reals(plan.range, box, bits);
    } else {
      const SatRange all{0, std::numeric_limits<In>::max()};
      plan.range = sat_detail::as_integers<In>(config.range.value_or(all));
      plan.fixed = fixed_point_for_integers(plan.range, config.largest_box, layout.pixels(), bits);
    }
    plan.summands.scale = plan.fixed.scale;
    plan.summands.lowest = static_cast<In>(plan.range.lowest);
    plan.summands.highest = static_cast<In>(plan.range.highest);
  }
  if (config.kind == SatKind::kFloat32Centred)
    plan.summands.mean = config.mean ? *config.mean : find_mean();
  return plan;
}

}  // namespace relumbre
