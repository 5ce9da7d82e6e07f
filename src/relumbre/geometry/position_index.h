/// Numbers points so that equal points share a number.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Halfway between two points; midpoint(a, b) and midpoint(b, a) agree to the last bit, so that the
/// triangles on both sides of an edge cut it at the same point.
constexpr Vec3f midpoint(const Vec3f& a, const Vec3f& b) { return (a + b) * 0.5F; }

/// A hash table from points to consecutive indices. Points are equal if their bits are; -0 counts
/// as 0. Open addressing, at most half full: expected O(1) a query, 8 to 16 bytes a point beside
/// the point itself.
class PositionIndex {
 public:
  explicit PositionIndex(std::size_t expected_points = 0);
  explicit PositionIndex(std::span<const Vec3f> points);

  /// The index of p, which is added at the end if it is new.
  std::uint32_t insert(Vec3f p);
  /// The index of p, or kNone.
  [[nodiscard]] std::uint32_t find(Vec3f p) const;

  [[nodiscard]] const std::vector<Vec3f>& positions() const { return positions_; }
  [[nodiscard]] const Vec3f& operator[](std::uint32_t i) const { return positions_[i]; }

 private:
  [[nodiscard]] std::size_t slot_of(const Vec3f& p) const;
  void rehash(std::size_t slots);

  std::vector<Vec3f> positions_;
  std::vector<std::uint32_t> slots_;  ///< power of two; kNone where empty
};

}  // namespace relumbre
