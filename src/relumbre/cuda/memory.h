/// Memory on a device and page-locked memory beside it, owned.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <cuda_runtime_api.h>

#include "relumbre/cuda/error.h"
#include "relumbre/cuda/stream.h"

namespace relumbre::cuda {

namespace detail {
/// Throw OutOfDeviceMemory with figures, or DeviceError.
void* allocate_device(std::size_t bytes);
void* allocate_pinned(std::size_t bytes);
struct FreeDevice {
  void operator()(void* memory) const { cudaFree(memory); }
};
struct FreePinned {
  void operator()(void* memory) const { cudaFreeHost(memory); }
};
}  // namespace detail

/// An array of `size` values that are not set. Pointers are aligned to 256 bytes.
template <class T, auto kAllocate, class Free>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Array() = default;
  explicit Array(std::size_t size) : size_(size) {
    if (size > static_cast<std::size_t>(-1) / sizeof(T)) throw DeviceError("an array too large");
    if (size > 0) memory_.reset(kAllocate(size * sizeof(T)));
  }
  [[nodiscard]] T* data() const { return static_cast<T*>(memory_.get()); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const { return size_ * sizeof(T); }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// At least so many; what it held is lost if it has to grow.
  void reserve(std::size_t size) {
    if (size <= size_) return;
    *this = {};
    *this = Array(size);
  }

 private:
  std::unique_ptr<void, Free> memory_;
  std::size_t size_ = 0;
};

/// On the device: the host must not touch it.
template <class T>
using DeviceArray = Array<T, detail::allocate_device, detail::FreeDevice>;

/// On the host, page-locked, so that copies to and from it are fast and truly asynchronous.
template <class T>
using PinnedArray = Array<T, detail::allocate_pinned, detail::FreePinned>;

template <class T>
[[nodiscard]] std::span<T> values_of(const PinnedArray<T>& array) {
  return {array.data(), array.size()};
}

/// Asynchronous copies in the order of the stream. Pageable host memory may make them wait.
template <class T>
void copy_to_device(std::span<const std::type_identity_t<T>> from, T* to, const Stream& stream) {
  if (from.empty()) return;
  check(cudaMemcpyAsync(to, from.data(), from.size_bytes(), cudaMemcpyHostToDevice, stream.get()));
}
template <class T>
void copy_to_host(const T* from, std::span<std::type_identity_t<T>> to, const Stream& stream) {
  if (to.empty()) return;
  check(cudaMemcpyAsync(to.data(), from, to.size_bytes(), cudaMemcpyDeviceToHost, stream.get()));
}
template <class T>
void copy_on_device(const T* from, T* to, std::size_t size, const Stream& stream) {
  if (size == 0) return;
  check(cudaMemcpyAsync(to, from, size * sizeof(T), cudaMemcpyDeviceToDevice, stream.get()));
}
/// All bytes 0.
template <class T>
void clear(T* at, std::size_t size, const Stream& stream) {
  if (size == 0) return;
  check(cudaMemsetAsync(at, 0, size * sizeof(T), stream.get()));
}

/// A new array that holds these; waits until it does.
template <class T>
DeviceArray<std::remove_const_t<T>> to_device(std::span<T> values, const Stream& stream) {
  DeviceArray<std::remove_const_t<T>> array(values.size());
  copy_to_device<std::remove_const_t<T>>(values, array.data(), stream);
  stream.wait();
  return array;
}

}  // namespace relumbre::cuda
