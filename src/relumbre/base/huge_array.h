/// Memory for large tables: aligned, uninitialised, on huge pages where the system has them.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace relumbre {

struct FreeHuge {
  void operator()(void* memory) const;
};

/// `bytes` uninitialised bytes, aligned to 64 (to 2 MiB from 2 MiB upwards, and advised to use huge
/// pages: streaming a table of 50 MB touches 12,000 small pages, and their address translations
/// cost up to a tenth of the bandwidth). Null if there are to be none. Throws std::bad_alloc.
std::unique_ptr<void, FreeHuge> allocate_huge(std::size_t bytes);

/// An owner of `size()` uninitialised values in such memory.
template <class T>
requires std::is_trivially_copyable_v<T>
class HugeArray {
 public:
  HugeArray() = default;
  explicit HugeArray(std::size_t size) : memory_(allocate_huge(bytes_of(size))), size_(size) {}
  HugeArray(HugeArray&& other) noexcept
      : memory_(std::move(other.memory_)), size_(std::exchange(other.size_, 0)) {}
  HugeArray& operator=(HugeArray&& other) noexcept {
    memory_ = std::move(other.memory_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return static_cast<T*>(memory_.get()); }
  [[nodiscard]] const T* data() const { return static_cast<const T*>(memory_.get()); }
  [[nodiscard]] std::span<T> span() { return {data(), size_}; }
  [[nodiscard]] std::span<const T> span() const { return {data(), size_}; }

 private:
  static std::size_t bytes_of(std::size_t size) {
    if (size > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
    return size * sizeof(T);
  }

  std::unique_ptr<void, FreeHuge> memory_;
  std::size_t size_ = 0;
};

using HugeBuffer = HugeArray<std::byte>;

}  // namespace relumbre
