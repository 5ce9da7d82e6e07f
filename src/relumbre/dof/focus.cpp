#include "relumbre/dof/focus.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/dof/circle_of_depth.h"

namespace relumbre {

namespace {

constexpr std::size_t kGrain = 1 << 14;  // pixels a task

}  // namespace

double automatic_focus(const DepthPicture& picture) {
  const double height = static_cast<double>(picture.height), sigma = height / 6;
  std::vector<std::pair<float, double>> depths;  // depth, weight
  double whole = 0;
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    if (!std::isfinite(picture.front.depth[i])) continue;
    const double x =
        static_cast<double>(i % picture.width) + 0.5 - static_cast<double>(picture.width) / 2;
    const double y = static_cast<double>(i / picture.width) + 0.5 - height / 2;
    const double weight = std::exp(-(x * x + y * y) / (2 * sigma * sigma));
    depths.emplace_back(picture.front.depth[i], weight);
    whole += weight;
  }
  if (depths.empty()) throw ValueError("focus: there is nothing in the picture");
  std::ranges::sort(depths);
  double sum = 0;
  for (const auto& [depth, weight] : depths) {
    sum += weight;
    if (sum >= whole / 2) return static_cast<double>(depth);
  }
  return static_cast<double>(depths.back().first);
}

std::vector<float> circles_of_confusion(std::span<const float> depth, const ThinLens& lens,
                                        std::size_t width, double largest) {
  lens.check();
  if (!(largest >= 0)) throw ValueError(fmt::format("largest blur: {} pixels", largest));
  std::vector<float> circles(depth.size());
  const CircleOfDepth circle(lens, width, largest);
  parallel_for(0, depth.size(), kGrain, [&](std::size_t i) { circles[i] = circle(depth[i]); });
  return circles;
}

Image focus_overlay(const DepthPicture& picture, const ThinLens& lens) {
  constexpr double kWhole = 32;  // pixels of blur that are shown in full colour
  const std::vector<float> circles =
      circles_of_confusion(picture.front.depth, lens, picture.width, kWhole);
  Image image = rgb_image(picture.width, picture.height);
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const Rgba& c = picture.front.color[i];
    const float grey = 0.2126F * c.r + 0.7152F * c.g + 0.0722F * c.b;
    const float blur = std::sqrt(std::abs(circles[i]) / static_cast<float>(kWhole));
    const Rgb tint = std::abs(circles[i]) < 1 ? Rgb(1)
                     : circles[i] < 0         ? Rgb(1, 0.15F, 0.1F)
                                              : Rgb(0.1F, 0.3F, 1);
    const float mix = std::abs(circles[i]) < 1 ? 0 : 0.3F + 0.7F * blur;
    image.set_rgb(i, Rgb(grey) * (1 - mix) + tint * (mix * (0.1F + grey)));
  }
  return image;
}

}  // namespace relumbre
