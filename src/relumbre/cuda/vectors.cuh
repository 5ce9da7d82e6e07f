/// Neighbouring values by accesses of up to 16 bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include <cuda_runtime.h>

#include "relumbre/base/host_device.h"

namespace relumbre::cuda {

/// The widest access that a thread can make.
inline constexpr std::size_t kVectorBytes = 16;

template <class T, unsigned kCount>
constexpr std::size_t pack_alignment() {
  const std::size_t bytes = sizeof(T) * kCount;
  if (!std::has_single_bit(bytes)) return alignof(T);
  return bytes < kVectorBytes ? bytes : kVectorBytes;
}

/// As many values, loaded or stored by the widest accesses that there are.
template <class T, unsigned kCount>
struct alignas(pack_alignment<T, kCount>()) Pack {
  T values[kCount];
};

/// Values that a thread loads and stores together, so that neither access is wider than 16 bytes. 1
/// for sizes that are no powers of two.
template <class In, class Out>
inline constexpr unsigned kPackOf =
    std::has_single_bit(sizeof(In)) && std::has_single_bit(sizeof(Out)) &&
            sizeof(In) <= kVectorBytes && sizeof(Out) <= kVectorBytes
        ? static_cast<unsigned>(kVectorBytes /
                                (sizeof(In) > sizeof(Out) ? sizeof(In) : sizeof(Out)))
        : 1;

template <unsigned kCount, class T>
[[nodiscard]] RELUMBRE_HOST_DEVICE bool is_aligned(const T* at) {
  return reinterpret_cast<std::uintptr_t>(at) % alignof(Pack<T, kCount>) == 0;
}

/// from[0] … from[kCount − 1]; `aligned` says whether the address is that of a Pack.
template <unsigned kCount, class T>
__device__ __forceinline__ Pack<T, kCount> load_pack(const T* from, bool aligned) {
  if (aligned) return *reinterpret_cast<const Pack<T, kCount>*>(from);
  Pack<T, kCount> pack;
#pragma unroll
  for (unsigned k = 0; k < kCount; ++k) pack.values[k] = from[k];
  return pack;
}
template <class T, unsigned kCount>
__device__ __forceinline__ void store_pack(const Pack<T, kCount>& pack, T* to, bool aligned) {
  if (aligned) {
    *reinterpret_cast<Pack<T, kCount>*>(to) = pack;
  } else {
#pragma unroll
    for (unsigned k = 0; k < kCount; ++k) to[k] = pack.values[k];
  }
}

/// The same of the first `count`; the others are T{}, and not stored.
template <unsigned kCount, class T>
__device__ __forceinline__ Pack<T, kCount> load_part(const T* from, unsigned count) {
  Pack<T, kCount> pack{};
#pragma unroll
  for (unsigned k = 0; k < kCount; ++k)
    if (k < count) pack.values[k] = from[k];
  return pack;
}
template <class T, unsigned kCount>
__device__ __forceinline__ void store_part(const Pack<T, kCount>& pack, T* to, unsigned count) {
#pragma unroll
  for (unsigned k = 0; k < kCount; ++k)
    if (k < count) to[k] = pack.values[k];
}

}  // namespace relumbre::cuda
