#include "relumbre/dof/layered.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/parallel.h"
#include "relumbre/dof/box_blur.h"
#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/focus.h"

namespace relumbre {

namespace {

/// One layer's colours where they are, and the mean of its circles of confusion.
float draw(std::span<const Fragment> fragments, std::size_t width, std::span<Rgba> canvas) {
  std::ranges::fill(canvas, Rgba{});
  double sum = 0;
  for (const Fragment& f : fragments) {
    Rgba& c = canvas[f.y * width + f.x];
    c.r += f.color.r, c.g += f.color.g, c.b += f.color.b, c.a += f.color.a;
    sum += static_cast<double>(f.coc);
  }
  return static_cast<float>(sum / static_cast<double>(fragments.size()));
}

/// Porter and Duff's "over".
void lay_over(std::span<const Rgba> layer, std::span<Rgba> result) {
  parallel_for(0, result.size(), 1 << 14, [&](std::size_t i) {
    const Rgba &top = layer[i], &below = result[i];
    const float rest = 1 - std::min(top.a, 1.0F);
    result[i] = {top.r + below.r * rest, top.g + below.g * rest, top.b + below.b * rest,
                 top.a + below.a * rest};
  });
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
  std::vector<Rgba> result(picture.pixels()), canvas(picture.pixels());
  for (std::size_t layer = layers.layers; layer-- > 0;) {
    progress.check();
    const auto fragments = layers.rows(layer, 0, picture.height);
    if (!fragments.empty()) {
      const float circle = draw(fragments, picture.width, canvas);
      const SummedAreaTable table = rgba_table(canvas, picture.width, picture.height);
      box_filter(table, static_cast<double>(box_radius(circle)), {.mode = Border::kClamp},
                 flat(canvas));
      lay_over(canvas, result);
    }
    progress.advance(1);
  }
  return result;
}

}  // namespace relumbre
