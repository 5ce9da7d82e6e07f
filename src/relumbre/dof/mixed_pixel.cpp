#include "relumbre/dof/mixed_pixel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relumbre {

namespace {

/// Pixels to either side from which the two surfaces' colours are taken.
constexpr std::size_t kAround = 2;

/// A mean colour and circle of confusion.
struct Mean {
  float coc = 0, weight = 0;
  Rgba color;

  void add(const Rgba& c, float circle, float w) {
    color.r += c.r * w, color.g += c.g * w, color.b += c.b * w, color.a += c.a * w;
    coc += circle * w, weight += w;
  }
  void finish() {
    const float s = 1 / weight;
    color = {color.r * s, color.g * s, color.b * s, color.a * s};
    coc *= s;
  }
};

struct Window {
  std::size_t x0, x1, y0, y1;
};

Window around(std::size_t x, std::size_t y, std::size_t radius, std::size_t width,
              std::size_t height) {
  return {x - std::min(x, radius), std::min(x + radius + 1, width), y - std::min(y, radius),
          std::min(y + radius + 1, height)};
}

/// The least and the largest circle of confusion in a window.
std::pair<float, float> range(std::span<const float> front, std::size_t width,
                              const Window& window) {
  float least = std::numeric_limits<float>::max(), largest = -least;
  for (std::size_t v = window.y0; v < window.y1; ++v) {
    for (std::size_t u = window.x0; u < window.x1; ++u) {
      least = std::min(least, front[v * width + u]);
      largest = std::max(largest, front[v * width + u]);
    }
  }
  return {least, largest};
}

/// More light than a mixture of the two can have: it is of a third surface.
bool outshines(const Rgba& c, const Rgba& a, const Rgba& b) {
  constexpr float kTwice = 2;
  const auto light = [](const Rgba& of) { return of.r + of.g + of.b; };
  return light(c) > kTwice * std::max(light(a), light(b));
}

/// How much of `a` there is in `c`, if the rest is `b`.
float share_of(const Rgba& c, const Rgba& a, const Rgba& b) {
  const float dr = a.r - b.r, dg = a.g - b.g, db = a.b - b.b, da = a.a - b.a;
  const float along = (c.r - b.r) * dr + (c.g - b.g) * dg + (c.b - b.b) * db + (c.a - b.a) * da;
  const float whole = dr * dr + dg * dg + db * db + da * da;
  return whole > 0 ? std::clamp(along / whole, 0.0F, 1.0F) : -1;
}

}  // namespace

Unmixer::Unmixer(const DepthPicture& picture, std::span<const float> front,
                 const SurfaceEdges& edges)
    : picture_(picture), front_(front), mixed_(edges.pixels()) {}

std::optional<MixedPixel> Unmixer::operator()(std::size_t x, std::size_t y) const {
  const std::size_t here = y * picture_.width + x;
  if (mixed_[here] == 0) return std::nullopt;
  const auto [least, largest] =
      range(front_, picture_.width, around(x, y, 1, picture_.width, picture_.height));
  const float middle = (least + largest) / 2;

  // The two surfaces, as pixels show them that are not mixed themselves, if there are any.
  constexpr float kUnmixed = 1, kMixed = 1e-3F;
  Mean near, far;
  const Window window = around(x, y, kAround, picture_.width, picture_.height);
  for (std::size_t v = window.y0; v < window.y1; ++v) {
    for (std::size_t u = window.x0; u < window.x1; ++u) {
      const std::size_t i = v * picture_.width + u;
      // A third surface, farther away in the picture than a neighbour.
      if (front_[i] < least - kOneSurface || front_[i] > largest + kOneSurface) continue;
      (front_[i] < middle ? near : far)
          .add(picture_.front.color[i], front_[i], mixed_[i] == 0 ? kUnmixed : kMixed);
    }
  }
  near.finish(), far.finish();

  const Rgba& c = picture_.front.color[here];
  if (outshines(c, near.color, far.color)) {
    const float sharper = std::abs(near.coc) <= std::abs(far.coc) ? 1 : 0;
    return MixedPixel{sharper, near.coc, far.coc, c, c};
  }
  float share = share_of(c, near.color, far.color);
  if (share < 0) share = front_[here] < middle ? 1 : 0;  // one colour: its depth decides
  const auto rest = [share](float value, float a, float b) {
    return value - share * a - (1 - share) * b;
  };
  const Rgba r{rest(c.r, near.color.r, far.color.r), rest(c.g, near.color.g, far.color.g),
               rest(c.b, near.color.b, far.color.b), rest(c.a, near.color.a, far.color.a)};
  const auto sum = [](const Rgba& a, const Rgba& b) {
    return Rgba{a.r + b.r, a.g + b.g, a.b + b.b, a.a + b.a};
  };
  return MixedPixel{share, near.coc, far.coc, sum(near.color, r), sum(far.color, r)};
}

}  // namespace relumbre
