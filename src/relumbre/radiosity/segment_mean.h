/// Vᵀ: area-weighted means over the elements of each patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/radiosity/count_kernels.h"

namespace relumbre {

/// V_jp = A_j / A_p where element j is of patch p, else 0. Elements of a patch are contiguous, so V
/// is the list of its n nonzeros. A patch without elements has mean 0.
class SegmentMean {
 public:
  /// Throws ShapeError unless patch_offsets ascend from 0 to area.size(), ValueError naming the
  /// element for an area that is not positive and finite.
  SegmentMean(std::span<const std::uint32_t> patch_offsets, std::span<const float> area,
              const RowKernels& kernels = best_row_kernels());

  [[nodiscard]] std::size_t elements() const { return weight_.size(); }
  [[nodiscard]] std::size_t patches() const { return offsets_.size() - 1; }
  [[nodiscard]] std::size_t first_element(std::size_t patch) const { return offsets_[patch]; }
  [[nodiscard]] std::span<const float> weights() const { return weight_; }

  /// mean[c·patches + p] of n RGB values, for the patches first ≤ p < last. A NaN or an infinity
  /// among a patch's values makes its mean not finite.
  void gather(const float* rgb, std::size_t first, std::size_t last, float* mean) const;

 private:
  std::vector<std::uint32_t> offsets_;  // k + 1
  std::vector<float> weight_;           // n
  decltype(RowKernels::weighted_sum) weighted_sum_;
};

}  // namespace relumbre
