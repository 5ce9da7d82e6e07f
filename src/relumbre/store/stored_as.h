/// The numbers that a store's arrays hold, and how C++ values lie in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {

/// Always little-endian in the file.
enum class Number { kU8, kU16, kU32, kU64, kI32, kF32, kF64 };

/// Lengths along each axis, slowest first.
using Extent = std::vector<std::uint64_t>;

/// A T is a row of kWidth numbers; rows of one number make a one-dimensional array.
template <Number N, std::size_t Width = 1>
struct RowOf {
  static constexpr Number kNumber = N;
  static constexpr std::size_t kWidth = Width;
};

template <class T>
struct StoredAs;
template <>
struct StoredAs<std::uint8_t> : RowOf<Number::kU8> {};
template <>
struct StoredAs<std::uint16_t> : RowOf<Number::kU16> {};
template <>
struct StoredAs<std::uint32_t> : RowOf<Number::kU32> {};
template <>
struct StoredAs<std::uint64_t> : RowOf<Number::kU64> {};
template <>
struct StoredAs<std::int32_t> : RowOf<Number::kI32> {};
template <>
struct StoredAs<float> : RowOf<Number::kF32> {};
template <>
struct StoredAs<double> : RowOf<Number::kF64> {};
template <>
struct StoredAs<Vec3f> : RowOf<Number::kF32, 3> {};
template <>
struct StoredAs<Vec2f> : RowOf<Number::kF32, 2> {};
template <>
struct StoredAs<Index3> : RowOf<Number::kU32, 3> {};
/// Three corners, the source triangle, 1 for its back side.
template <>
struct StoredAs<Facet> : RowOf<Number::kU32, 5> {};

template <class T>
Extent extent_of(std::uint64_t rows) {
  static_assert(sizeof(T) % StoredAs<T>::kWidth == 0 && std::is_trivially_copyable_v<T>);
  constexpr std::uint64_t width = StoredAs<T>::kWidth;
  return width == 1 ? Extent{rows} : Extent{rows, width};
}

}  // namespace relumbre
