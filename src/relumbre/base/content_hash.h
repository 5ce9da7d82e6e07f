/// A fast 64-bit hash of bytes, for noticing damage. It is no defence against forgery.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace relumbre {

/// XXH64 with seed 0, fed piece by piece: however the bytes are cut, the digest is the same.
/// Several GB/s. Source: Collet, "XXH64 digest", the xxHash specification.
class ContentHash {
 public:
  void add(std::span<const std::byte> bytes);
  /// The bytes of numbers, or of structures of numbers without padding.
  template <class T>
  void add_values(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(values));
  }
  template <class T>
  void add_value(const T& value) {
    add_values(std::span(&value, 1));
  }
  /// The hash of everything added so far.
  [[nodiscard]] std::uint64_t digest() const;

 private:
  static constexpr std::size_t kStripe = 32;
  void consume(const std::byte* stripe);

  static constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87ULL;
  static constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4FULL;
  std::array<std::uint64_t, 4> lanes_{kPrime1 + kPrime2, kPrime2, 0, 0 - kPrime1};
  std::array<std::byte, kStripe> pending_{};
  std::size_t pending_size_ = 0;
  std::uint64_t length_ = 0;
};

[[nodiscard]] std::uint64_t content_hash(std::span<const std::byte> bytes);

}  // namespace relumbre
