/// Points spread over elements, from which direct light is measured.
#pragma once

#include <cstdint>

#include "relumbre/geometry/tessellation.h"
#include "relumbre/render/discrete_choice.h"
#include "relumbre/render/light_sampler.h"

namespace relumbre {

/// Maps the unit square onto one element, uniform in area over all of its facets.
class ElementPoints {
 public:
  /// `epsilon`: how far points are lifted off the facets, and half of how far they keep from edges.
  /// `tessellation` must outlive this.
  ElementPoints(const Tessellation& tessellation, std::size_t element, float epsilon);
  /// False where all facets are degenerate: there is no point then.
  [[nodiscard]] bool any() const { return choice_.total() > 0; }
  [[nodiscard]] Receiver at(float u, float v) const;

 private:
  const Tessellation& tessellation_;
  std::span<const Facet> facets_;
  float epsilon_;
  DiscreteChoice choice_;  ///< over facets, by area
};

/// Sobol' points with the digits of each dimension scrambled by `seed`: every aligned run of 2^m
/// points stays stratified, and different seeds are decorrelated.
class ScrambledSobol {
 public:
  explicit ScrambledSobol(std::uint64_t seed);
  [[nodiscard]] std::array<float, 4> operator()(std::uint32_t index) const;

 private:
  std::array<std::uint32_t, 4> scramble_;
};

}  // namespace relumbre
