/// 8-bit counts times three channels by integer dot products (AVX-512 VNNI).
#pragma once

#include "relumbre/radiosity/count_kernels.h"

namespace relumbre {

/// True where the CPU has the instructions and this is a build for its architecture.
bool has_vnni();

/// The product for uint8 tables of at most kMaxVnniColumns columns. Only callable if has_vnni().
RowProduct vnni_uint8_product();

/// |Σ_p c_p·d_p| ≤ columns · 255 · 128 must stay below 2^31, the range of an accumulator.
inline constexpr std::size_t kMaxVnniColumns = 65'000;

}  // namespace relumbre
