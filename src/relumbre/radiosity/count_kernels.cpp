#include "relumbre/radiosity/count_kernels.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "relumbre/radiosity/count_kernels_vnni.h"

// Arrays of vectors need vectors of a known size, which SVE's are not.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/radiosity/count_kernels.cpp"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;

/// Operands are padded with zeros to whole blocks of this many columns.
constexpr std::size_t kBlock = 64;

std::size_t padded(std::size_t columns) { return (columns + kBlock - 1) / kBlock * kBlock; }

HWY_INLINE Vector load_as_float(const float* p) { return hn::LoadU(Floats(), p); }

HWY_INLINE Vector load_as_float(const hwy::float16_t* p) {
  return hn::PromoteTo(Floats(), hn::LoadU(hn::Rebind<hwy::float16_t, Floats>(), p));
}

template <class Count>
HWY_INLINE Vector load_as_float(const Count* p) {
  const hn::Rebind<std::int32_t, Floats> integers;
  const auto counts = hn::LoadU(hn::Rebind<Count, Floats>(), p);
  return hn::ConvertTo(Floats(), hn::PromoteTo(integers, counts));
}

/// kRows rows at a time share each load of y; kRows · kChannels sums hide the latency of MulAdd.
/// A step takes a cache line of each row, so that prefetches are spread evenly.
template <std::size_t kChannels, std::size_t kRows, class T>
HWY_INLINE void multiply_rows(const T* table, std::size_t columns, const float* y, float* out) {
  const Floats df;
  const std::size_t stride = padded(columns);
  const std::size_t ahead = prefetch_distance(kRows * columns * sizeof(T));
  Vector sum[kRows * kChannels];
  for (Vector& s : sum) s = hn::Zero(df);
  const std::size_t lanes = hn::Lanes(df);
  constexpr std::size_t kVectors =
      std::max<std::size_t>(64 / sizeof(T) / hn::MaxLanes(Floats()), 1);
  for (std::size_t line = 0; line < columns; line += kVectors * lanes) {
    for (std::size_t r = 0; r < kRows; ++r) prefetch_table(table + r * columns + line, ahead);
    for (std::size_t v = 0; v < kVectors; ++v) {
      const std::size_t p = line + v * lanes;
      Vector y_p[kChannels];
      for (std::size_t c = 0; c < kChannels; ++c) y_p[c] = hn::Load(df, y + c * stride + p);
      for (std::size_t r = 0; r < kRows; ++r) {
        const Vector u = load_as_float(table + r * columns + p);
        for (std::size_t c = 0; c < kChannels; ++c)
          sum[r * kChannels + c] = hn::MulAdd(u, y_p[c], sum[r * kChannels + c]);
      }
    }
  }
  for (std::size_t s = 0; s < kRows * kChannels; ++s)
    out[s] = hn::GetLane(hn::SumOfLanes(df, sum[s]));
}

template <class T, std::size_t kChannels>
void multiply(const void* table, std::size_t rows, std::size_t columns, const std::byte* operand,
              float* out) {
  constexpr std::size_t kRows = 4;
  const T* row = static_cast<const T*>(table);
  const auto* y = reinterpret_cast<const float*>(operand);
  std::size_t r = 0;
  for (; r + kRows <= rows; r += kRows)
    multiply_rows<kChannels, kRows>(row + r * columns, columns, y, out + r * kChannels);
  for (; r < rows; ++r)
    multiply_rows<kChannels, 1>(row + r * columns, columns, y, out + r * kChannels);
}

template <std::size_t kChannels>
std::size_t operand_bytes(std::size_t columns) {
  return kChannels * padded(columns) * sizeof(float);
}

/// y as it is, each channel padded with zeros.
template <std::size_t kChannels>
void pack(const float* y, std::size_t columns, std::byte* operand) {
  auto* to = reinterpret_cast<float*>(operand);
  const std::size_t stride = padded(columns);
  for (std::size_t c = 0; c < kChannels; ++c) {
    std::copy_n(y + c * columns, columns, to + c * stride);
    std::fill_n(to + c * stride + columns, stride - columns, 0.0F);
  }
}

template <class T, std::size_t kChannels>
constexpr RowProduct product() {
  return {operand_bytes<kChannels>, pack<kChannels>, multiply<T, kChannels>};
}

void weighted_sum(const float* rgb, const float* weight, std::size_t count, float* sum) {
  const Floats df;
  const std::size_t lanes = hn::Lanes(df);
  std::size_t i = 0;
  float rest[3] = {0, 0, 0};
  if (count >= lanes) {
    Vector r = hn::Zero(df), g = r, b = r;
    for (; i + lanes <= count; i += lanes) {
      Vector ri, gi, bi;
      hn::LoadInterleaved3(df, rgb + 3 * i, ri, gi, bi);
      const Vector w = hn::LoadU(df, weight + i);
      r = hn::MulAdd(w, ri, r), g = hn::MulAdd(w, gi, g), b = hn::MulAdd(w, bi, b);
    }
    rest[0] = hn::GetLane(hn::SumOfLanes(df, r));
    rest[1] = hn::GetLane(hn::SumOfLanes(df, g));
    rest[2] = hn::GetLane(hn::SumOfLanes(df, b));
  }
  for (; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rest[c] += weight[i] * rgb[3 * i + c];
  }
  std::copy_n(rest, 3, sum);
}

RowKernels kernels() {
  return {hwy::TargetName(HWY_TARGET),  product<float, 3>(),
          product<hwy::float16_t, 3>(), product<std::uint16_t, 3>(),
          product<std::uint8_t, 3>(),   product<float, 1>(),
          product<std::uint16_t, 1>(),  weighted_sum};
}

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "relumbre/base/instruction_sets-inl.h"

namespace relumbre {

HWY_EXPORT(kernels);

namespace {

RowKernels with_vnni(RowKernels kernels_) {
  kernels_.name = "AVX3+VNNI";
  kernels_.uint8 = vnni_uint8_product();
  return kernels_;
}

}  // namespace

const RowKernels& best_row_kernels() {
  static const RowKernels best = [] {
    const RowKernels portable = HWY_DYNAMIC_DISPATCH(kernels)();
    return has_vnni() ? with_vnni(portable) : portable;
  }();
  return best;
}

std::vector<RowKernels> available_row_kernels() {
  std::vector<RowKernels> all =
      on_every_instruction_set([] { return HWY_DYNAMIC_DISPATCH(kernels)(); });
  all.insert(all.begin(), best_row_kernels());
  return all;
}

}  // namespace relumbre
#endif  // HWY_ONCE
