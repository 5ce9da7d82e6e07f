#include "relumbre/dof/layered.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/parallel.h"
#include "relumbre/dof/box_blur.h"
#include "relumbre/dof/cover.h"
#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/focus.h"

namespace relumbre {

namespace {

/// Side of the box that has the area of a disc of diameter 1: √π / 2.
constexpr float kBoxSide = 0.8862269F;

/// One layer where it is.
struct Canvas {
  std::vector<Rgba> color;
  std::vector<float> coverage;  // of each pixel
  float circle = 0;             // the mean circle of confusion

  explicit Canvas(std::size_t pixels) : color(pixels), coverage(pixels) {}
  void draw(std::span<const Fragment> fragments, std::size_t width);
  void blur(std::size_t width, std::size_t height);
};

void Canvas::draw(std::span<const Fragment> fragments, std::size_t width) {
  std::ranges::fill(color, Rgba{}), std::ranges::fill(coverage, 0.0F);
  double sum = 0;
  for (const Fragment& f : fragments) {
    Rgba& c = color[f.y * width + f.x];
    c.r += f.color.r, c.g += f.color.g, c.b += f.color.b, c.a += f.color.a;
    coverage[f.y * width + f.x] += f.coverage;
    sum += static_cast<double>(f.coc);
  }
  circle = static_cast<float>(sum / static_cast<double>(fragments.size()));
}

void Canvas::blur(std::size_t width, std::size_t height) {
  const auto radius = static_cast<double>(box_radius(kBoxSide * circle));
  if (radius == 0) return;
  const SummedAreaTable colors = rgba_table(color, width, height);
  box_filter(colors, radius, {.mode = Border::kClamp}, flat(color));
  const SummedAreaTable weights =
      SummedAreaTable::build(coverage, width, height, 1, {.kind = SatKind::kFloat64});
  box_filter(weights, radius, {.mode = Border::kClamp}, coverage);
}

}  // namespace

std::vector<Rgba> layered(const DepthPicture& picture, const ThinLens& lens,
                          const LayeredConfig& config, Progress& progress) {
  picture.check();
  const auto circles = [&](const PictureLayer& layer) {
    return circles_of_confusion(layer.depth, lens, picture.width, config.largest_diameter);
  };
  const DepthLayers layers =
      sort_into_layers(fragments_of(picture, circles(picture.front), circles(picture.behind)),
                       picture.height, config.layers);

  progress.begin("blurring layers", layers.layers);
  Canvas canvas(picture.pixels());
  Cover cover(picture.pixels());
  for (std::size_t layer = 0; layer < layers.layers; ++layer) {
    progress.check();
    const auto fragments = layers.rows(layer, 0, picture.height);
    if (!fragments.empty()) {
      canvas.draw(fragments, picture.width);
      canvas.blur(picture.width, picture.height);
      const double tolerance = tolerance_of(static_cast<double>(layers.reach[layer]));
      parallel_for(0, picture.pixels(), 1 << 14, [&](std::size_t i) {
        cover.add(i, canvas.color[i], static_cast<double>(canvas.coverage[i]), tolerance);
      });
    }
    progress.advance(1);
  }
  std::vector<Rgba> result(picture.pixels());
  parallel_for(0, picture.pixels(), 1 << 14, [&](std::size_t i) { result[i] = cover.color(i); });
  return result;
}

}  // namespace relumbre
