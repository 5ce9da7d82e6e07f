/// Fragments sorted into layers by how far they are out of focus.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/host_device.h"
#include "relumbre/dof/fragments.h"

namespace relumbre {

/// Which of equal steps from the least to the largest circle of confusion one belongs to.
class LayerOf {
 public:
  RELUMBRE_HOST_DEVICE LayerOf(float least, float largest, std::size_t layers)
      : first_(least), last_(layers - 1) {
    if (largest > first_) scale_ = static_cast<float>(layers) / (largest - first_);
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE std::size_t operator()(float coc) const {
    return std::min(static_cast<std::size_t>((coc - first_) * scale_), last_);
  }

 private:
  float first_, scale_ = 0;
  std::size_t last_;
};

/// Fragments front to back: layer by layer, in a layer row by row. Layers are steps of the circle
/// of confusion, which grows with depth, so that what is in one layer has about one blur.
struct DepthLayers {
  std::size_t height = 0, layers = 0;
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> offsets;  ///< of row y of layer l: offsets[l · height + y]
  std::vector<float> reach, least;     ///< the largest and the least |coc| of a layer's fragments

  /// Of rows [y0, y1) of a layer.
  [[nodiscard]] std::span<const Fragment> rows(std::size_t layer, std::size_t y0,
                                               std::size_t y1) const {
    const std::size_t at = layer * height;
    return std::span(fragments).subspan(offsets[at + y0], offsets[at + y1] - offsets[at + y0]);
  }
};

/// Layers of equal steps. A stable sort in O(fragments + layers · height). `fragments` is not empty
/// and has fewer than 2^32. Throws ValueError for 0 layers.
DepthLayers sort_into_layers(std::span<const Fragment> fragments, std::size_t height,
                             std::size_t layers);

/// The same with layers between bounds, which are ascending and at least one: layer i has what lies
/// from bounds[i] to below bounds[i + 1], the first and the last also what lies beyond.
DepthLayers sort_between(std::span<const Fragment> fragments, std::size_t height,
                         std::span<const float> bounds);

}  // namespace relumbre
