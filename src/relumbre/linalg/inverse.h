/// The inverse of a dense matrix, on LAPACK.
#pragma once

#include <cstddef>
#include <span>

namespace relumbre {

/// Replaces the order × order row-major matrix by its inverse: LU with partial pivoting in float64,
/// by Eigen up to order 512, beyond that by LAPACK on all cores. 2·order³ flops; memory beyond the
/// matrix: O(64·order), or once more the matrix up to order 512.
/// Throws ShapeError if matrix.size() ≠ order², ValueError if order exceeds what LAPACK's 32-bit
/// indices address (46,340), Error if the matrix is singular or holds a NaN or an infinity.
void invert(std::span<double> matrix, std::size_t order);

}  // namespace relumbre
