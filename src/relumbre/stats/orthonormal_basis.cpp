#include "relumbre/stats/orthonormal_basis.h"

#include <cmath>
#include <numeric>

namespace relumbre {

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

bool OrthonormalBasis::add(std::vector<double> column) {
  // Columns of models are small integers or their coordinates: what is this small is rounding.
  constexpr double kDependent = 1e-9;
  const double before = std::sqrt(dot(column, column));
  for (int pass = 0; pass < 2; ++pass)
    for (const std::vector<double>& q : vectors_) {
      const double along = dot(q, column);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] -= along * q[i];
    }
  const double after = std::sqrt(dot(column, column));
  if (!(after > kDependent * before)) return false;
  for (double& x : column) x /= after;
  vectors_.push_back(std::move(column));
  return true;
}

std::vector<double> OrthonormalBasis::coordinates(std::span<const double> v) const {
  std::vector<double> result;
  for (const std::vector<double>& q : vectors_) result.push_back(dot(q, v));
  return result;
}

}  // namespace relumbre
