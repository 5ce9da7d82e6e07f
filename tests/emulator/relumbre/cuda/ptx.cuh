/// Stands in for src/relumbre/cuda/ptx.cuh.
#pragma once

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
T load_acquire(const T* at) {
  return *at;
}
template <class T>
void store_release(T* at, T value) {
  *at = value;
}
inline void add_without_result(float* at, float value) { atomicAdd(at, value); }

}  // namespace relumbre::cuda
