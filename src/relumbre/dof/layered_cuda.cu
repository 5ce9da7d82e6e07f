#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/dof/blur_steps.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/layered_cuda.h"
#include "relumbre/dof/spread_tiles_cuda.cuh"

namespace relumbre::cuda {

namespace {

constexpr auto kLargestBlur = static_cast<float>(ApertureKernels::kLargest);

/// Every fragment is in the two steps between which it lies, with the blur that all have there.
struct StepTable {
  static constexpr unsigned kEntries = 2;
  const float *steps, *radii;
  std::uint32_t count;

  [[nodiscard]] __device__ unsigned entries(const DeviceFragment&) const {
    return count == 1 ? 1 : 2;
  }
  __device__ void prepare(DeviceFragment& f, const SortedFragments& sort) const {
    f.color = scaled_down(f.color, sort.summary);
    f.slope = {};
    f.layer = step_before(f.coc);
  }
  /// The radius of its box.
  [[nodiscard]] __device__ float blur(const DeviceFragment&, std::uint32_t step) const {
    return radii[step];
  }
  [[nodiscard]] __device__ double half_width(float radius) const {
    return static_cast<double>(radius) + 0.5;
  }
  [[nodiscard]] __device__ double half_height(float radius) const { return half_width(radius); }
  /// Of the fragment's light, of each pixel of the box.
  [[nodiscard]] __device__ float share(const DeviceFragment& f, std::uint32_t step) const {
    const float side = 2 * radii[step] + 1;
    if (count == 1) return 1 / (side * side);
    const float next = share_of_next(f.coc, steps[f.layer], steps[f.layer + 1]);
    return (step == f.layer ? 1 - next : next) / (side * side);
  }
  [[nodiscard]] __device__ static int reach(float radius) {
    return static_cast<int>(std::ceil(radius));
  }
  [[nodiscard]] __device__ int layer_reach(const SortedFragments&, std::uint32_t step) const {
    return reach(radii[step]);
  }
  [[nodiscard]] __device__ double diameter(const SortedFragments&, std::uint32_t step) const {
    return std::abs(static_cast<double>(steps[step]));
  }

 private:
  /// The last step that is not beyond it, of those that have one behind them.
  [[nodiscard]] __device__ std::uint32_t step_before(float coc) const {
    std::uint32_t low = 0, high = count < 2 ? 0 : count - 2;
    while (low < high) {
      const std::uint32_t middle = (low + high + 1) / 2;
      if (steps[middle] <= coc)
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }
};

/// Tiles look no farther than the largest kernel reaches.
void check_blur(float largest) {
  if (largest > kLargestBlur)
    throw ValueError("largest blur: " + std::to_string(largest) +
                     " pixels, the device's limit is " + std::to_string(kLargestBlur));
}

}  // namespace

void DeviceLayered::run(const DevicePicture& picture, DeviceFragments& fragments,
                        const ThinLens& lens, const LayeredConfig& config, Rgba* result,
                        const Stream& stream) {
  circles_of_confusion({}, lens, picture.width(), config.largest_diameter);  // checks both
  fragments.find(picture, CircleOfDepth(lens, picture.width(), config.largest_diameter), stream);
  FragmentSummary summary{};
  copy_to_host(fragments.summary(), std::span(&summary, 1), stream);
  stream.wait();
  check_blur(std::max(std::abs(summary.least_coc()), std::abs(summary.largest_coc())));
  std::vector<float> steps = blur_steps(summary.least_coc(), summary.largest_coc(), config.layers);
  const std::size_t count = steps.size();
  for (std::size_t i = 0; i < count; ++i) steps.push_back(box_radius_of(steps[i]));
  steps_.reserve(steps.size());
  copy_to_device<float>(steps, steps_.data(), stream);
  stream.wait();
  const StepTable table{steps_.data(), steps_.data() + count, static_cast<std::uint32_t>(count)};
  const SortedFragments sorted = sorter_.begin(picture, fragments, count, stream);
  spread_picture<BoxBlurs>(sorted, table, picture.opaque(), result, stream);
}

}  // namespace relumbre::cuda
