#include "relumbre/dof/depth_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// Between which two of ascending bounds.
class LayerBetween {
 public:
  explicit LayerBetween(std::span<const float> bounds)
      : inner_(bounds.size() < 3 ? std::span<const float>{}
                                 : bounds.subspan(1, bounds.size() - 2)) {}
  [[nodiscard]] std::size_t operator()(float coc) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(inner_, coc) - inner_.begin());
  }

 private:
  std::span<const float> inner_;
};

template <class LayerOfCoc>
DepthLayers sort_by(const LayerOfCoc& layer_of, std::span<const Fragment> fragments,
                    std::size_t height, std::size_t layers) {
  std::vector<std::uint32_t> row_of(fragments.size());
  parallel_for(0, fragments.size(), 1 << 14, [&](std::size_t i) {
    row_of[i] = static_cast<std::uint32_t>(layer_of(fragments[i].coc) * height + fragments[i].y);
  });
  DepthLayers result{.height = height,
                     .layers = layers,
                     .fragments = std::vector<Fragment>(fragments.size()),
                     .offsets = std::vector<std::uint32_t>(layers * height + 1),
                     .reach = std::vector<float>(layers),
                     .least = std::vector<float>(layers, std::numeric_limits<float>::infinity())};
  std::vector<std::uint32_t>& offsets = result.offsets;
  for (const std::uint32_t row : row_of) ++offsets[row + 1];
  for (std::size_t row = 1; row < offsets.size(); ++row) offsets[row] += offsets[row - 1];
  std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
  for (std::size_t i = 0; i < fragments.size(); ++i)
    result.fragments[next[row_of[i]]++] = fragments[i];
  parallel_for(0, layers, 1, [&](std::size_t layer) {
    float &reach = result.reach[layer], &least = result.least[layer];
    for (const Fragment& f : result.rows(layer, 0, height))
      reach = std::max(reach, std::abs(f.coc)), least = std::min(least, std::abs(f.coc));
  });
  return result;
}

}  // namespace

DepthLayers sort_into_layers(std::span<const Fragment> fragments, std::size_t height,
                             std::size_t layers) {
  if (layers == 0) throw ValueError("layers: 0 asked, at least 1 is needed");
  const auto [least, largest] = std::ranges::minmax(fragments, {}, &Fragment::coc);
  return sort_by(LayerOf(least.coc, largest.coc, layers), fragments, height, layers);
}

DepthLayers sort_between(std::span<const Fragment> fragments, std::size_t height,
                         std::span<const float> bounds) {
  return sort_by(LayerBetween(bounds), fragments, height,
                 std::max<std::size_t>(bounds.size(), 2) - 1);
}

}  // namespace relumbre
