/// Smooth irradiance from values of elements.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/geometry/display.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/render/relight.h"

namespace relumbre {

/// Values (n) with each NaN channel, which stands for "not known", replaced by the mean of what is
/// known around the element on smooth surface; 0 where nothing is. O(facets) a ring of unknown
/// elements, at most 8 rings.
std::vector<Rgb> fill_unknown(const Tessellation& tessellation, const DisplayMesh& display,
                              std::vector<Rgb> values);

/// Each pass replaces an element's value by the area-weighted mean of its vertices' values, so that
/// noise evens out between neighbours on smooth surface, and nothing crosses a crease.
std::vector<Rgb> smoothed(const Tessellation& tessellation, const DisplayMesh& display,
                          std::vector<Rgb> values, std::size_t passes);

/// Gouraud interpolation over the fans of a display mesh: at a display vertex the mean over the
/// elements around it; at a facet's centroid its element's value or, where the element has more
/// facets, the mean over the facet's loop. Continuous wherever the surface is smooth.
class DisplayField {
 public:
  /// The tessellation and display mesh must outlive the field. `values`: n, finite.
  /// Throws ShapeError if there are not n.
  DisplayField(const Tessellation& tessellation, const DisplayMesh& display,
               std::span<const Rgb> values);

  /// The value at barycentrics (u, v) (weights of corners 1 and 2) on one side of a source
  /// triangle; 0 where that side does not reflect. O(depth of the cuts).
  [[nodiscard]] Rgb at(std::uint32_t triangle, bool back, float u, float v) const;
  [[nodiscard]] std::span<const Rgb> at_vertices() const { return vertices_; }
  [[nodiscard]] std::span<const Rgb> at_centers() const { return centers_; }  ///< one a facet

 private:
  const Tessellation& tessellation_;
  const DisplayMesh& display_;
  std::vector<Rgb> vertices_, centers_;
};

/// What interpolates well over a lit scene, n values each, W/m².
struct ShadingInput {
  std::vector<Rgb> direct;    ///< irradiance straight from lights: sharp
  std::vector<Rgb> indirect;  ///< after at least one bounce: smooth; known everywhere
};

/// Irradiance of a lit scene, ready to interpolate; the indirect part smoothed `passes` times.
/// Throws ShapeError where sizes disagree.
ShadingInput shading_input(const Tessellation& tessellation, const DisplayMesh& display,
                           const RelitResult& lit, std::span<const Rgb> reflectance,
                           std::size_t smoothing_passes = 0);

}  // namespace relumbre
