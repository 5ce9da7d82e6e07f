#include "relumbre/dof/spread.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/spread_sums.h"

namespace relumbre {

namespace {

/// Rows of the picture that are worked on together: their sums stay in a core's cache.
constexpr std::size_t kStripe = 48;

/// Share of a pixel that blurs of a total weight cover. Where circles of confusion change from
/// pixel to pixel, the weights of one surface add up to a little less than 1, and what lies behind,
/// perhaps a thousand times as bright, must not shine through that. `tolerance` is what may be
/// missing.
double covered(double weight, double tolerance) {
  const double trusted = 1 - 4 * tolerance, full = 1 - tolerance;
  if (weight <= trusted) return weight;
  return std::min(trusted + (weight - trusted) * (1 - trusted) / (full - trusted), 1.0);
}

/// Blurs of a few pixels are cut off by the pixels they fall on; large ones add up smoothly.
double tolerance_of(double diameter) {
  return std::clamp(0.06 - 0.018 * (diameter - 2), 0.02, 0.06);
}

/// Layers laid over one another from front to back.
class Cover {
 public:
  explicit Cover(std::size_t pixels) : color_(pixels), weight_(pixels), share_(pixels) {}

  /// Puts the sums of the next layer behind what is there.
  template <class Sum>
  void add(std::size_t pixel, const Sum& sum, double tolerance) {
    constexpr double kNothing = 1e-9;
    const double weight = sum.weight();
    if (weight < kNothing || share_[pixel] >= 1) return;
    weight_[pixel] += weight;
    const double taken = std::max(covered(weight_[pixel], tolerance) - share_[pixel], 0.0);
    share_[pixel] += taken;
    const auto scale = static_cast<float>(taken / weight);
    Rgba& c = color_[pixel];
    const Rgba s = sum.color();
    c.r += s.r * scale, c.g += s.g * scale, c.b += s.b * scale, c.a += s.a * scale;
  }
  /// What nothing has covered is taken to look like the rest of the pixel.
  [[nodiscard]] Rgba color(std::size_t pixel) const {
    if (share_[pixel] <= 0) return {};
    const auto scale = static_cast<float>(1 / share_[pixel]);
    const Rgba c = color_[pixel];
    return {c.r * scale, c.g * scale, c.b * scale, c.a * scale};
  }

 private:
  std::vector<Rgba> color_;
  std::vector<double> weight_, share_;
};

struct Work {
  const DepthPicture& picture;
  const DepthLayers& layers;
  const ApertureKernels& kernels;
};

/// Rows [first, last) of the result.
template <class Sum, bool kBox>
void spread_stripe(const Work& work, std::size_t first, std::size_t last, std::span<Rgba> result) {
  const std::size_t width = work.picture.width, rows = last - first;
  SpreadSums<Sum, kBox> sums(width, work.picture.height, first, last);
  Cover cover(width * rows);
  for (std::size_t layer = 0; layer < work.layers.layers; ++layer) {
    const float reach = work.layers.reach[layer];
    const auto [begin, end] = sums.source_rows(reach);
    const std::span<const Fragment> fragments = work.layers.rows(layer, begin, end);
    if (fragments.empty()) continue;
    sums.clear();
    for (const Fragment& fragment : fragments)
      sums.spread(fragment, work.kernels.of(static_cast<double>(fragment.coc)));
    sums.integrate();
    const double tolerance = tolerance_of(static_cast<double>(reach));
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t x = 0; x < width; ++x) cover.add(y * width + x, sums.row(y)[x], tolerance);
  }
  for (std::size_t i = 0; i < width * rows; ++i) result[first * width + i] = cover.color(i);
}

bool opaque(const DepthPicture& picture) {
  const auto solid = [](const Rgba& c) { return c.a == 1; };
  return std::ranges::all_of(picture.front.color, solid) &&
         std::ranges::all_of(picture.behind.color, solid);
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
  const ApertureKernels kernels(
      config.shape, config.aperture,
      std::min(static_cast<double>(std::ranges::max(layers.reach)), ApertureKernels::kLargest));
  const Work work{picture, layers, kernels};
  const bool box = config.shape == BlurShape::kBox, solid = opaque(picture);
  const auto spread_rows =
      box ? (solid ? spread_stripe<OpaqueSum, true> : spread_stripe<AlphaSum, true>)
          : (solid ? spread_stripe<OpaqueSum, false> : spread_stripe<AlphaSum, false>);

  std::vector<Rgba> result(picture.pixels());
  progress.begin("spreading", picture.height);
  parallel_chunks(0, picture.height, kStripe, [&](std::size_t first, std::size_t last) {
    progress.check();
    spread_rows(work, first, last, result);
    progress.advance(last - first);
  });
  return result;
}

}  // namespace relumbre
