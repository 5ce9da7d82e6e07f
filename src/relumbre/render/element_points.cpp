#include "relumbre/render/element_points.h"

#include <vector>

#include "relumbre/base/sampling.h"

namespace relumbre {

namespace {

Vec3f scaled_normal(const Tessellation& t, const Facet& facet) {
  const Vec3f a = t.positions[facet.corners[0]];
  return cross(t.positions[facet.corners[1]] - a, t.positions[facet.corners[2]] - a);
}

/// How far points are drawn towards the centroid, so that all edges move inwards by twice epsilon
/// (by half the facet at most): none may start beyond a wall that meets the facet at an edge.
float shrinking(const std::array<Vec3f, 3>& p, float twice_area, float epsilon) {
  const float perimeter = length(p[1] - p[0]) + length(p[2] - p[1]) + length(p[0] - p[2]);
  return 1 - std::min(0.5F, 2 * epsilon * perimeter / twice_area);
}

}  // namespace

ElementPoints::ElementPoints(const Tessellation& tessellation, std::size_t element, float epsilon)
    : tessellation_(tessellation), facets_(tessellation.facets_of(element)), epsilon_(epsilon) {
  std::vector<float> weights;
  weights.reserve(facets_.size());
  for (const Facet& facet : facets_) weights.push_back(length(scaled_normal(tessellation, facet)));
  choice_ = DiscreteChoice(weights);
}

Receiver ElementPoints::at(float u, float v) const {
  const auto [index, rest] = choice_.choose(u);
  const Facet& facet = facets_[index];
  const Vec2f b = square_to_triangle(rest, v);
  std::array<Vec3f, 3> p;
  for (std::size_t c = 0; c < 3; ++c) p[c] = tessellation_.positions[facet.corners[c]];
  const Vec3f scaled = scaled_normal(tessellation_, facet), normal = normalized(scaled);
  const Vec3f point = p[0] + (p[1] - p[0]) * b.x + (p[2] - p[0]) * b.y;
  const Vec3f center = (p[0] + p[1] + p[2]) / 3;
  const float shrink = shrinking(p, length(scaled), epsilon_);
  return {center + (point - center) * shrink + normal * epsilon_, normal};
}

ScrambledSobol::ScrambledSobol(std::uint64_t seed) {
  const std::uint64_t a = hash64(seed, 1), b = hash64(seed, 2);
  scramble_ = {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(a >> 32),
               static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(b >> 32)};
}

std::array<float, 4> ScrambledSobol::operator()(std::uint32_t index) const {
  const std::array<std::uint32_t, 4> bits = sobol4(index);
  std::array<float, 4> point{};
  for (std::size_t d = 0; d < 4; ++d) point[d] = to_unit(bits[d] ^ scramble_[d]);
  return point;
}

}  // namespace relumbre
