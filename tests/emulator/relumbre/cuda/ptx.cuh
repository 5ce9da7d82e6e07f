/// Stands in for src/relumbre/cuda/ptx.cuh.
#pragma once

#include <array>

#include <cuda_fp16.h>
#include <cuda_runtime.h>

namespace relumbre::cuda {

template <class T>
T load_relaxed(const T* at) {
  return *at;
}
template <class T>
void store_relaxed(T* at, T value) {
  *at = value;
}
template <class T>
void forget(T&) {}

/// d += a b; see the real one. Each lane gives its parts of a and b.
inline void multiply_tiles(float (&d)[4], const unsigned (&a)[4], const unsigned (&b)[2],
                           emulator::Site site = emulator::Site::current()) {
  struct Parts {
    std::array<__half2, 4> value;
  };
  const unsigned lane = emulator::lane(), g = lane / 4, t = lane % 4;
  const auto exchange = [&](const Parts& parts) {
    return emulator::exchange(~0U, parts, site, [](const emulator::Exchange& all) {
      std::array<Parts, 32> result;
      for (unsigned i = 0; i < 32; ++i) result[i] = emulator::value_of<Parts>(all, i);
      return result;
    });
  };
  Parts mine_a, mine_b{};
  std::memcpy(&mine_a, a, sizeof(a));
  std::memcpy(&mine_b, b, sizeof(b));
  const std::array<Parts, 32> as = exchange(mine_a), bs = exchange(mine_b);
  // Of row r and column k of a, and row k and column c of b.
  const auto half_of = [](const __half2& pair, unsigned which) {
    return __half2float(which == 0 ? pair.x : pair.y);
  };
  for (unsigned e = 0; e < 4; ++e) {
    const unsigned row = g + 8 * (e / 2), column = 2 * t + e % 2;
    for (unsigned k = 0; k < 16; ++k) {
      const unsigned in = k % 8 / 2;
      const float left = half_of(as[row % 8 * 4 + in].value[row / 8 + 2 * (k / 8)], k % 2);
      const float right = half_of(bs[column * 4 + in].value[k / 8], k % 2);
      d[e] += left * right;
    }
  }
}

}  // namespace relumbre::cuda
