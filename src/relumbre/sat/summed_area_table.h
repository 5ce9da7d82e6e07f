/// Summed-area tables: the sum over any box in constant time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "relumbre/base/huge_array.h"
#include "relumbre/sat/sat_config.h"

namespace relumbre {

/// The table of an image of 1 to 4 interleaved channels, row-major, row 0 at the top. Built in one
/// pass over memory (see sat_table.h), with the same bits whatever the number of threads. Immutable
/// but for rebuild; queries may run in parallel. Either side may be 0.
///
///   t(x, y) = Σ_{i<x, j<y} a(i, j),   box sum = t(x1,y1) − t(x0,y1) − t(x1,y0) + t(x0,y0)
///
/// Source: Crow 1984, with half-open bounds.
class SummedAreaTable {
 public:
  /// Throws ShapeError: channels, sides or the table too large, pixels.size() not w·h·channels.
  /// Throws ValueError: a value outside the range, NaN or infinity, a float sum that overflows,
  /// a largest box that cannot fit (fixed_point.h), a range or mean that is not finite.
  static SummedAreaTable build(std::span<const float> pixels, std::size_t width, std::size_t height,
                               std::size_t channels, const SatConfig& config = {});
  static SummedAreaTable build(std::span<const std::uint8_t> pixels, std::size_t width,
                               std::size_t height, std::size_t channels,
                               const SatConfig& config = {});
  static SummedAreaTable build(std::span<const std::uint16_t> pixels, std::size_t width,
                               std::size_t height, std::size_t channels,
                               const SatConfig& config = {});
  static SummedAreaTable build(std::span<const std::uint32_t> pixels, std::size_t width,
                               std::size_t height, std::size_t channels,
                               const SatConfig& config = {});

  /// The same of another image of this size, in the memory that is there: new memory costs more
  /// than the table. After an exception the table holds nothing of use.
  void rebuild(std::span<const float> pixels);
  void rebuild(std::span<const std::uint8_t> pixels);
  void rebuild(std::span<const std::uint16_t> pixels);
  void rebuild(std::span<const std::uint32_t> pixels);

  [[nodiscard]] std::size_t width() const { return layout_.width; }
  [[nodiscard]] std::size_t height() const { return layout_.height; }
  [[nodiscard]] std::size_t channels() const { return layout_.channels; }
  [[nodiscard]] SatKind kind() const { return config_.kind; }
  [[nodiscard]] const SatLayout& layout() const { return layout_; }
  /// Scale and largest box of the fixed kinds.
  [[nodiscard]] const FixedPoint& fixed_point() const { return fixed_; }
  /// What float32-centred took away.
  [[nodiscard]] const std::array<float, kSatMaxChannels>& mean() const { return mean_; }

  /// Sum over pixels x0 ≤ x < x1, y0 ≤ y < y1. Throws ValueError if the bounds are not ordered or
  /// not inside, or a fixed kind's box is larger than the largest.
  [[nodiscard]] SatSums box_sum(std::size_t x0, std::size_t y0, std::size_t x1,
                                std::size_t y1) const;
  /// The same of the quantised values (units of 1/scale), exact, of a fixed kind. Throws ValueError
  /// also if the kind is not fixed.
  [[nodiscard]] std::array<std::int64_t, kSatMaxChannels> box_units(std::size_t x0, std::size_t y0,
                                                                    std::size_t x1,
                                                                    std::size_t y1) const;
  /// Mean over the rectangle [x0, x1] × [y0, y1], where pixel (i, j) is the square from (i, j) to
  /// (i + 1, j + 1): exact for the piecewise-constant image. It may reach beyond the image. Up to 9
  /// boxes inside. Throws ValueError: a rectangle without area, not finite or beyond ±2^30, a part
  /// that is larger than the largest box; ShapeError: an image without pixels.
  [[nodiscard]] SatSums box_mean(double x0, double y0, double x1, double y1,
                                 const BorderRule& border = {}) const;

  using Storage = std::variant<HugeArray<std::uint32_t>, HugeArray<std::uint64_t>,
                               HugeArray<double>, HugeArray<float>>;
  /// The sums themselves, laid out as layout() says.
  [[nodiscard]] const Storage& storage() const { return storage_; }

 private:
  SummedAreaTable(std::size_t width, std::size_t height, std::size_t channels,
                  const SatConfig& config);
  template <class In>
  void fill(std::span<const In> pixels);
  void check_box(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1) const;

  SatConfig config_;
  SatLayout layout_;
  Storage storage_;
  FixedPoint fixed_;
  std::array<float, kSatMaxChannels> mean_{};
};

}  // namespace relumbre
