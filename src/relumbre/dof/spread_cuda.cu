#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/skewed_outline.h"
#include "relumbre/dof/spread_cuda.h"
#include "relumbre/dof/spread_tiles_cuda.cuh"

namespace relumbre::cuda {

namespace {

/// Every fragment has its own blur, in one layer.
struct SpreadTable {
  static constexpr unsigned kEntries = 1;

  [[nodiscard]] __device__ static unsigned entries(const DeviceFragment&) { return 1; }
  [[nodiscard]] __device__ static float blur(const DeviceFragment& f, std::uint32_t) {
    return f.coc;
  }
  [[nodiscard]] __device__ static float share(const DeviceFragment&, std::uint32_t) { return 1; }
  /// Kernels are of rounded diameters, in steps of 1/64 or 1/256 of them.
  [[nodiscard]] __device__ static int reach(float coc) {
    return static_cast<int>(0.502F * std::abs(coc) + 0.52F);
  }
  [[nodiscard]] __device__ static int layer_reach(const SortedFragments& sorted,
                                                  std::uint32_t layer) {
    return reach(__uint_as_float(sorted.reach[layer]));
  }
  [[nodiscard]] __device__ static double diameter(const SortedFragments& sorted,
                                                  std::uint32_t layer) {
    return static_cast<double>(__uint_as_float(sorted.reach[layer]));
  }

 protected:
  /// `share`: of the light, of a pixel that the blur covers.
  __device__ static void finish(DeviceFragment& f, const SortedFragments& sort, double share,
                                const Tilt& tilt) {
    const auto scale = static_cast<float>(share);
    const Rgba c = scaled_down(f.color, sort.summary);
    f.color = {c.r * scale, c.g * scale, c.b * scale, c.a * scale};
    f.coverage *= scale;
    f.slope = {static_cast<float>(tilt.right), static_cast<float>(tilt.down)};
    const LayerOf layer_of(sort.summary->least_coc(), sort.summary->largest_coc(), sort.layers);
    f.layer = static_cast<std::uint32_t>(layer_of(f.coc));
  }
};

/// Kernels of all diameters.
struct RowTable : SpreadTable {
  const KernelHead* heads;  ///< of those behind the plane in focus, then of those before
  const ApertureKernel::Span* spans;
  std::uint32_t kernels;  ///< of one side

  RowTable(const KernelHead* h, const ApertureKernel::Span* s, std::uint32_t count)
      : heads(h), spans(s), kernels(count) {}

  [[nodiscard]] __device__ const KernelHead& head(float coc) const {
    constexpr double kLargest = ApertureKernels::kLargest;
    const std::uint32_t step = kernel_step(std::min(std::abs(static_cast<double>(coc)), kLargest));
    return heads[(coc < 0 ? kernels : 0) + std::min(step, kernels - 1)];
  }
  __device__ void prepare(DeviceFragment& f, const SortedFragments& sort) const {
    const KernelHead& kernel = head(f.coc);
    finish(f, sort, kernel.share,
           tilt_of({f.x, f.y, f.coc, f.slope, f.coverage, f.color}, kernel.reach));
  }
};

/// The upright rectangle that is the blur of diameter 1.
struct BoxTable : SpreadTable {
  double of_width, of_height, area;  ///< half of either side

  BoxTable(double half_of_width, double half_of_height, double its_area)
      : of_width(half_of_width), of_height(half_of_height), area(its_area) {}

  [[nodiscard]] __device__ double half_width(float coc) const { return size(coc) * of_width; }
  [[nodiscard]] __device__ double half_height(float coc) const { return size(coc) * of_height; }
  __device__ void prepare(DeviceFragment& f, const SortedFragments& sort) const {
    finish(f, sort, 1 / (area * size(f.coc) * size(f.coc)), {});
  }

 private:
  /// What is in focus has a little blur nevertheless.
  [[nodiscard]] __device__ static double size(float coc) {
    return std::max(std::abs(static_cast<double>(coc)), 1.0 / 64);
  }
};

/// Kernels of one side, one after another.
void append(const std::vector<ApertureKernel>& kernels, std::vector<KernelHead>& heads,
            std::vector<ApertureKernel::Span>& spans) {
  for (const ApertureKernel& kernel : kernels) {
    heads.push_back({kernel.top, kernel.bottom(), kernel.reach,
                     static_cast<std::uint32_t>(spans.size()), kernel.share});
    spans.insert(spans.end(), kernel.rows.begin(), kernel.rows.end());
  }
}

/// No fragment of the picture is blurred more.
double largest_blur(const DevicePicture& picture, const CircleOfDepth& circle) {
  const float near = circle(picture.nearest()), far = circle(picture.farthest());
  return static_cast<double>(std::max(std::abs(near), std::abs(far)));
}

}  // namespace

void DeviceSpread::make_kernels(const SpreadConfig& config, double largest, const Stream& stream) {
  const auto same = [](const Aperture& a, const Aperture& b) {
    return a.blades == b.blades && a.rotation_deg == b.rotation_deg;
  };
  if (kernels_ && kernels_->shape == config.shape && same(kernels_->aperture, config.aperture) &&
      kernels_->largest >= largest)
    return;
  const ApertureKernels kernels(config.shape, config.aperture, largest);
  std::vector<KernelHead> heads;
  std::vector<ApertureKernel::Span> spans;
  append(kernels.all(false), heads, spans);
  const auto count = static_cast<std::uint32_t>(heads.size());
  append(kernels.all(true), heads, spans);
  stream.wait();  // what is there may be in use
  kernels_.reset();
  kernels_ = Kernels{config.shape,
                     config.aperture,
                     largest,
                     count,
                     to_device(std::span<const KernelHead>(heads), stream),
                     to_device(std::span<const ApertureKernel::Span>(spans), stream)};
}

void DeviceSpread::run(const DevicePicture& picture, DeviceFragments& fragments,
                       const ThinLens& lens, const SpreadConfig& config, Rgba* result,
                       const Stream& stream) {
  const double limit = std::min(config.largest_diameter, ApertureKernels::kLargest);
  circles_of_confusion({}, lens, picture.width(), limit);  // checks lens and limit
  const auto outline = skewed_outline(outline_corners(config.shape, config.aperture));
  const CircleOfDepth circle(lens, picture.width(), limit);
  const bool upright = outline && outline->upright();
  const SortedFragments sorted = sorter_.begin(picture, fragments, config.layers, stream);
  if (!upright) make_kernels(config, largest_blur(picture, circle), stream);
  fragments.find(picture, circle, stream);
  if (upright) {
    const BoxTable table(outline->half_width, outline->half_height, outline->area);
    spread_picture<BoxBlurs>(sorted, table, picture.opaque(), result, stream);
  } else {
    const RowTable table(kernels_->heads.data(), kernels_->spans.data(), kernels_->count);
    spread_picture<RowBlurs>(sorted, table, picture.opaque(), result, stream);
  }
}

}  // namespace relumbre::cuda
