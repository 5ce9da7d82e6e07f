/// What a summed-area table is made of: chosen by its user, read by both sides, CPU and GPU.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "relumbre/sat/axis_window.h"
#include "relumbre/sat/fixed_point.h"
#include "relumbre/sat/sat_layout.h"

namespace relumbre {

/// What the sums are. Bytes are those of one sum. Errors: docs/sat.md.
enum class SatKind {
  kFixed32,         ///< 4 bytes, wrapping: box sums of the quantised values are exact
  kFixed64,         ///< 8 bytes, wrapping: the same, with 32 bits more for the values
  kFloat64,         ///< 8 bytes
  kFloat32,         ///< 4 bytes: loses small boxes in large images; for comparison
  kFloat32Centred,  ///< 4 bytes, of value − mean: sums stay small
};
inline constexpr std::array<SatKind, 5> kSatKinds = {SatKind::kFixed32, SatKind::kFixed64,
                                                     SatKind::kFloat64, SatKind::kFloat32,
                                                     SatKind::kFloat32Centred};

/// "fixed32", "fixed64", "float64", "float32", "float32-centred".
constexpr std::string_view sat_kind_name(SatKind kind) {
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

constexpr bool is_fixed(SatKind kind) {
  return kind == SatKind::kFixed32 || kind == SatKind::kFixed64;
}
constexpr std::size_t sum_bytes(SatKind kind) {
  return kind == SatKind::kFixed64 || kind == SatKind::kFloat64 ? 8 : 4;
}

struct SatConfig {
  SatKind kind = SatKind::kFixed64;
  /// Fixed kinds: where all values lie, over all channels. If it is not given, real images are read
  /// once more to find it; integers have their type's. The build refuses values outside it.
  std::optional<SatRange> range;
  /// Fixed kinds: pixels of the largest box that will be asked for; the smaller, the finer the
  /// scale. 0: the whole image; of integers, what fits.
  std::size_t largest_box = 0;
  /// float32-centred: of each channel. If it is not given, the image is read once more for it. Any
  /// value is right; the true mean is the most precise.
  std::optional<std::array<float, kSatMaxChannels>> mean;
};

/// What lies beyond the edge, for boxes that reach there.
struct BorderRule {
  Border mode = Border::kClamp;
  std::array<float, kSatMaxChannels> value{};  ///< kConstant: of each channel
};

/// One value for each channel; those beyond the last are 0.
using SatSums = std::array<double, kSatMaxChannels>;

}  // namespace relumbre
