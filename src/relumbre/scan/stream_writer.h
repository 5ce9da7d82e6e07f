/// Writes a long array past the caches, so that a line is not read before it is overwritten.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "relumbre/scan/kernels.h"

namespace relumbre {

/// Copies whole cache lines to memory past the caches; `to` is aligned to a line.
void stream_lines(const std::byte* from, std::size_t lines, std::byte* to);

/// Orders what this thread streamed before its later stores, as ordinary stores are.
void end_streaming();

/// Takes results in runs through a small buffer, which stays in the first-level cache, and streams
/// whole cache lines from it. What is written may be read by others once finish() and
/// end_streaming() have returned.
template <class T>
requires std::is_trivially_copyable_v<T>
class StreamWriter {
 public:
  static constexpr std::size_t kRun = 2 * kRunGranule;  ///< elements

  /// `to` is where the first result goes.
  explicit StreamWriter(T* to)
      : begin_(reinterpret_cast<std::uintptr_t>(to) % kLine),
        fill_(begin_),
        line_(reinterpret_cast<std::byte*>(to) - begin_) {}

  /// Room for the next kRun results.
  [[nodiscard]] T* buffer() { return reinterpret_cast<T*>(bytes_ + fill_); }
  /// The first `count` results in the buffer are ready.
  void commit(std::size_t count) {
    fill_ += count * sizeof(T);
    const std::size_t whole = fill_ / kLine * kLine;
    if (whole == 0) return;
    if (begin_ > 0) std::memcpy(line_ + begin_, bytes_ + begin_, kLine - begin_);
    const std::size_t skip = begin_ > 0 ? kLine : 0;
    stream_lines(bytes_ + skip, (whole - skip) / kLine, line_ + skip);
    begin_ = 0, fill_ -= whole, line_ += whole;
    std::memmove(bytes_, bytes_ + whole, fill_);
  }
  /// Nothing follows.
  void finish() { std::memcpy(line_ + begin_, bytes_ + begin_, fill_ - begin_); }

 private:
  static constexpr std::size_t kLine = 64;

  // bytes_ mirrors memory from line_ on, of which [begin_, fill_) is ready but not written.
  alignas(kLine) std::byte bytes_[kLine + kRun * sizeof(T)];
  std::size_t begin_, fill_;
  std::byte* line_;
};

/// Whether so many bytes outgrow the last-level cache.
bool outgrows_cache(std::size_t bytes);

}  // namespace relumbre
