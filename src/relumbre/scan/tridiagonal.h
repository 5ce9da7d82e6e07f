/// Tridiagonal systems by scans.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "relumbre/scan/recurrence.h"

namespace relumbre {

/// x ↦ (p·x + q) / (r·x + s): a 2×2 matrix, up to a factor.
template <class T>
struct Fraction {
  T p{1}, q{}, r{}, s{1};
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T operator()(T x) const {
    return (p * x + q) / (r * x + s);
  }
};

/// Fractions under "first a, then b": the product of their matrices, scaled against overflow.
template <class T>
struct ComposeFractions {
  using value_type = Fraction<T>;
  [[nodiscard]] RELUMBRE_HOST_DEVICE Fraction<T> identity() const { return {}; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE Fraction<T> operator()(const Fraction<T>& a,
                                                            const Fraction<T>& b) const {
    Fraction<T> f{b.p * a.p + b.q * a.r, b.p * a.q + b.q * a.s, b.r * a.p + b.s * a.r,
                  b.r * a.q + b.s * a.s};
    const T size = std::abs(f.p) + std::abs(f.q) + std::abs(f.r) + std::abs(f.s);
    if (size > 0) f.p /= size, f.q /= size, f.r /= size, f.s /= size;
    return f;
  }
};

namespace scan_detail {

template <class T>
struct Tridiagonal {
  std::span<const T> lower, diagonal, upper, rhs;
  [[nodiscard]] std::size_t size() const { return diagonal.size(); }
  [[nodiscard]] T below(std::size_t i) const { return i == 0 ? T{} : lower[i]; }
  [[nodiscard]] T above(std::size_t i) const { return i + 1 == size() ? T{} : upper[i]; }
  /// What is left of the diagonal once x[i-1] has been eliminated from row i.
  [[nodiscard]] T pivot(std::size_t i, std::span<const T> ratio) const {
    return i == 0 ? diagonal[0] : diagonal[i] - lower[i] * ratio[i - 1];
  }
  /// False for NaN.
  [[nodiscard]] bool is_dominated(std::size_t i) const {
    const T d = std::abs(diagonal[i]);
    return std::isfinite(d) && d > 0 && d >= std::abs(below(i)) + std::abs(above(i));
  }
};

template <class T>
void check_rows(const Tridiagonal<T>& system) {
  for (std::size_t i = 0; i < system.size(); ++i) {
    if (!system.is_dominated(i))
      throw ValueError("solve_tridiagonal: row " + std::to_string(i) +
                       " is not diagonally dominant");
  }
}

/// ratio[i] = upper[i] / pivot[i], by a scan of 2×2 matrices.
template <class T>
std::vector<T> eliminate(const Tridiagonal<T>& system) {
  std::vector<T> ratio(system.size());
  const auto map = [&](std::size_t i) {
    return Fraction<T>{T{}, system.above(i), -system.below(i), system.diagonal[i]};
  };
  run_recurrence<ComposeFractions<T>>(system.size(), T{}, map,
                                      [&](std::size_t i, T value) { ratio[i] = value; });
  for (std::size_t i = 0; i < system.size(); ++i) {
    if (!std::isfinite(ratio[i]) || system.pivot(i, ratio) == 0)
      throw ValueError("solve_tridiagonal: singular at row " + std::to_string(i));
  }
  return ratio;
}

}  // namespace scan_detail

/// Solves lower[i]·x[i-1] + diagonal[i]·x[i] + upper[i]·x[i+1] = rhs[i]; lower[0] and upper[n-1]
/// are not used. All arrays are of equal size (ShapeError). x may be rhs; any other overlap is
/// refused.
///
/// Three scans: pivots by 2×2 matrices, then the forward and the backward sweep as linear
/// recurrences; within strips of a tile they are the Thomas algorithm. They are stable, without
/// pivoting, for diagonally dominant rows, |diagonal[i]| ≥ |lower[i]| + |upper[i]|, since then
/// every |upper/pivot| ≤ 1. Throws ValueError that names the first row which is not so, or is not
/// finite, or where the matrix turns out to be singular. Cost: about 40 operations and 100 bytes
/// (float64: 200) of memory traffic an unknown.
template <std::floating_point T>
void solve_tridiagonal(std::type_identity_t<std::span<const T>> lower,
                       std::type_identity_t<std::span<const T>> diagonal,
                       std::type_identity_t<std::span<const T>> upper,
                       std::type_identity_t<std::span<const T>> rhs, std::span<T> x) {
  const char* name = "solve_tridiagonal";
  for (const auto& [what, array] : {std::pair{"lower", lower},
                                    {"diagonal", diagonal},
                                    {"upper", upper},
                                    {"right-hand side", rhs}})
    check::same_size(name, what, array.size(), x.size());
  for (const auto& array : {lower, diagonal, upper})
    check::disjoint(name, array, std::span<const T>(x));
  check::in_place_or_disjoint(name, rhs, std::span<const T>(x));
  if (x.empty()) return;

  const scan_detail::Tridiagonal<T> system{lower, diagonal, upper, rhs};
  scan_detail::check_rows(system);
  const std::vector<T> ratio = scan_detail::eliminate(system);
  // x[i] = (rhs[i] - lower[i]·x[i-1]) / pivot[i]
  const auto forward = [&](std::size_t i) {
    const T pivot = system.pivot(i, ratio);
    return Affine<T>{-system.below(i) / pivot, rhs[i] / pivot};
  };
  scan_detail::run_recurrence<Compose<T>>(x.size(), T{}, forward,
                                          [&](std::size_t i, T value) { x[i] = value; });
  // x[i] -= ratio[i]·x[i+1], from the last row up.
  const std::size_t last = x.size() - 1;
  const auto backward = [&](std::size_t i) { return Affine<T>{-ratio[last - i], x[last - i]}; };
  scan_detail::run_recurrence<Compose<T>>(x.size(), T{}, backward,
                                          [&](std::size_t i, T value) { x[last - i] = value; });
}

}  // namespace relumbre
