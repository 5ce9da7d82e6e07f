/// Axis-aligned boxes.
#pragma once

#include <limits>
#include <span>

#include "relumbre/base/vec3.h"

namespace relumbre {

struct Box {
  Vec3f lower{std::numeric_limits<float>::infinity()};
  Vec3f upper{-std::numeric_limits<float>::infinity()};

  void extend(const Vec3f& p) { lower = min(lower, p), upper = max(upper, p); }
  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x); }
  [[nodiscard]] Vec3f center() const { return (lower + upper) * 0.5F; }
  [[nodiscard]] Vec3f size() const { return empty() ? Vec3f{} : upper - lower; }
  [[nodiscard]] float diagonal() const { return length(size()); }
};

inline Box bounds(std::span<const Vec3f> points) {
  Box box;
  for (const Vec3f& p : points) box.extend(p);
  return box;
}

}  // namespace relumbre
