/// Checks of arguments that all scans share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <string>

#include "relumbre/base/error.h"

namespace relumbre {

/// What scans take: vectors, arrays, spans.
template <class R>
concept Array = std::ranges::contiguous_range<R> && std::ranges::sized_range<R>;

namespace check {

/// Throws ShapeError unless both are equal.
inline void same_size(const char* function, const char* what, std::size_t size, std::size_t asked) {
  if (size == asked) return;
  throw ShapeError(std::string(function) + ": " + what + " has " + std::to_string(size) +
                   " elements, not " + std::to_string(asked));
}

/// Whether the arrays share any byte.
template <class A, class B>
[[nodiscard]] bool overlap(std::span<const A> a, std::span<const B> b) {
  const auto a0 = reinterpret_cast<std::uintptr_t>(a.data());
  const auto b0 = reinterpret_cast<std::uintptr_t>(b.data());
  return a0 < b0 + b.size_bytes() && b0 < a0 + a.size_bytes();
}

/// Throws ValueError if the arrays share any byte.
template <class A, class B>
void disjoint(const char* function, std::span<const A> a, std::span<const B> b) {
  if (overlap(a, b)) throw ValueError(std::string(function) + ": input and output overlap");
}

/// Throws ValueError if the arrays overlap and are not one and the same.
template <class A, class B>
void in_place_or_disjoint(const char* function, std::span<const A> a, std::span<const B> b) {
  const bool same = static_cast<const void*>(a.data()) == static_cast<const void*>(b.data());
  if (!(same && sizeof(A) == sizeof(B))) disjoint(function, a, b);
}

}  // namespace check
}  // namespace relumbre
