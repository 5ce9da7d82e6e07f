#include "relumbre/base/content_hash.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace relumbre {

namespace {

static_assert(std::endian::native == std::endian::little, "XXH64 reads little-endian words");

constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87ULL;
constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4FULL;
constexpr std::uint64_t kPrime3 = 0x165667B19E3779F9ULL;
constexpr std::uint64_t kPrime4 = 0x85EBCA77C2B2AE63ULL;
constexpr std::uint64_t kPrime5 = 0x27D4EB2F165667C5ULL;

template <class Word>
std::uint64_t word(const std::byte* bytes) {
  Word w;
  std::memcpy(&w, bytes, sizeof w);
  return w;
}

constexpr std::uint64_t round(std::uint64_t lane, std::uint64_t input) {
  return std::rotl(lane + input * kPrime2, 31) * kPrime1;
}

constexpr std::uint64_t avalanche(std::uint64_t h) {
  h = (h ^ (h >> 33)) * kPrime2;
  h = (h ^ (h >> 29)) * kPrime3;
  return h ^ (h >> 32);
}

std::uint64_t merge(const std::array<std::uint64_t, 4>& lanes) {
  std::uint64_t h = std::rotl(lanes[0], 1) + std::rotl(lanes[1], 7) + std::rotl(lanes[2], 12) +
                    std::rotl(lanes[3], 18);
  for (const std::uint64_t lane : lanes) h = (h ^ round(0, lane)) * kPrime1 + kPrime4;
  return h;
}

/// Folds in the last, incomplete stripe: words of 8, 4 and 1 bytes.
std::uint64_t fold_tail(std::uint64_t h, std::span<const std::byte> tail) {
  std::size_t i = 0;
  for (; i + 8 <= tail.size(); i += 8) {
    h ^= round(0, word<std::uint64_t>(&tail[i]));
    h = std::rotl(h, 27) * kPrime1 + kPrime4;
  }
  for (; i + 4 <= tail.size(); i += 4) {
    h ^= word<std::uint32_t>(&tail[i]) * kPrime1;
    h = std::rotl(h, 23) * kPrime2 + kPrime3;
  }
  for (; i < tail.size(); ++i) {
    h ^= word<std::uint8_t>(&tail[i]) * kPrime5;
    h = std::rotl(h, 11) * kPrime1;
  }
  return h;
}

}  // namespace

void ContentHash::consume(const std::byte* stripe) {
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    lanes_[i] = round(lanes_[i], word<std::uint64_t>(stripe + 8 * i));
  }
}

void ContentHash::add(std::span<const std::byte> bytes) {
  length_ += bytes.size();
  if (pending_size_ > 0) {
    const std::size_t taken = std::min(kStripe - pending_size_, bytes.size());
    std::copy_n(bytes.begin(), taken,
                pending_.begin() + static_cast<std::ptrdiff_t>(pending_size_));
    pending_size_ += taken;
    bytes = bytes.subspan(taken);
    if (pending_size_ < kStripe) return;
    consume(pending_.data());
    pending_size_ = 0;
  }
  for (; bytes.size() >= kStripe; bytes = bytes.subspan(kStripe)) consume(bytes.data());
  std::copy(bytes.begin(), bytes.end(), pending_.begin());
  pending_size_ = bytes.size();
}

std::uint64_t ContentHash::digest() const {
  const std::uint64_t h = length_ >= kStripe ? merge(lanes_) : kPrime5;
  return avalanche(fold_tail(h + length_, std::span(pending_).first(pending_size_)));
}

std::uint64_t content_hash(std::span<const std::byte> bytes) {
  ContentHash hash;
  hash.add(bytes);
  return hash.digest();
}

}  // namespace relumbre
