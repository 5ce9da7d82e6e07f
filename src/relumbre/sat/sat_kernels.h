/// The inner loops that build a summed-area table, compiled once per instruction set.
///
/// Every sum is made by additions whose order is written down here and depends on nothing else, so
/// that all instruction sets give the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace relumbre {

/// Pixels that a kernel handles at least together. Rows of buffers and tables hold whole groups.
inline constexpr std::size_t kSatGroup = 16;

/// A part of a row of the image and where its sums go. `sums` and `row` begin cache lines.
template <class In, class T>
struct SatRow {
  const In* values = nullptr;
  std::size_t pixels = 0;    ///< whole groups
  std::ptrdiff_t ahead = 0;  ///< bytes from a value to the one to ask memory for meanwhile
  T* carry = nullptr;        ///< four numbers: the row's sum so far, brought up to its end
  T* sums = nullptr;         ///< the row of the table above; becomes this row
  T* row = nullptr;          ///< where this row is written
};

/// How a real value becomes a summand.
struct SatConversion {
  /// Unsigned tables: round(value · scale), half to even, modulo 2^32 or 2^64. A power of two.
  double scale = 1;
  /// Float32 tables: value − subtrahend, one for each lane of a group of kSatGroup pixels.
  const float* subtrahend = nullptr;
  /// Unsigned tables: every value must lie in between, which makes |value · scale| < 2^31 or 2^51.
  float lowest = 0, highest = 0;
};

/// sums(p) += carry + summand(0) + … + summand(p), and row(p) = sums(p), for every pixel p. Of each
/// four pixels a b c d, what is added is carry + a, carry + (a + b), carry + ((a + b) + c) and
/// carry + ((a + b) + (c + d)); the last is the next carry. Reads up to one element past the
/// values and the sums. Returns false if a value (or a NaN) was out of range.
template <class T>
struct SatKernels {
  using FromFloat = bool (*)(const SatRow<float, T>&, const SatConversion&);
  using FromSummands = bool (*)(const SatRow<T, T>&, const SatConversion&);

  std::string_view name;
  // One for each number of channels; `stream` writes `row` past the caches.
  FromFloat store_floats[4], stream_floats[4];
  FromSummands store_summands[4], stream_summands[4];
};

/// The kernels for the best instruction set that this CPU has. T: uint32, uint64, float, double.
template <class T>
const SatKernels<T>& best_sat_kernels();

/// Every set of kernels that this CPU can run, for tests. Not thread-safe.
template <class T>
std::vector<SatKernels<T>> available_sat_kernels();

}  // namespace relumbre
