/// Associative operations with an identity, for scans. Host and device.
///
/// A monoid is a small object with
///   value_type            what is accumulated
///   identity()            e with e ∘ a = a ∘ e = a
///   operator()(a, b)      a ∘ b, associative, not necessarily commutative: a comes first
///   exact (optional)      true if every grouping of a ∘ b ∘ c ... has the same bits
/// Floating-point addition is associative only up to rounding. A scan groups it in one fixed way.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include "relumbre/base/host_device.h"

namespace relumbre {

template <class M>
concept Monoid = requires(const M m, const typename M::value_type a) {
  { m.identity() } -> std::same_as<typename M::value_type>;
  { m(a, a) } -> std::same_as<typename M::value_type>;
};

/// Whether every grouping gives the same bits. Not known to be so unless the monoid says it.
template <class M>
inline constexpr bool kIsExact = false;
template <class M>
requires requires { M::exact; }
inline constexpr bool kIsExact<M> = M::exact;

/// a + b. Integers wrap around.
template <class T>
struct Plus {
  using value_type = T;
  static constexpr bool exact = std::integral<T>;
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T identity() const { return T{}; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T operator()(const T& a, const T& b) const {
    if constexpr (std::integral<T>) {
      // Narrow types are promoted to int, whose overflow is undefined; wide ones are not.
      using Wide = std::common_type_t<unsigned, std::make_unsigned_t<T>>;
      return static_cast<T>(static_cast<Wide>(a) + static_cast<Wide>(b));
    } else {
      return a + b;
    }
  }
};

/// The smaller one; of equals the first. NaN is skipped.
template <class T>
struct Min {
  using value_type = T;
  static constexpr bool exact = true;
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T identity() const {
    using Limits = std::numeric_limits<T>;
    return Limits::has_infinity ? Limits::infinity() : Limits::max();
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T operator()(T a, T b) const {
    return b < a || a != a ? b : a;
  }
};

/// The larger one; of equals the first. NaN is skipped.
template <class T>
struct Max {
  using value_type = T;
  static constexpr bool exact = true;
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T identity() const {
    using Limits = std::numeric_limits<T>;
    return Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T operator()(T a, T b) const {
    return a < b || a != a ? b : a;
  }
};

/// x ↦ scale·x + offset.
template <class T>
struct Affine {
  T scale{1}, offset{};
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr T operator()(T x) const {
    return scale * x + offset;
  }
  friend bool operator==(const Affine&, const Affine&) = default;
};

/// Affine maps under "first a, then b". Not commutative.
template <class T>
struct Compose {
  using value_type = Affine<T>;
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr Affine<T> identity() const { return {}; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE constexpr Affine<T> operator()(const Affine<T>& a,
                                                                    const Affine<T>& b) const {
    return {b.scale * a.scale, b(a.offset)};
  }
};

/// A value and whether a segment begins at it or before it.
template <class T>
struct Headed {
  bool head = false;
  T value{};
};

/// M within segments: nothing from before a head gets past it (Blelloch 1990, §1.5).
template <Monoid M>
struct Segmented {
  using value_type = Headed<typename M::value_type>;
  static constexpr bool exact = kIsExact<M>;
  M inner{};
  [[nodiscard]] RELUMBRE_HOST_DEVICE value_type identity() const {
    return {false, inner.identity()};
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE value_type operator()(const value_type& a,
                                                           const value_type& b) const {
    return {a.head || b.head, b.head ? b.value : inner(a.value, b.value)};
  }
};

}  // namespace relumbre
