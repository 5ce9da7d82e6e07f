/// Memory for large tables: aligned, uninitialised, on huge pages where the system has them.
#pragma once

#include <cstddef>
#include <memory>

namespace relumbre {

/// An owner of `size()` uninitialised bytes, aligned to 64 (to 2 MiB from 2 MiB upwards, and
/// advised to use huge pages: streaming a table of 50 MB touches 12,000 small pages, and their
/// address translations cost up to a tenth of the bandwidth). Throws std::bad_alloc.
class HugeBuffer {
 public:
  HugeBuffer() = default;
  explicit HugeBuffer(std::size_t bytes);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::byte* data() { return bytes_.get(); }
  [[nodiscard]] const std::byte* data() const { return bytes_.get(); }

 private:
  struct Free {
    void operator()(std::byte* bytes) const;
  };
  std::unique_ptr<std::byte[], Free> bytes_;
  std::size_t size_ = 0;
};

}  // namespace relumbre
