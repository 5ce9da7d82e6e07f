/// Box sums of one type of table, unchecked: the inside of queries and filters. Host and device.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "relumbre/sat/sat_config.h"

namespace relumbre {

/// Reads boxes from a table that must outlive it. Nothing is checked: bounds are ordered and inside
/// the image, boxes of fixed kinds no larger than the largest. kChannels 0: as many as the layout
/// says.
template <class T, std::size_t kChannels = 0>
class BoxReader {
 public:
  /// `mean` is what was taken from every value of each channel.
  BoxReader(const SatLayout& layout, const T* sums, const FixedPoint& fixed,
            const std::array<float, kSatMaxChannels>& mean)
      : layout_(layout), sums_(sums), fixed_(fixed), unit_(fixed_.unit()), mean_(mean) {}

  [[nodiscard]] RELUMBRE_HOST_DEVICE const SatLayout& layout() const { return layout_; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::size_t channels() const {
    return kChannels > 0 ? kChannels : layout_.channels;
  }

  /// total(c) += weight · Σ over the box, for every channel.
  RELUMBRE_HOST_DEVICE void add(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1,
                                double weight, SatSums& total) const {
    const T *a = at(x0, y0), *b = at(x1, y0), *c = at(x0, y1), *d = at(x1, y1);
    const std::size_t pixels = (x1 - x0) * (y1 - y0);
    for (std::size_t i = 0; i < channels(); ++i) {
      if constexpr (std::is_integral_v<T>) {
        const auto units = fixed_.unwrap(static_cast<T>(d[i] - c[i] - b[i] + a[i]), pixels);
        total[i] += weight * (static_cast<double>(units) * unit_);
      } else {
        const double sum = (double{d[i]} - double{c[i]}) - (double{b[i]} - double{a[i]});
        total[i] += weight * (sum + static_cast<double>(pixels) * double{mean_[i]});
      }
    }
  }

  [[nodiscard]] std::int64_t units(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1,
                                   std::size_t i) const requires std::is_integral_v<T> {
    const T *a = at(x0, y0), *b = at(x1, y0), *c = at(x0, y1), *d = at(x1, y1);
    return fixed_.unwrap(static_cast<T>(d[i] - c[i] - b[i] + a[i]), (x1 - x0) * (y1 - y0));
  }

  /// Mean over the product of two windows.
  [[nodiscard]] RELUMBRE_HOST_DEVICE SatSums mean(const AxisWindow& across, const AxisWindow& down,
                                                  const BorderRule& border) const {
    SatSums total{};
    for (const AxisSegment& v : down.segments()) {
      for (const AxisSegment& h : across.segments())
        add(h.begin, v.begin, h.end, v.end, h.weight * v.weight, total);
    }
    const double area = across.length() * down.length();
    const double beyond = area - across.covered() * down.covered();
    for (std::size_t i = 0; i < channels(); ++i) {
      if (border.mode == Border::kConstant) total[i] += beyond * double{border.value[i]};
      total[i] /= area;
    }
    return total;
  }

 private:
  /// All sums of a pixel lie in one aligned piece of up to 16 bytes, or in two: see SatLayout.
  [[nodiscard]] RELUMBRE_HOST_DEVICE const T* at(std::size_t x, std::size_t y) const {
    constexpr std::size_t kBytes = kChannels == 3 ? sizeof(T) : kChannels * sizeof(T);
    const T* sums = sums_ + layout_.at(x, y);
    if constexpr (kChannels > 1) return std::assume_aligned < kBytes <= 16 ? kBytes : 16 > (sums);
    return sums;
  }

  SatLayout layout_;
  const T* sums_;
  FixedPoint fixed_;
  double unit_;
  std::array<float, kSatMaxChannels> mean_;
};

}  // namespace relumbre
