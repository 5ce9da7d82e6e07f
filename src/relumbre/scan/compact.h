/// Stream compaction and stable partition: the scan of "is it kept" says where each element goes.
///
/// Elements keep their order. The predicate is called more than once for an element, by several
/// threads at once, and must return the same every time. Input and output must not overlap
/// (ValueError) and are of equal size (ShapeError). compact() reads memory once; partition() twice.
#pragma once

#include <atomic>
#include <cstddef>
#include <span>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan.h"

namespace relumbre {

namespace scan_detail {

/// Prefixes count what is kept. place(i, kept, is_kept) puts element i, with `kept` before it.
template <class T, class Keep, class Place>
class CompactWork {
 public:
  static constexpr bool kOnePass = true;
  static constexpr std::size_t kWorthThreads = 2, kGroup = 1;

  CompactWork(std::span<const T> in, const Keep& keep, const Place& place)
      : in_(in), keep_(keep), place_(place) {}

  [[nodiscard]] std::size_t identity() const { return 0; }
  [[nodiscard]] std::size_t combine(std::size_t a, std::size_t b) const { return a + b; }
  [[nodiscard]] std::size_t fold(std::size_t first, std::size_t last) const {
    std::size_t kept = 0;
    for (std::size_t i = first; i < last; ++i) kept += keep_(in_[i]) ? 1 : 0;
    return kept;
  }
  std::size_t scan(std::size_t first, std::size_t last, std::size_t kept) const {
    for (std::size_t i = first; i < last; ++i) {
      const bool is_kept = keep_(in_[i]);
      place_(i, kept, is_kept);
      kept += is_kept ? 1 : 0;
    }
    return kept;
  }

 private:
  std::span<const T> in_;
  const Keep& keep_;
  const Place& place_;
};

template <class T, class Keep, class Place>
std::size_t place_all(std::span<const T> in, const Keep& keep, const Place& place) {
  CompactWork<T, Keep, Place> work(in, keep, place);
  return chained::scan_tiles({in.size(), kTile<T>}, false, work);
}

template <class T, class Keep>
std::size_t count_kept(std::span<const T> in, const Keep& keep) {
  std::atomic<std::size_t> total = 0;
  parallel_chunks(0, in.size(), kTile<T>, [&](std::size_t first, std::size_t last) {
    std::size_t kept = 0;
    for (std::size_t i = first; i < last; ++i) kept += keep(in[i]) ? 1 : 0;
    total += kept;
  });
  return total;
}

}  // namespace scan_detail

/// Copies the elements for which keep(element) holds to the front of `out`. Returns their number;
/// what lies behind them in `out` is left alone.
template <Array In, Array Out, class Keep>
std::size_t compact(const In& in, Out&& out, const Keep& keep) {
  const auto from = scan_detail::input(in);
  const auto to = scan_detail::output(out);
  check::same_size("compact", "output", to.size(), from.size());
  check::disjoint("compact", from, scan_detail::input(out));
  return scan_detail::place_all(from, keep, [=](std::size_t i, std::size_t kept, bool is_kept) {
    if (is_kept) to[kept] = from[i];
  });
}

struct Partition {
  template <Array In, Array Out, class IsFirst>
  std::size_t operator()(const In& in, Out&& out, const IsFirst& is_first) const {
    const auto from = scan_detail::input(in);
    const auto to = scan_detail::output(out);
    check::same_size("partition", "output", to.size(), from.size());
    check::disjoint("partition", from, scan_detail::input(out));
    const std::size_t firsts = scan_detail::count_kept(from, is_first);
    return scan_detail::place_all(from, is_first,
                                  [=](std::size_t i, std::size_t kept, bool is_kept) {
                                    to[is_kept ? kept : firsts + (i - kept)] = from[i];
                                  });
  }
};

/// partition(in, out, is_first): copies the elements for which is_first(element) holds to the front
/// of `out` and all others behind them. Returns the number of the former. An object, or a call with
/// vectors would find the standard library's as well.
inline constexpr Partition partition;

}  // namespace relumbre
