#include "relumbre/dof/layered.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/parallel.h"
#include "relumbre/dof/blur_steps.h"
#include "relumbre/dof/box_blur.h"
#include "relumbre/dof/cover.h"
#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/focus.h"

namespace relumbre {

namespace {

/// Columns [x0, x1) and rows [y0, y1) of the picture.
struct Extent {
  std::size_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;

  [[nodiscard]] std::size_t width() const { return x1 - x0; }
  [[nodiscard]] std::size_t height() const { return y1 - y0; }
  [[nodiscard]] bool empty() const { return x0 == x1; }
};

Extent both(const Extent& a, const Extent& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::max(a.x1, b.x1), std::min(a.y0, b.y0), std::max(a.y1, b.y1)};
}
Extent grown(const Extent& e, std::size_t by, std::size_t width, std::size_t height) {
  return {e.x0 - std::min(e.x0, by), std::min(e.x1 + by, width), e.y0 - std::min(e.y0, by),
          std::min(e.y1 + by, height)};
}

Extent extent_of(std::span<const Fragment> fragments) {
  if (fragments.empty()) return {};
  const auto [left, right] = std::ranges::minmax(fragments, {}, &Fragment::x);
  return {left.x, right.x + 1, fragments.front().y, fragments.back().y + 1};
}

/// Of every layer.
std::vector<Extent> extents_of(const DepthLayers& layers) {
  std::vector<Extent> result(layers.layers);
  parallel_for(0, layers.layers, 1,
               [&](std::size_t i) { result[i] = extent_of(layers.rows(i, 0, layers.height)); });
  return result;
}

/// What has one blur, in the part of the picture where there is any of it.
class Canvas {
 public:
  /// `extent` has room for the blur: nothing is drawn nearer to its border than that, unless that
  /// is the picture's.
  Canvas(const Extent& extent, bool opaque)
      : extent_(extent),
        color_(extent.width() * extent.height()),
        coverage_(opaque ? 0 : color_.size()) {}

  /// Of each fragment the share that share_of(its circle of confusion) says. In order of rows.
  template <class ShareOf>
  void draw(const DepthLayers& layers, std::size_t layer, ShareOf&& share_of) {
    parallel_for(extent_.y0, extent_.y1, 16, [&](std::size_t y) {
      for (const Fragment& f : layers.rows(layer, y, y + 1)) {
        const std::size_t at = (y - extent_.y0) * extent_.width() + f.x - extent_.x0;
        const float share = share_of(f.coc);
        Rgba& c = color_[at];
        c.r += share * f.color.r, c.g += share * f.color.g;
        c.b += share * f.color.b, c.a += share * f.color.a;
        if (!coverage_.empty()) coverage_[at] += share * f.coverage;
      }
    });
  }

  void blur(double radius) {
    if (radius == 0) return;
    const SummedAreaTable colors = rgba_table(color_, extent_.width(), extent_.height());
    box_filter(colors, radius, {.mode = Border::kClamp}, flat(color_));
    if (coverage_.empty()) return;
    const SummedAreaTable weights = SummedAreaTable::build(
        coverage_, extent_.width(), extent_.height(), 1, {.kind = SatKind::kFloat64});
    box_filter(weights, radius, {.mode = Border::kClamp}, coverage_);
  }

  /// Behind what is there.
  void lay_behind(Cover& cover, std::size_t picture_width, double tolerance) const {
    parallel_for(extent_.y0, extent_.y1, 16, [&](std::size_t y) {
      const std::size_t row = (y - extent_.y0) * extent_.width();
      for (std::size_t x = 0; x < extent_.width(); ++x) {
        const Rgba& c = color_[row + x];
        const float weight = coverage_.empty() ? c.a : coverage_[row + x];
        cover.add(y * picture_width + extent_.x0 + x, c, static_cast<double>(weight), tolerance);
      }
    });
  }

 private:
  Extent extent_;
  std::vector<Rgba> color_;
  std::vector<float> coverage_;  // of each pixel; empty where it is the colour's alpha
};

/// The sides of a picture, and what is known of it.
struct PictureSize {
  std::size_t width, height;
  bool opaque;
};

/// What belongs to step `i`: of what lies between it and its neighbours the nearer has the more.
void add_step(const DepthLayers& layers, std::span<const Extent> extents,
              std::span<const float> steps, std::size_t i, const PictureSize& frame, Cover& cover) {
  const bool before = i > 0, after = i < layers.layers;
  const Extent drawn = both(before ? extents[i - 1] : Extent{}, after ? extents[i] : Extent{});
  if (drawn.empty()) return;
  const auto radius = static_cast<double>(box_radius_of(steps[i]));
  Canvas canvas(
      grown(drawn, static_cast<std::size_t>(std::ceil(radius)) + 1, frame.width, frame.height),
      frame.opaque);
  if (before) {
    canvas.draw(layers, i - 1,
                [&](float coc) { return share_of_next(coc, steps[i - 1], steps[i]); });
  }
  if (after) {
    canvas.draw(layers, i, [&](float coc) {
      return steps.size() == 1 ? 1 : 1 - share_of_next(coc, steps[i], steps[i + 1]);
    });
  }
  canvas.blur(radius);
  canvas.lay_behind(cover, frame.width, tolerance_of(std::abs(static_cast<double>(steps[i]))));
}

}  // namespace

std::vector<Rgba> layered(const DepthPicture& picture, const ThinLens& lens,
                          const LayeredConfig& config, Progress& progress) {
  picture.check();
  const auto circles = [&](const PictureLayer& layer) {
    return circles_of_confusion(layer.depth, lens, picture.width, config.largest_diameter);
  };
  const std::vector<Fragment> fragments =
      fragments_of(picture, circles(picture.front), circles(picture.behind));
  const auto [least, largest] = std::ranges::minmax(fragments, {}, &Fragment::coc);
  const std::vector<float> steps = blur_steps(least.coc, largest.coc, config.layers);
  const DepthLayers layers = sort_between(fragments, picture.height, steps);
  const std::vector<Extent> extents = extents_of(layers);

  progress.begin("blurring layers", steps.size());
  const PictureSize frame{picture.width, picture.height, picture.opaque()};
  Cover cover(picture.pixels());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    progress.check();
    add_step(layers, extents, steps, i, frame, cover);
    progress.advance(1);
  }
  std::vector<Rgba> result(picture.pixels());
  parallel_for(0, picture.pixels(), 1 << 14, [&](std::size_t i) { result[i] = cover.color(i); });
  return result;
}

}  // namespace relumbre
