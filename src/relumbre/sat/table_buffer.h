/// Memory for tables: aligned, uninitialised, on huge pages where the system has them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace relumbre {

/// Uninitialised memory that begins a cache line (a huge page from 2 MiB upwards, whose fewer
/// address translations matter to a table that is streamed). Freed with std::free.
struct FreeTable {
  void operator()(void* memory) const;
};
/// Throws std::bad_alloc.
std::unique_ptr<void, FreeTable> allocate_table(std::size_t bytes);

/// An owner of `size` uninitialised numbers.
template <class T>
class TableBuffer {
 public:
  TableBuffer() = default;
  explicit TableBuffer(std::size_t size) : memory_(allocate_table(size * sizeof(T))), size_(size) {}

  [[nodiscard]] T* data() { return static_cast<T*>(memory_.get()); }
  [[nodiscard]] const T* data() const { return static_cast<const T*>(memory_.get()); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<T> span() { return {data(), size_}; }
  [[nodiscard]] std::span<const T> span() const { return {data(), size_}; }

 private:
  std::unique_ptr<void, FreeTable> memory_;
  std::size_t size_ = 0;
};

}  // namespace relumbre
