/// First-order linear recurrences x_i = a_i·x_{i-1} + b_i, by a scan of affine maps (Kogge and
/// Stone 1973; Blelloch 1990, §1.4). Polynomials (Horner), recursive filters, the sweeps of a
/// tridiagonal solve.
///
/// A tile is cut into kStrips strips that run side by side, since one alone would wait for its own
/// last result all the time; their maps' composites give each strip and each tile its start.
/// The a_i of one tile are multiplied together: their product must not overflow. |a_i| ≤ 1 is
/// always safe, and errors do not grow then.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>

#include "relumbre/scan/scan.h"

namespace relumbre {

enum class Direction { kForward, kBackward };

namespace scan_detail {

/// map(i) is what takes the state before element i to the state after it; M composes such maps,
/// whose operator() applies them. store(i, state) takes the state after i.
template <Monoid M, class State, class Map, class Store>
class RecurrenceWork {
 public:
  static constexpr bool kOnePass = false;
  static constexpr std::size_t kWorthThreads = 2, kGroup = 1;
  using Composite = typename M::value_type;

  RecurrenceWork(State start, const Map& map, const Store& store)
      : start_(start), map_(map), store_(store) {}

  [[nodiscard]] State identity() const { return start_; }
  [[nodiscard]] State combine(State state, const Composite& maps) const { return maps(state); }

  [[nodiscard]] Composite fold(std::size_t first, std::size_t last) const {
    const Strips strips(first, last);
    Composite all = m_.identity();
    for (const Composite& strip : composites(strips)) all = m_(all, strip);
    for (std::size_t i = strips.end(); i < last; ++i) all = m_(all, map_(i));
    return all;
  }

  State scan(std::size_t first, std::size_t last, State state) const {
    const Strips strips(first, last);
    std::array<State, kStrips> states;
    const auto maps = composites(strips);
    for (std::size_t s = 0; s < kStrips; ++s) {
      states[s] = state;
      state = maps[s](state);
    }
    for (std::size_t k = 0; k < strips.length; ++k) {
      for (std::size_t s = 0; s < kStrips; ++s)
        store_(strips.at(s, k), states[s] = map_(strips.at(s, k))(states[s]));
    }
    state = states.back();
    for (std::size_t i = strips.end(); i < last; ++i) store_(i, state = map_(i)(state));
    return state;
  }

 private:
  static constexpr std::size_t kStrips = 8;

  /// Of equal length; up to kStrips - 1 elements are left behind them.
  struct Strips {
    std::size_t first, length;
    Strips(std::size_t begin, std::size_t end_) : first(begin), length((end_ - begin) / kStrips) {}
    [[nodiscard]] std::size_t at(std::size_t s, std::size_t k) const {
      return first + s * length + k;
    }
    [[nodiscard]] std::size_t end() const { return at(kStrips, 0); }
  };

  [[nodiscard]] std::array<Composite, kStrips> composites(const Strips& strips) const {
    std::array<Composite, kStrips> maps;
    maps.fill(m_.identity());
    for (std::size_t k = 0; k < strips.length; ++k) {
      for (std::size_t s = 0; s < kStrips; ++s) maps[s] = m_(maps[s], map_(strips.at(s, k)));
    }
    return maps;
  }

  M m_{};
  State start_;
  const Map& map_;
  const Store& store_;
};

/// The state after the last element.
template <Monoid M, class State, class Map, class Store>
State run_recurrence(std::size_t size, State start, const Map& map, const Store& store) {
  RecurrenceWork<M, State, Map, Store> work(start, map, store);
  return chained::scan_tiles({size, kTile<State>}, false, work);
}

}  // namespace scan_detail

/// x[i] = a[i]·x[i-1] + b[i] with x[-1] = start; backwards x[i] = a[i]·x[i+1] + b[i] with
/// x[n] = start. All arrays are of equal size (ShapeError); x may be a or b, any other overlap
/// is refused (ValueError). Returns the last x computed, `start` if there is none. Same bits
/// whatever the number of threads; not those of a plain loop.
template <Array A, Array B, Array X, std::floating_point T = std::ranges::range_value_t<X>>
T linear_recurrence(const A& a, const B& b, X&& x, T start = 0,
                    Direction direction = Direction::kForward) {
  const auto scale = scan_detail::input(a);
  const auto offset = scan_detail::input(b);
  const auto to = scan_detail::output(x);
  check::same_size("linear_recurrence", "a", scale.size(), to.size());
  check::same_size("linear_recurrence", "b", offset.size(), to.size());
  check::in_place_or_disjoint("linear_recurrence", scale, scan_detail::input(x));
  check::in_place_or_disjoint("linear_recurrence", offset, scan_detail::input(x));
  const std::size_t last = to.size() - 1;
  const bool forward = direction == Direction::kForward;
  const auto at = [=](std::size_t i) { return forward ? i : last - i; };
  const auto map = [=](std::size_t i) {
    return Affine<T>{static_cast<T>(scale[at(i)]), static_cast<T>(offset[at(i)])};
  };
  const auto store = [=](std::size_t i, T value) { to[at(i)] = value; };
  return scan_detail::run_recurrence<Compose<T>>(to.size(), start, map, store);
}

}  // namespace relumbre
