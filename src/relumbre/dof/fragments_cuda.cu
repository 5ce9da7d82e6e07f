#include <algorithm>
#include <cmath>
#include <string>

#include "relumbre/cuda/device.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/dof/fragment.h"
#include "relumbre/dof/fragments_cuda.cuh"
#include "relumbre/dof/fragments_cuda.h"

namespace relumbre::cuda {

namespace {

constexpr unsigned kThreads = 256;
/// Of a block that sweeps the picture for silhouettes, at most.
constexpr unsigned kSweepThreads = 512;

unsigned blocks_for(std::size_t count) {
  return static_cast<unsigned>((count + kThreads - 1) / kThreads);
}

__device__ __forceinline__ std::size_t thread_index() {
  return std::size_t{blockIdx.x} * kThreads + threadIdx.x;
}

__global__ void begin_summary(FragmentSummary* summary, std::uint32_t pixels) {
  *summary = {.least = ~0U, .largest = 0, .brightest = 0, .count = pixels};
}

__global__ void find_circles(const float* depth, CircleOfDepth circle, std::size_t pixels,
                             float* circles) {
  const std::size_t i = thread_index();
  if (i < pixels) circles[i] = circle(depth[i]);
}

__global__ void find_jumps(CirclePlane plane, std::uint8_t* jumps) {
  const auto i = static_cast<std::ptrdiff_t>(thread_index());
  if (i < plane.width * plane.height) jumps[i] = plane.jumps_at(i % plane.width, i / plane.width);
}

__global__ void find_mixed(EdgeMap edges, std::uint8_t* mixed) {
  const auto i = static_cast<std::ptrdiff_t>(thread_index());
  const CirclePlane& plane = edges.plane;
  if (i < plane.width * plane.height)
    mixed[i] = edges.beside_jump(i % plane.width, i / plane.width) ? 1 : 0;
}

/// Tiles of the picture, each in a window that reaches `halo` pixels farther.
struct RevealTiles {
  std::ptrdiff_t side, halo, columns;
  std::size_t window;  ///< pixels at most

  RevealTiles(std::size_t width, std::size_t height, std::ptrdiff_t reach)
      : side(reach <= 32    ? 64
             : reach <= 128 ? 256
                            : static_cast<std::ptrdiff_t>(std::max(width, height))),
        halo(reach),
        columns((static_cast<std::ptrdiff_t>(width) + side - 1) / side),
        window(std::min(width, static_cast<std::size_t>(side + 2 * halo)) *
               std::min(height, static_cast<std::size_t>(side + 2 * halo))) {}
  [[nodiscard]] std::size_t count(std::size_t height) const {
    return static_cast<std::size_t>(columns) *
           ((height + static_cast<std::size_t>(side) - 1) / static_cast<std::size_t>(side));
  }
};

/// All pixels of a window, by all threads of the block.
template <class Use>
__device__ void for_pixels(std::ptrdiff_t width, std::ptrdiff_t height, Use&& use) {
  for (std::ptrdiff_t i = threadIdx.x; i < width * height; i += blockDim.x)
    use(i % width, i / width);
}

/// A sweep in the order of the CPU's as far as it matters: a pixel waits for its neighbour to the
/// left and for three above, so that pixels of equal x + 2 y go together.
__device__ void sweep_window(const SilhouetteWindow& window, int step) {
  const std::ptrdiff_t width = window.width, height = window.height;
  for (std::ptrdiff_t at = 0; at < width + 2 * (height - 1); ++at) {
    // Rows whose turn it is: 0 ≤ at − 2 row < width.
    const std::ptrdiff_t first = at < width ? 0 : (at - width + 2) / 2;
    const std::ptrdiff_t last = std::min(at / 2, height - 1);
    for (std::ptrdiff_t row = first + threadIdx.x; row <= last; row += blockDim.x) {
      const std::ptrdiff_t column = at - 2 * row;
      if (step > 0)
        window.sweep(column, row, step);
      else
        window.sweep(width - 1 - column, height - 1 - row, step);
    }
    __syncthreads();
  }
}

/// revealed() of a tile a block.
__global__ void __launch_bounds__(kSweepThreads)
    find_revealed(RevealTiles tiles, EdgeMap edges, const float* behind_depth,
                  const float* behind_circles, Silhouette* silhouettes, std::uint8_t* revealed) {
  const CirclePlane& plane = edges.plane;
  const std::ptrdiff_t x0 = blockIdx.x % tiles.columns * tiles.side,
                       y0 = blockIdx.x / tiles.columns * tiles.side,
                       x1 = std::min(x0 + tiles.side, plane.width),
                       y1 = std::min(y0 + tiles.side, plane.height);
  const std::ptrdiff_t x = std::max<std::ptrdiff_t>(x0 - tiles.halo, 0),
                       y = std::max<std::ptrdiff_t>(y0 - tiles.halo, 0);
  const SilhouetteWindow window{edges,
                                x,
                                y,
                                std::min(x1 + tiles.halo, plane.width) - x,
                                std::min(y1 + tiles.halo, plane.height) - y,
                                silhouettes + blockIdx.x * tiles.window};
  for_pixels(window.width, window.height,
             [&](std::ptrdiff_t u, std::ptrdiff_t v) { window.begin(u, v); });
  __syncthreads();
  sweep_window(window, 1);
  sweep_window(window, -1);
  for_pixels(x1 - x0, y1 - y0, [&](std::ptrdiff_t u, std::ptrdiff_t v) {
    const std::ptrdiff_t i = (y0 + v) * plane.width + x0 + u;
    const Silhouette& silhouette = window.of(x0 + u - x, y0 + v - y);
    revealed[i] =
        is_revealed(silhouette, behind_depth[i], plane.circles[i], behind_circles[i]) ? 1 : 0;
  });
}

/// What lies behind; null where it is not known at all.
struct Behind {
  const Rgba* color;
  EdgeMap edges;
  const std::uint8_t* revealed;
};

struct FragmentSink {
  DeviceFragment* fragments;
  FragmentSummary* summary;
};

__device__ float largest_channel(const Rgba& c) {
  return std::max(std::max(std::abs(c.r), std::abs(c.g)), std::max(std::abs(c.b), std::abs(c.a)));
}

/// Of the fragments of one thread.
struct Extremes {
  std::uint32_t not_least = 0, largest = 0, brightest = 0;

  __device__ void take(const Fragment& f) {
    not_least = std::max(not_least, ~FragmentSummary::ordered(f.coc));
    largest = std::max(largest, FragmentSummary::ordered(f.coc));
    brightest = std::max(brightest, __float_as_uint(largest_channel(f.color)));
  }
  __device__ void tell(FragmentSummary* summary) const {
    const std::uint32_t least = ~warp_largest(not_least), most = warp_largest(largest),
                        light = warp_largest(brightest);
    if (threadIdx.x % kWarp != 0) return;
    lower_to(&summary->least, least);
    raise_to(&summary->largest, most);
    raise_to(&summary->brightest, light);
  }
};

__device__ void write(const Fragment& f, DeviceFragment* to) {
  *to = {f.color, f.coc, f.slope, f.coverage, f.x, f.y, 0};
}

__device__ Fragment behind_fragment(const Behind& behind, std::uint32_t x, std::uint32_t y,
                                    std::size_t i) {
  return {x, y, behind.edges.plane.circles[i], behind.edges.slope(x, y), 1, behind.color[i]};
}

__global__ void __launch_bounds__(kThreads)
    find_fragments(MixedPicture picture, EdgeMap edges, Behind behind, FragmentSink sink) {
  const std::size_t i = thread_index();
  Extremes extremes;
  const auto add = [&](const Fragment& f, std::size_t at) {
    extremes.take(f);
    write(f, sink.fragments + at);
  };
  if (i < picture.width * picture.height) {
    const auto x = static_cast<std::uint32_t>(i % picture.width),
               y = static_cast<std::uint32_t>(i / picture.width);
    bool first = true;
    front_fragments(picture, edges, x, y, [&](const Fragment& f) {
      add(f, first ? i : atomicAdd(&sink.summary->count, 1U));
      first = false;
    });
    if (behind.color != nullptr && behind.revealed[i] != 0)
      add(behind_fragment(behind, x, y, i), atomicAdd(&sink.summary->count, 1U));
  }
  extremes.tell(sink.summary);
}

/// The depths that are known.
void widen(const PictureLayer& layer, float& nearest, float& farthest) {
  for (const float z : layer.depth) {
    if (z <= 0) continue;
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
}

}  // namespace

DevicePicture::DevicePicture(std::size_t width, std::size_t height, bool behind)
    : width_(width), height_(height), may_have_behind_(behind) {
  const auto layer = [&] {
    return Layer{DeviceArray<Rgba>(pixels()), DeviceArray<float>(pixels())};
  };
  front_ = layer();
  if (behind) behind_ = layer();
}

std::size_t DevicePicture::bytes_of(std::size_t pixels, bool behind) {
  return pixels * (sizeof(Rgba) + sizeof(float)) * (behind ? 2 : 1);
}

void DevicePicture::upload(const DepthPicture& picture, const Stream& stream) {
  picture.check();
  if (picture.width != width_ || picture.height != height_ ||
      (picture.has_behind() && !may_have_behind_))
    throw ShapeError("picture of " + std::to_string(picture.width) + " × " +
                     std::to_string(picture.height) +
                     (picture.has_behind() ? " with" : " without") +
                     " what lies behind: the device has room for " + std::to_string(width_) +
                     " × " + std::to_string(height_) + (may_have_behind_ ? " with" : " without"));
  const auto copy = [&](const PictureLayer& from, const Layer& to) {
    copy_to_device<Rgba>(from.color, to.color.data(), stream);
    copy_to_device<float>(from.depth, to.depth.data(), stream);
  };
  has_behind_ = picture.has_behind();
  opaque_ = picture.opaque();
  nearest_ = farthest_ = picture.front.depth.front();
  widen(picture.front, nearest_, farthest_);
  widen(picture.behind, nearest_, farthest_);
  copy(picture.front, front_);
  if (has_behind_) copy(picture.behind, behind_);
}

DeviceFragments::DeviceFragments(std::size_t pixels, bool behind)
    : fragments_(pixels * (behind ? 3 : 2)),
      summary_(1),
      front_circles_(pixels),
      behind_circles_(behind ? pixels : 0),
      front_jumps_(pixels),
      behind_jumps_(behind ? pixels : 0),
      mixed_(pixels),
      revealed_(behind ? pixels : 0) {}

std::size_t DeviceFragments::bytes_of(std::size_t pixels, bool behind) {
  const std::size_t front = 2 * sizeof(DeviceFragment) + sizeof(float) + 2;
  const std::size_t more = sizeof(DeviceFragment) + sizeof(float) + 2;
  return pixels * (front + (behind ? more : 0)) + sizeof(FragmentSummary);
}

void DeviceFragments::reveal(const DevicePicture& picture, const CircleOfDepth& circle,
                             const EdgeMap& edges, const Stream& stream) {
  // Nothing is revealed by a silhouette farther away than half the difference of two circles.
  const float apart = std::abs(circle(picture.farthest()) - circle(picture.nearest())),
              longest = static_cast<float>(std::max(picture.width(), picture.height()));
  const RevealTiles tiles(picture.width(), picture.height(),
                          static_cast<std::ptrdiff_t>(std::min(longest, apart / 2)) + 1);
  const std::size_t count = tiles.count(picture.height());
  if (count * tiles.window > silhouettes_.size()) {
    silhouettes_ = {};
    expect_free(count * tiles.window * sizeof(Silhouette), "depth of field: silhouettes");
    silhouettes_.reserve(count * tiles.window);
  }
  // Of a window's pixels at most half as many go together as it has columns, or all its rows.
  const unsigned threads = tiles.side == 64 ? 64 : tiles.side == 256 ? 256 : kSweepThreads;
  launch(find_revealed, {.blocks = static_cast<unsigned>(count), .threads = threads}, stream, tiles,
         edges, picture.behind().depth.data(), behind_circles_.data(), silhouettes_.data(),
         revealed_.data());
}

void DeviceFragments::find(const DevicePicture& picture, const CircleOfDepth& circle,
                           const Stream& stream) {
  const std::size_t pixels = picture.pixels();
  const Grid each{.blocks = blocks_for(pixels), .threads = kThreads};
  const auto edges_of = [&](const DevicePicture::Layer& layer, const DeviceArray<float>& circles,
                            const DeviceArray<std::uint8_t>& jumps) {
    const CirclePlane plane{circles.data(), static_cast<std::ptrdiff_t>(picture.width()),
                            static_cast<std::ptrdiff_t>(picture.height())};
    launch(find_circles, each, stream, layer.depth.data(), circle, pixels, circles.data());
    launch(find_jumps, each, stream, plane, jumps.data());
    return EdgeMap{plane, jumps.data()};
  };
  launch(begin_summary, {.blocks = 1, .threads = 1}, stream, summary_.data(), pixels);
  const EdgeMap edges = edges_of(picture.front(), front_circles_, front_jumps_);
  launch(find_mixed, each, stream, edges, mixed_.data());
  Behind behind{};
  if (picture.has_behind()) {
    behind = {picture.behind().color.data(),
              edges_of(picture.behind(), behind_circles_, behind_jumps_), revealed_.data()};
    reveal(picture, circle, edges, stream);
  }
  const MixedPicture mixed{picture.front().color.data(), front_circles_.data(), mixed_.data(),
                           picture.width(), picture.height()};
  launch(find_fragments, each, stream, mixed, edges, behind,
         FragmentSink{fragments_.data(), summary_.data()});
}

}  // namespace relumbre::cuda
