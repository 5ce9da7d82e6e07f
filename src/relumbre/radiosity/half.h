/// IEEE 754 half-precision numbers, for storage.
#pragma once

#include <bit>
#include <cstdint>

namespace relumbre {

/// 1 sign bit, 5 exponent bits, 10 fraction bits.
class Half {
 public:
  static constexpr std::uint32_t kLargest = 65504;

  Half() = default;
  /// Rounds to nearest, ties to even. |value| must be 0 or in [2^-14, kLargest].
  explicit constexpr Half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = bits >> 31 << 15;
    const std::uint32_t magnitude = bits & 0x7FFFFFFFU;
    if (magnitude == 0) {
      bits_ = static_cast<std::uint16_t>(sign);
      return;
    }
    // 13 fraction bits go; exponents are biased by 127 in float32 and by 15 here.
    const std::uint32_t odd = magnitude >> 13 & 1;
    const std::uint32_t rounded = (magnitude + 0xFFFU + odd) >> 13;
    bits_ = static_cast<std::uint16_t>(sign | (rounded - ((127U - 15U) << 10)));
  }
  explicit constexpr operator float() const {
    const std::uint32_t magnitude = bits_ & 0x7FFFU;
    const std::uint32_t sign = static_cast<std::uint32_t>(bits_ >> 15) << 31;
    if (magnitude == 0) return std::bit_cast<float>(sign);
    return std::bit_cast<float>(sign | ((magnitude + ((127U - 15U) << 10)) << 13));
  }

 private:
  std::uint16_t bits_ = 0;
};

}  // namespace relumbre
