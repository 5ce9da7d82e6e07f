#include <limits>
#include <string>
#include <type_traits>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/sat/pixel_filter.h"
#include "relumbre/sat/sat_cuda.h"

namespace relumbre::cuda {

namespace {

constexpr double kFarthest = 1 << 30;
/// A block's pixels are neighbours on both axes, whose squares overlap.
constexpr unsigned kBlockWidth = 32, kBlockHeight = 8, kThreads = kBlockWidth * kBlockHeight;

struct OneRadius {
  double radius;
  __device__ double operator()(std::size_t) const { return radius; }
};
struct RadiusOfEach {
  const float* radii;
  __device__ double operator()(std::size_t pixel) const {
    const auto r = static_cast<double>(radii[pixel]);
    return !(r > 0) ? 0 : r < kLargestRadius ? r : kLargestRadius;
  }
};

template <class T, std::size_t kChannels, class RadiusAt>
__global__ void filter(const __grid_constant__ BoxReader<T, kChannels> reader, RadiusAt radius_at,
                       const __grid_constant__ BorderRule border, float* out) {
  const SatLayout& layout = reader.layout();
  const std::size_t x = std::size_t{blockIdx.x} * kBlockWidth + threadIdx.x;
  if (x >= layout.width) return;
  // A grid has fewer rows of blocks than an image may have.
  for (std::size_t y = std::size_t{blockIdx.y} * kBlockHeight + threadIdx.y; y < layout.height;
       y += std::size_t{gridDim.y} * kBlockHeight) {
    const std::size_t pixel = y * layout.width + x;
    const SatSums mean = PixelFilter(reader, border).mean(x, y, radius_at(pixel));
    for (std::size_t c = 0; c < kChannels; ++c)
      out[pixel * kChannels + c] = static_cast<float>(mean[c]);
  }
}

__device__ SatSums not_a_number() {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  return {kNan, kNan, kNan, kNan};
}

/// What boxes a table lets be asked for.
struct Allowed {
  std::size_t largest_box;
  __device__ bool operator()(const SatLayout& layout, std::size_t x0, std::size_t y0,
                             std::size_t x1, std::size_t y1) const {
    return x0 <= x1 && y0 <= y1 && x1 <= layout.width && y1 <= layout.height &&
           (x1 - x0) * (y1 - y0) <= largest_box;
  }
};

template <class T, std::size_t kChannels>
__global__ void sum_boxes(BoxReader<T, kChannels> reader, Allowed allowed, const PixelBox* boxes,
                          std::size_t count, SatSums* sums) {
  const std::size_t i = std::size_t{blockIdx.x} * kThreads + threadIdx.x;
  if (i >= count) return;
  const PixelBox b = boxes[i];
  if (!allowed(reader.layout(), b.x0, b.y0, b.x1, b.y1)) {
    sums[i] = not_a_number();
    return;
  }
  SatSums total{};
  reader.add(b.x0, b.y0, b.x1, b.y1, 1, total);
  sums[i] = total;
}

template <class T, std::size_t kChannels>
__device__ SatSums mean_of_box(const BoxReader<T, kChannels>& reader, const Allowed& allowed,
                               const RealBox& b, const BorderRule& border) {
  const SatLayout& layout = reader.layout();
  const auto within = [](double v) { return v >= -kFarthest && v <= kFarthest; };
  if (!(b.x0 < b.x1 && b.y0 < b.y1 && within(b.x0) && within(b.y0) && within(b.x1) && within(b.y1)))
    return not_a_number();
  const AxisWindow across(b.x0, b.x1, layout.width, border.mode);
  const AxisWindow down(b.y0, b.y1, layout.height, border.mode);
  for (const AxisSegment& v : down.segments()) {
    for (const AxisSegment& h : across.segments())
      if (!allowed(layout, h.begin, v.begin, h.end, v.end)) return not_a_number();
  }
  return reader.mean(across, down, border);
}

template <class T, std::size_t kChannels>
__global__ void mean_boxes(const __grid_constant__ BoxReader<T, kChannels> reader, Allowed allowed,
                           const RealBox* boxes, std::size_t count,
                           const __grid_constant__ BorderRule border, SatSums* means) {
  const std::size_t i = std::size_t{blockIdx.x} * kThreads + threadIdx.x;
  if (i < count) means[i] = mean_of_box(reader, allowed, boxes[i], border);
}

/// Calls use(reader) with the reader for the table's type and channels.
template <class Use>
void with_reader(const DeviceSat& table, const Use& use) {
  std::visit(
      [&]<class T>(const DeviceArray<T>& sums) {
        const auto with_channels =
            [&]<std::size_t kChannels>(std::integral_constant<std::size_t, kChannels>) {
              use(BoxReader<T, kChannels>(table.layout(), sums.data(), table.fixed_point(),
                                          table.mean()));
            };
        if (table.channels() == 1) with_channels(std::integral_constant<std::size_t, 1>{});
        if (table.channels() == 2) with_channels(std::integral_constant<std::size_t, 2>{});
        if (table.channels() == 3) with_channels(std::integral_constant<std::size_t, 3>{});
        if (table.channels() == 4) with_channels(std::integral_constant<std::size_t, 4>{});
      },
      table.storage());
}

unsigned blocks_for(std::size_t count, std::size_t of_block) {
  return static_cast<unsigned>((count + of_block - 1) / of_block);
}

template <class RadiusAt>
void filter_all(const DeviceSat& table, const RadiusAt& radius_at, const BorderRule& border,
                float* out, const Stream& stream) {
  constexpr unsigned kMostRows = 65535;
  if (table.layout().pixels() == 0) return;
  const unsigned rows = blocks_for(table.height(), kBlockHeight);
  const Grid grid{
      .blocks = dim3(blocks_for(table.width(), kBlockWidth), rows < kMostRows ? rows : kMostRows),
      .threads = dim3(kBlockWidth, kBlockHeight)};
  with_reader(table, [&]<class T, std::size_t kChannels>(const BoxReader<T, kChannels>& reader) {
    launch(filter<T, kChannels, RadiusAt>, grid, stream, reader, radius_at, border, out);
  });
}

Allowed allowed_by(const DeviceSat& table) {
  return {is_fixed(table.kind()) ? table.fixed_point().largest_box : static_cast<std::size_t>(-1)};
}

}  // namespace

void box_sums(const DeviceSat& table, const PixelBox* boxes, std::size_t count, SatSums* sums,
              const Stream& stream) {
  with_reader(table, [&]<class T, std::size_t kChannels>(const BoxReader<T, kChannels>& reader) {
    launch(sum_boxes<T, kChannels>, {.blocks = blocks_for(count, kThreads), .threads = kThreads},
           stream, reader, allowed_by(table), boxes, count, sums);
  });
}

void box_means(const DeviceSat& table, const RealBox* boxes, std::size_t count,
               const BorderRule& border, SatSums* means, const Stream& stream) {
  if (table.layout().pixels() == 0) throw ShapeError("box mean of an image without pixels");
  with_reader(table, [&]<class T, std::size_t kChannels>(const BoxReader<T, kChannels>& reader) {
    launch(mean_boxes<T, kChannels>, {.blocks = blocks_for(count, kThreads), .threads = kThreads},
           stream, reader, allowed_by(table), boxes, count, border, means);
  });
}

void box_filter(const DeviceSat& table, double radius, const BorderRule& border, float* out,
                const Stream& stream) {
  if (!(radius >= 0 && radius <= kLargestRadius))
    throw ValueError("box filter of radius " + std::to_string(radius) +
                     ": it must be from 0 to 2^20");
  if (covered_pixels(radius, table.width(), table.height()) > allowed_by(table).largest_box)
    throw ValueError("box filter of radius " + std::to_string(radius) + " on a " +
                     std::string(sat_kind_name(table.kind())) + " table made for boxes of " +
                     std::to_string(table.fixed_point().largest_box) + " pixels");
  filter_all(table, OneRadius{radius}, border, out, stream);
}

void box_filter(const DeviceSat& table, const float* radii, const BorderRule& border, float* out,
                const Stream& stream) {
  filter_all(table, RadiusOfEach{radii}, border, out, stream);
}

}  // namespace relumbre::cuda
