#include "relumbre/dof/spread.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/dof/cover.h"
#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/skewed_sums.h"
#include "relumbre/dof/spread_sums.h"

namespace relumbre {

namespace {

/// Rows of the picture that are worked on together. Blurs that cross from one stripe to the next
/// are spread in both; where upright ones are large, taller stripes save more of that than they
/// lose in the caches.
constexpr std::size_t kStripe = 96, kTallStripe = 180;
constexpr float kTallFrom = 64;  // pixels in diameter

std::size_t stripe_rows(bool upright, float largest_diameter) {
  return upright && largest_diameter >= kTallFrom ? kTallStripe : kStripe;
}

/// Slanted blurs of at least so many pixels in diameter, for every slope that their edges have, are
/// spread faster by skewed sums than row by row.
constexpr float kSkewedFrom = 10;

/// Rows of the picture from which a blur of this diameter may reach the stripe.
std::pair<std::size_t, std::size_t> source_rows(float diameter, std::size_t first, std::size_t last,
                                                std::size_t height) {
  const auto reach = static_cast<std::size_t>(std::ceil(diameter / 2)) + 1;
  return {first - std::min(first, reach), std::min(last + reach, height)};
}

struct Work {
  const DepthPicture& picture;
  const DepthLayers& layers;
  const ApertureKernels& kernels;
  const SkewedOutline& outline;
};

/// The layer's sums, behind what is there.
template <class Sums>
void add_layer(Sums& sums, std::span<const Fragment> fragments, float reach, std::size_t width,
               Cover& cover) {
  sums.clear(reach);
  for (const Fragment& fragment : fragments) sums.spread(fragment);
  const double tolerance = tolerance_of(static_cast<double>(reach));
  sums.integrate([&](std::size_t y, std::size_t left, std::size_t right, const auto* row) {
    for (std::size_t x = left; x < right; ++x)
      cover.add(y * width + x, row[x].color(), row[x].weight(), tolerance);
  });
}

/// Rows [first, last) of the result.
template <class Sum>
void spread_stripe(const Work& work, std::size_t first, std::size_t last, std::span<Rgba> result) {
  const auto& [picture, layers, kernels, outline] = work;
  const std::size_t width = picture.width, height = picture.height;
  SpreadSums<Sum> by_rows(kernels, width, height, first, last);
  SkewedSums<Sum, true> upright(outline, width, height, first, last);
  SkewedSums<Sum, false> slanted(outline, width, height, first, last);
  Cover cover(width * (last - first));
  for (std::size_t layer = 0; layer < layers.layers; ++layer) {
    const float reach = layers.reach[layer], least = layers.least[layer];
    const auto [begin, end] = source_rows(reach, first, last, height);
    const std::span<const Fragment> fragments = layers.rows(layer, begin, end);
    if (fragments.empty()) continue;
    const auto slopes = static_cast<float>(outline.slopes.size());
    if (outline.upright()) {
      add_layer(upright, fragments, reach, width, cover);
    } else if (slopes > 0 && least >= kSkewedFrom * slopes) {
      add_layer(slanted, fragments, reach, width, cover);
    } else {
      add_layer(by_rows, fragments, reach, width, cover);
    }
  }
  for (std::size_t i = 0; i < width * (last - first); ++i)
    result[first * width + i] = cover.color(i);
}

}  // namespace

std::vector<Rgba> spread(const DepthPicture& picture, const ThinLens& lens,
                         const SpreadConfig& config, Progress& progress) {
  picture.check();
  const auto circles = [&](const PictureLayer& layer) {
    return circles_of_confusion(layer.depth, lens, picture.width,
                                std::min(config.largest_diameter, ApertureKernels::kLargest));
  };
  const std::vector<float> front = circles(picture.front), behind = circles(picture.behind);
  const DepthLayers layers =
      sort_into_layers(fragments_of(picture, front, behind), picture.height, config.layers);
  const SkewedOutline outline =
      skewed_outline(outline_corners(config.shape, config.aperture)).value_or(SkewedOutline{});
  const float largest = std::ranges::max(layers.reach);
  const double by_rows = outline.upright() ? 0 : static_cast<double>(largest);
  const ApertureKernels kernels(config.shape, config.aperture,
                                std::min(by_rows, ApertureKernels::kLargest));
  const Work work{picture, layers, kernels, outline};
  const auto spread_rows = picture.opaque() ? spread_stripe<OpaqueSum> : spread_stripe<AlphaSum>;

  std::vector<Rgba> result(picture.pixels());
  progress.begin("spreading", picture.height);
  parallel_chunks(0, picture.height, stripe_rows(outline.upright(), largest),
                  [&](std::size_t first, std::size_t last) {
                    progress.check();
                    spread_rows(work, first, last, result);
                    progress.advance(last - first);
                  });
  return result;
}

}  // namespace relumbre
