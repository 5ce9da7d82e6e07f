/// When to look for a light by direction instead of choosing a point on it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "relumbre/base/box.h"
#include "relumbre/render/light_sampler.h"

namespace relumbre {

/// A triangle of a light's surface.
struct LightTriangle {
  std::array<Vec3f, 3> corners;
  bool two_sided = false;
};

/// The share of cosine-weighted samples ("probes") for one light, by receiver: any choice is
/// unbiased, this one keeps the variance low.
///   0    far away, where area sampling alone brings at most M A / (π d²) ≤ M/4 a sample;
///   1    where the light fills at least half of the hemisphere: a light all around is then exact;
///   ½    else.
class ProbePolicy {
 public:
  explicit ProbePolicy(std::span<const LightTriangle> triangles);
  [[nodiscard]] float share(const Receiver& receiver) const;

 private:
  [[nodiscard]] float solid_angle(const Receiver& receiver) const;

  Box box_;
  float area_ = 0;
  std::vector<LightTriangle> triangles_;  ///< empty where there are too many to look at each time
};

}  // namespace relumbre
