/// Box sums of one type of table, unchecked: the inside of queries and filters.
#pragma once

#include <type_traits>
#include <variant>

#include "relumbre/sat/summed_area_table.h"

namespace relumbre {

/// Reads boxes from a table that must outlive it. Nothing is checked: bounds are ordered and inside
/// the image, boxes of fixed kinds no larger than the largest.
template <class T>
class BoxReader {
 public:
  BoxReader(const SummedAreaTable& table, const HugeArray<T>& sums)
      : layout_(table.layout()),
        sums_(sums.data()),
        fixed_(table.fixed_point()),
        unit_(fixed_.unit()),
        mean_(table.mean()) {}

  [[nodiscard]] std::size_t channels() const { return layout_.channels; }

  /// total(c) += weight · Σ over the box, for every channel.
  void add(std::size_t x0, std::size_t y0, std::size_t x1, std::size_t y1, double weight,
           SatSums& total) const {
    const T *a = at(x0, y0), *b = at(x1, y0), *c = at(x0, y1), *d = at(x1, y1);
    const std::size_t pixels = (x1 - x0) * (y1 - y0);
    for (std::size_t i = 0; i < layout_.channels; ++i) {
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
  [[nodiscard]] SatSums mean(const AxisWindow& across, const AxisWindow& down,
                             const BorderRule& border) const {
    SatSums total{};
    for (const AxisSegment& v : down.segments()) {
      for (const AxisSegment& h : across.segments())
        add(h.begin, v.begin, h.end, v.end, h.weight * v.weight, total);
    }
    const double area = across.length() * down.length();
    const double beyond = area - across.covered() * down.covered();
    for (std::size_t i = 0; i < layout_.channels; ++i) {
      if (border.mode == Border::kConstant) total[i] += beyond * double{border.value[i]};
      total[i] /= area;
    }
    return total;
  }

 private:
  [[nodiscard]] const T* at(std::size_t x, std::size_t y) const { return sums_ + layout_.at(x, y); }

  SatLayout layout_;
  const T* sums_;
  FixedPoint fixed_;
  double unit_;
  std::array<float, kSatMaxChannels> mean_;
};

/// Calls use(reader) with the reader for the table's type.
template <class Use>
auto with_reader(const SummedAreaTable& table, Use&& use) {
  return std::visit(
      [&]<class T>(const HugeArray<T>& sums) { return use(BoxReader<T>(table, sums)); },
      table.storage());
}

}  // namespace relumbre
