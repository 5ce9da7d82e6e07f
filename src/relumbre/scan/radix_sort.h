/// A stable sort of keys and what belongs to them, digit by digit; every digit's places are one
/// exclusive scan of its counts (Satish, Harris and Garland 2009, on threads).
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/check.h"
#include "relumbre/scan/scan.h"

namespace relumbre {

namespace radix_detail {

inline constexpr unsigned kDigitBits = 8;
inline constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
inline constexpr std::size_t kChunk = std::size_t{1} << 16;

/// By the digit at `shift`, from one pair of arrays into the other.
template <class Key, class Value>
void sort_by_digit(const std::vector<Key>& keys, const std::vector<Value>& values, unsigned shift,
                   std::vector<Key>& sorted_keys, std::vector<Value>& sorted_values) {
  const auto digit = [&](std::size_t i) { return (keys[i] >> shift) & (kDigits - 1); };
  const std::size_t size = keys.size(), chunks = (size + kChunk - 1) / kChunk;
  // All chunks' counts of digit 0, then of digit 1, ...: their scan is where each run begins.
  std::vector<std::size_t> places(kDigits * chunks);
  parallel_chunks(0, size, kChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) ++places[digit(i) * chunks + first / kChunk];
  });
  exclusive_scan(places, places);
  parallel_chunks(0, size, kChunk, [&](std::size_t first, std::size_t last) {
    std::array<std::size_t, kDigits> place;
    for (std::size_t d = 0; d < kDigits; ++d) place[d] = places[d * chunks + first / kChunk];
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t to = place[digit(i)]++;
      sorted_keys[to] = keys[i];
      sorted_values[to] = values[i];
    }
  });
}

}  // namespace radix_detail

/// Sorts `keys` by their lowest `bits` bits (the others are taken to be equal), and `values` along
/// with them; equal keys keep their order. As many passes as there are bytes in `bits`; needs as
/// much memory again. Throws ShapeError where sizes differ.
template <std::unsigned_integral Key, class Value>
void radix_sort(std::vector<Key>& keys, std::vector<Value>& values, unsigned bits) {
  check::same_size("radix_sort", "values", values.size(), keys.size());
  std::vector<Key> other_keys(keys.size());
  std::vector<Value> other_values(values.size());
  for (unsigned shift = 0; shift < bits; shift += radix_detail::kDigitBits) {
    radix_detail::sort_by_digit(keys, values, shift, other_keys, other_values);
    keys.swap(other_keys);
    values.swap(other_values);
  }
}

}  // namespace relumbre
