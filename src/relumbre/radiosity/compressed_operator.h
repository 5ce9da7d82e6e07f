/// B = E + R U M Vᵀ E with U of ray counts: the operator of the real-time stage.
#pragma once

#include <vector>

#include "relumbre/base/huge_array.h"
#include "relumbre/radiosity/count_matrix.h"
#include "relumbre/radiosity/patch_transport.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/radiosity/segment_mean.h"

namespace relumbre {

/// What make_compressed_operator makes, with the instruction set in the open.
class CompressedOperator final : public EditableOperator {
 public:
  CompressedOperator(const OperatorInput& input, CountFormat format,
                     const RowKernels& kernels = best_row_kernels());

  [[nodiscard]] std::size_t elements() const override { return counts_.rows(); }
  [[nodiscard]] std::size_t patches() const override { return counts_.columns(); }
  [[nodiscard]] std::string_view name() const override { return to_string(counts_.format()); }
  [[nodiscard]] std::size_t bytes_per_apply() const override;
  void set_reflectance(std::span<const Rgb> reflectance) override;

 private:
  /// Vectors over patches, for all sources: source-major, then channel.
  struct Scratch {
    std::vector<float> mean;  ///< e = VᵀE
    std::vector<float> y;     ///< M e / rays
    HugeBuffer operands;      ///< e, then y, in packed form: a group of sources
  };

  void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                     std::size_t sources) const override;
  void reserve(std::size_t sources) const;
  [[nodiscard]] std::size_t group_size(std::size_t sources) const;
  void gather(std::span<const float> emission, std::size_t sources) const;
  void exchange(std::size_t first_source, std::size_t sources) const;
  void scatter(const float* emission, float* radiosity, std::size_t first_source,
               std::size_t sources) const;
  void scatter_rows(std::size_t first, std::size_t last, const float* emission, float* radiosity,
                    std::size_t first_source, std::size_t sources) const;

  CountMatrix counts_;            // U
  SegmentMean mean_;              // Vᵀ
  PatchTransport transport_;      // M
  std::vector<Rgb> reflectance_;  // R
  mutable Scratch scratch_;
};

}  // namespace relumbre
