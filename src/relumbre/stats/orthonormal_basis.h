/// The columns of a linear model, made orthonormal one after the other.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace relumbre {

/// Orthonormal vectors that span every column added. Twice-iterated Gram-Schmidt, orthonormal to
/// rounding (Giraud et al. 2005).
class OrthonormalBasis {
 public:
  /// Adds what of the column the basis does not span yet; false if that is nothing but rounding.
  /// 8·size()·rows flops. All columns are of one length.
  bool add(std::vector<double> column);

  [[nodiscard]] std::size_t size() const { return vectors_.size(); }
  [[nodiscard]] std::span<const double> operator[](std::size_t i) const { return vectors_[i]; }
  /// The projections of v on the basis' vectors.
  [[nodiscard]] std::vector<double> coordinates(std::span<const double> v) const;

 private:
  std::vector<std::vector<double>> vectors_;
};

}  // namespace relumbre
