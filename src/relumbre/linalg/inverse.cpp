#include "relumbre/linalg/inverse.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>
#include <lapacke.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr std::size_t kMaxOrder = 46340;  // order² < 2^31
/// Up to here one thread is fast enough, and the threads of BLAS, which wait for each other
/// spinning, would take seconds for milliseconds' work on a machine whose cores are busy.
constexpr std::size_t kAlone = 512;

void check(std::span<const double> matrix, std::size_t order) {
  if (order > kMaxOrder)
    throw ValueError(
        fmt::format("matrix order {} exceeds {}, the most LAPACK addresses", order, kMaxOrder));
  if (matrix.size() != order * order)
    throw ShapeError(fmt::format("a matrix of order {} has {} entries, not {}", order,
                                 order * order, matrix.size()));
}

bool all_finite(std::span<const double> values) {
  double probe = 0;  // 0·x is NaN for a NaN or an infinity
  for (const double x : values) probe += 0.0 * x;
  return !std::isnan(probe);
}

// Both read columns: they invert the transpose, which is the transpose of the inverse.

bool invert_alone(std::span<double> matrix, std::size_t order) {
  const auto n = static_cast<Eigen::Index>(order);
  Eigen::Map<Eigen::MatrixXd> a(matrix.data(), n, n);
  a = Eigen::MatrixXd(a.partialPivLu().inverse());
  return all_finite(matrix);
}

bool invert_together(std::span<double> matrix, std::size_t order) {
  const auto n = static_cast<lapack_int>(order);
  std::vector<lapack_int> pivots(order);
  return LAPACKE_dgetrf(LAPACK_COL_MAJOR, n, n, matrix.data(), n, pivots.data()) == 0 &&
         LAPACKE_dgetri(LAPACK_COL_MAJOR, n, matrix.data(), n, pivots.data()) == 0;
}

}  // namespace

void invert(std::span<double> matrix, std::size_t order) {
  check(matrix, order);
  if (order == 0) return;
  if (!all_finite(matrix)) throw Error(fmt::format("matrix of order {} is not finite", order));
  const bool regular =
      order <= kAlone ? invert_alone(matrix, order) : invert_together(matrix, order);
  if (!regular) throw Error(fmt::format("matrix of order {} is singular", order));
}

}  // namespace relumbre
