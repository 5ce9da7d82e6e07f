#include "relumbre/dof/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

/// Equal steps from the least to the largest circle of confusion.
class LayerOf {
 public:
  LayerOf(std::span<const Fragment> fragments, std::size_t layers) : last_(layers - 1) {
    const auto [least, largest] = std::ranges::minmax(fragments, {}, &Fragment::coc);
    first_ = least.coc;
    if (largest.coc > first_) scale_ = static_cast<float>(layers) / (largest.coc - first_);
  }
  [[nodiscard]] std::size_t operator()(float coc) const {
    return std::min(static_cast<std::size_t>((coc - first_) * scale_), last_);
  }

 private:
  float first_ = 0, scale_ = 0;
  std::size_t last_;
};

}  // namespace

DepthLayers sort_into_layers(std::span<const Fragment> fragments, std::size_t height,
                             std::size_t layers) {
  if (layers == 0) throw ValueError("layers: 0 asked, at least 1 is needed");
  const LayerOf layer_of(fragments, layers);
  const auto row_of = [&](const Fragment& f) { return layer_of(f.coc) * height + f.y; };
  DepthLayers result{.height = height,
                     .layers = layers,
                     .fragments = std::vector<Fragment>(fragments.size()),
                     .offsets = std::vector<std::uint32_t>(layers * height + 1),
                     .reach = std::vector<float>(layers),
                     .least = std::vector<float>(layers, std::numeric_limits<float>::infinity())};
  std::vector<std::uint32_t>& offsets = result.offsets;
  for (const Fragment& f : fragments) ++offsets[row_of(f) + 1];
  for (std::size_t row = 1; row < offsets.size(); ++row) offsets[row] += offsets[row - 1];
  std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
  for (const Fragment& f : fragments) {
    const std::size_t row = row_of(f);
    result.fragments[next[row]++] = f;
    float &reach = result.reach[row / height], &least = result.least[row / height];
    reach = std::max(reach, std::abs(f.coc)), least = std::min(least, std::abs(f.coc));
  }
  return result;
}

}  // namespace relumbre
