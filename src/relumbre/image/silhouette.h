/// Where an image's depth jumps: at silhouettes, where blurs and filters go wrong first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relumbre {

struct SilhouetteConfig {
  /// Two neighbours in a row or column make a silhouette where their depths differ by more than
  /// this fraction of the nearer one. So does a plane seen so flat that its depth changes as much
  /// from pixel to pixel: with 5%, the last 20 rows before a horizon.
  double relative_jump = 0.05;
  /// Distance in pixels, between centres, from the nearest pixel at a silhouette. 0: only those.
  double radius_pixels = 8;
};

/// A mask, width · height, row 0 at the top: 1 within the radius of a silhouette, otherwise 0.
/// `depth` is planar or radial, in any unit; infinity, NaN, 0 and below mean that nothing is there,
/// which is infinitely far. O(pixels · radius), parallel over rows. Throws ShapeError if the sizes
/// disagree, ValueError for a jump not above 0 or a radius not in [0, 4096].
std::vector<std::uint8_t> silhouette_band(std::span<const float> depth, std::size_t width,
                                          std::size_t height, const SilhouetteConfig& config = {});

}  // namespace relumbre
