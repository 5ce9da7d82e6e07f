#include "relumbre/geometry/position_index.h"

#include <array>
#include <bit>

#include "relumbre/base/sampling.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {
namespace {

using Bits = std::array<std::uint32_t, 3>;

Bits bits_of(const Vec3f& p) { return std::bit_cast<Bits>(p); }

std::uint64_t hash_of(const Bits& b) {
  return hash64((std::uint64_t{b[0]} << 32 | b[1]) ^ hash64(b[2]));
}

/// -0 + 0 is +0; every other value keeps its bits.
Vec3f without_negative_zero(const Vec3f& p) { return p + Vec3f(0.0F); }

std::size_t slots_for(std::size_t points) {
  return std::bit_ceil(std::max<std::size_t>(16, 2 * points));
}

}  // namespace

PositionIndex::PositionIndex(std::size_t expected_points) {
  positions_.reserve(expected_points);
  slots_.assign(slots_for(expected_points), kNone);
}

PositionIndex::PositionIndex(std::span<const Vec3f> points) : PositionIndex(points.size()) {
  for (const Vec3f& p : points) insert(p);
}

std::size_t PositionIndex::slot_of(const Vec3f& p) const {
  const Bits key = bits_of(p);
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash_of(key) & mask;
  while (slots_[slot] != kNone && bits_of(positions_[slots_[slot]]) != key) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

void PositionIndex::rehash(std::size_t slots) {
  slots_.assign(slots, kNone);
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    slots_[slot_of(positions_[i])] = static_cast<std::uint32_t>(i);
  }
}

std::uint32_t PositionIndex::insert(Vec3f p) {
  p = without_negative_zero(p);
  std::size_t slot = slot_of(p);
  if (slots_[slot] != kNone) return slots_[slot];
  if (2 * (positions_.size() + 1) > slots_.size()) {
    rehash(2 * slots_.size());
    slot = slot_of(p);
  }
  slots_[slot] = static_cast<std::uint32_t>(positions_.size());
  positions_.push_back(p);
  return slots_[slot];
}

std::uint32_t PositionIndex::find(Vec3f p) const {
  return slots_[slot_of(without_negative_zero(p))];
}

}  // namespace relumbre
