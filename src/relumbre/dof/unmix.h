/// Internal: which two surfaces a pixel shows, for the CPU and the GPU. See mixed_pixel.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "relumbre/base/host_device.h"
#include "relumbre/dof/depth_picture.h"
#include "relumbre/dof/edge_map.h"

namespace relumbre {

/// A pixel's colour as share · near + (1 − share) · far.
struct MixedPixel {
  float share = 1;  ///< of the nearer surface
  float near_coc = 0, far_coc = 0;
  Rgba near, far;
};

/// Colours, circles of confusion and which pixels are beside a jump in them.
struct MixedPicture {
  const Rgba* color;
  const float* circles;
  const std::uint8_t* mixed;
  std::size_t width, height;
};

namespace unmixing {

/// Pixels to either side from which the two surfaces' colours are taken.
inline constexpr std::size_t kAround = 2;

/// A mean colour and circle of confusion.
struct Mean {
  float coc = 0, weight = 0;
  Rgba color;

  RELUMBRE_HOST_DEVICE void add(const Rgba& c, float circle, float w) {
    color.r += c.r * w, color.g += c.g * w, color.b += c.b * w, color.a += c.a * w;
    coc += circle * w, weight += w;
  }
  RELUMBRE_HOST_DEVICE void finish() {
    const float s = 1 / weight;
    color = {color.r * s, color.g * s, color.b * s, color.a * s};
    coc *= s;
  }
};

struct Window {
  std::size_t x0, x1, y0, y1;
};

RELUMBRE_HOST_DEVICE inline Window around(std::size_t x, std::size_t y, std::size_t radius,
                                          const MixedPicture& picture) {
  return {x - std::min(x, radius), std::min(x + radius + 1, picture.width), y - std::min(y, radius),
          std::min(y + radius + 1, picture.height)};
}

/// The least and the largest circle of confusion in a window.
struct Range {
  float least = std::numeric_limits<float>::max(), largest = -std::numeric_limits<float>::max();
};
RELUMBRE_HOST_DEVICE inline Range range(const MixedPicture& picture, const Window& window) {
  Range range;
  for (std::size_t v = window.y0; v < window.y1; ++v) {
    for (std::size_t u = window.x0; u < window.x1; ++u) {
      const float circle = picture.circles[v * picture.width + u];
      range = {std::min(range.least, circle), std::max(range.largest, circle)};
    }
  }
  return range;
}

RELUMBRE_HOST_DEVICE inline Rgba sum(const Rgba& a, const Rgba& b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b, a.a + b.a};
}
RELUMBRE_HOST_DEVICE inline float light(const Rgba& c) { return c.r + c.g + c.b; }

/// More light than a mixture of the two can have: it is of a third surface.
RELUMBRE_HOST_DEVICE inline bool outshines(const Rgba& c, const Rgba& a, const Rgba& b) {
  constexpr float kTwice = 2;
  return light(c) > kTwice * std::max(light(a), light(b));
}

/// How much of `a` there is in `c`, if the rest is `b`.
RELUMBRE_HOST_DEVICE inline float share_of(const Rgba& c, const Rgba& a, const Rgba& b) {
  const float dr = a.r - b.r, dg = a.g - b.g, db = a.b - b.b, da = a.a - b.a;
  const float along = (c.r - b.r) * dr + (c.g - b.g) * dg + (c.b - b.b) * db + (c.a - b.a) * da;
  const float whole = dr * dr + dg * dg + db * db + da * da;
  return whole > 0 ? std::clamp(along / whole, 0.0F, 1.0F) : -1;
}

/// What of `value` the mixture does not explain.
RELUMBRE_HOST_DEVICE inline float rest(float share, float value, float a, float b) {
  return value - share * a - (1 - share) * b;
}

/// The two surfaces, as pixels show them that are not mixed themselves, if there are any.
struct Surfaces {
  Mean near, far;
};
RELUMBRE_HOST_DEVICE inline Surfaces surfaces(const MixedPicture& picture, const Window& window,
                                              const Range& range, float middle) {
  constexpr float kUnmixed = 1, kMixed = 1e-3F;
  Surfaces result;
  for (std::size_t v = window.y0; v < window.y1; ++v) {
    for (std::size_t u = window.x0; u < window.x1; ++u) {
      const std::size_t i = v * picture.width + u;
      const float circle = picture.circles[i];
      // A third surface, farther away in the picture than a neighbour.
      if (circle < range.least - kOneSurface || circle > range.largest + kOneSurface) continue;
      (circle < middle ? result.near : result.far)
          .add(picture.color[i], circle, picture.mixed[i] == 0 ? kUnmixed : kMixed);
    }
  }
  result.near.finish(), result.far.finish();
  return result;
}

}  // namespace unmixing

/// Of a pixel beside a jump.
RELUMBRE_HOST_DEVICE inline MixedPixel unmix(const MixedPicture& picture, std::size_t x,
                                             std::size_t y) {
  using namespace unmixing;
  const std::size_t here = y * picture.width + x;
  const Range reach = range(picture, around(x, y, 1, picture));
  const float middle = (reach.least + reach.largest) / 2;
  const auto [near, far] = surfaces(picture, around(x, y, kAround, picture), reach, middle);

  const Rgba& c = picture.color[here];
  if (outshines(c, near.color, far.color)) {
    const float sharper = std::abs(near.coc) <= std::abs(far.coc) ? 1 : 0;
    return {sharper, near.coc, far.coc, c, c};
  }
  float share = share_of(c, near.color, far.color);
  if (share < 0) share = picture.circles[here] < middle ? 1 : 0;  // one colour: its depth decides
  const Rgba r{
      rest(share, c.r, near.color.r, far.color.r), rest(share, c.g, near.color.g, far.color.g),
      rest(share, c.b, near.color.b, far.color.b), rest(share, c.a, near.color.a, far.color.a)};
  return {share, near.coc, far.coc, sum(near.color, r), sum(far.color, r)};
}

}  // namespace relumbre
