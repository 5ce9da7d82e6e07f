// The paper's real-time stage: B = E − Y_c (Vᵀ E), two SGEMV a channel over dense matrices.
//
//   V     n × k     12,000 zeros for each nonzero at k = 12,000, all of them read
//   Y_c   n × k     −R_c U M_c
//
// Columns are contiguous, because OpenBLAS runs both products faster so.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/huge_array.h"
#include "relumbre/base/parallel.h"
#include "relumbre/linalg/blas.h"
#include "relumbre/radiosity/count_matrix.h"
#include "relumbre/radiosity/operator_input.h"
#include "relumbre/radiosity/patch_transport.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/radiosity/segment_mean.h"

namespace relumbre {

namespace {

constexpr std::size_t kRowGrain = 256;

/// An owned n × k matrix on the memory that the other operators use, to be fair to this one.
class DenseMatrix {
 public:
  DenseMatrix() = default;
  DenseMatrix(std::size_t rows, std::size_t columns)
      : rows_(rows), columns_(columns), memory_(rows * columns * sizeof(float)) {
    std::ranges::fill(values(), 0.0F);
  }
  [[nodiscard]] std::span<float> values() {
    return {reinterpret_cast<float*>(memory_.data()), rows_ * columns_};
  }
  [[nodiscard]] ColumnMajor view() const {
    return {{reinterpret_cast<const float*>(memory_.data()), rows_ * columns_}, rows_, columns_};
  }
  float& operator()(std::size_t i, std::size_t j) { return values()[j * rows_ + i]; }

 private:
  std::size_t rows_ = 0, columns_ = 0;
  HugeBuffer memory_;
};

class PaperOperator final : public RelightOperator {
 public:
  PaperOperator(const OperatorInput& input, const CountMatrix& counts, const SegmentMean& mean)
      : n_(counts.rows()), k_(counts.columns()), v_(n_, k_), emission_(n_), patch_(k_) {
    for (std::size_t p = 0; p < k_; ++p) {
      for (std::size_t i = mean.first_element(p); i < mean.first_element(p + 1); ++i)
        v_(i, p) = mean.weights()[i];
    }
    for (std::size_t c = 0; c < 3; ++c) fill_y(input, counts, mean, c);
  }

  [[nodiscard]] std::size_t elements() const override { return n_; }
  [[nodiscard]] std::size_t patches() const override { return k_; }
  [[nodiscard]] std::string_view name() const override { return "paper"; }
  [[nodiscard]] std::size_t bytes_per_apply() const override {
    const std::size_t matrix = n_ * k_ * sizeof(float), vector = n_ * sizeof(float);
    return 3 * (2 * matrix + 3 * vector);  // V, Y; E read twice, B written
  }

 private:
  void fill_y(const OperatorInput& input, const CountMatrix& counts, const SegmentMean& mean,
              std::size_t channel) {
    DenseMatrix ru(n_, k_), m(k_, k_);
    parallel_chunks(0, n_, kRowGrain, [&](std::size_t first, std::size_t last) {
      std::vector<double> row(k_);
      for (std::size_t i = first; i < last; ++i) {
        counts.decode_row(i, row);
        const double scale = static_cast<double>(input.reflectance[i][channel]) / counts.rays();
        for (std::size_t p = 0; p < k_; ++p) ru(i, p) = static_cast<float>(scale * row[p]);
      }
    });
    const std::vector<double> inner = interreflections(counts, mean, input.reflectance, channel);
    for (std::size_t p = 0; p < k_; ++p) {
      for (std::size_t q = 0; q < k_; ++q)
        m(p, q) = static_cast<float>(inner[p * k_ + q]) + (p == q ? 1.0F : 0.0F);
    }
    y_[channel] = DenseMatrix(n_, k_);
    gemm(-1.0F, ru.view(), m.view(), y_[channel].values());
  }

  void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                     std::size_t sources) const override {
    for (const float e : emission) {
      if (!std::isfinite(e)) throw_not_finite(emission, n_);
    }
    for (std::size_t s = 0; s < sources; ++s) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = 3 * s * n_ + c;
        for (std::size_t i = 0; i < n_; ++i) emission_[i] = emission[at + 3 * i];
        gemv(Transpose::kYes, 1.0F, v_.view(), emission_, 0.0F, patch_);
        gemv(Transpose::kNo, -1.0F, y_[c].view(), patch_, 1.0F, emission_);
        for (std::size_t i = 0; i < n_; ++i) radiosity[at + 3 * i] = emission_[i];
      }
    }
  }

  std::size_t n_, k_;
  DenseMatrix v_;
  std::array<DenseMatrix, 3> y_;
  mutable std::vector<float> emission_, patch_;
};

}  // namespace

std::unique_ptr<RelightOperator> make_paper_operator(const OperatorInput& input) {
  check_operator_input(input);
  const CountMatrix counts(input.counts, CountFormat::kFloat32);
  const SegmentMean mean(input.patch_offsets, input.area);
  return std::make_unique<PaperOperator>(input, counts, mean);
}

}  // namespace relumbre
