#include "relumbre/radiosity/segment_mean.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void check(std::span<const std::uint32_t> offsets, std::span<const float> area) {
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != area.size() ||
      !std::is_sorted(offsets.begin(), offsets.end()))
    throw ShapeError(
        fmt::format("patch offsets do not ascend from 0 to the {} elements", area.size()));
  for (std::size_t i = 0; i < area.size(); ++i) {
    if (!(area[i] > 0) || !std::isfinite(area[i]))
      throw ValueError(fmt::format("area of element {} is {}, not positive", i, area[i]));
  }
}

}  // namespace

SegmentMean::SegmentMean(std::span<const std::uint32_t> patch_offsets, std::span<const float> area,
                         const RowKernels& kernels)
    : offsets_(patch_offsets.begin(), patch_offsets.end()),
      weight_(area.size()),
      weighted_sum_(kernels.weighted_sum) {
  check(patch_offsets, area);
  for (std::size_t p = 0; p < patches(); ++p) {
    double total = 0;
    for (std::size_t i = offsets_[p]; i < offsets_[p + 1]; ++i)
      total += static_cast<double>(area[i]);
    for (std::size_t i = offsets_[p]; i < offsets_[p + 1]; ++i)
      weight_[i] = static_cast<float>(static_cast<double>(area[i]) / total);
  }
}

void SegmentMean::gather(const float* rgb, std::size_t first, std::size_t last, float* mean) const {
  for (std::size_t p = first; p < last; ++p) {
    const std::size_t begin = offsets_[p];
    float sum[3];
    weighted_sum_(rgb + 3 * begin, weight_.data() + begin, offsets_[p + 1] - begin, sum);
    for (std::size_t c = 0; c < 3; ++c) mean[c * patches() + p] = sum[c];
  }
}

}  // namespace relumbre
