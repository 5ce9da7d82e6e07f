/// What the blocks of a scan on a GPU tell one another by.
#pragma once

#include <cstddef>
#include <cstdint>

#include "relumbre/cuda/memory.h"

namespace relumbre::cuda {

/// Reusable memory of scans, of any sizes, types and kinds one after the other. It is cleared when
/// it grows and never again: every scan marks its words with a number of its own (cuda/tagged.cuh).
///
/// One scan at a time: use it in one stream only. It grows when a scan needs more, which waits for
/// the device; to record a scan in a Graph, do one as large before.
class ScanScratch {
 public:
  struct View {
    unsigned long long* counter;  ///< of tickets
    std::uint64_t* words;
  };
  /// With room for so many words.
  [[nodiscard]] View view(std::size_t words, const Stream& stream) {
    if (memory_.size() < kHeader + words) {
      memory_.reserve(kHeader + words + words / 4);
      clear(memory_.data(), memory_.size(), stream);
    }
    return {reinterpret_cast<unsigned long long*>(memory_.data()), memory_.data() + kHeader};
  }
  [[nodiscard]] std::size_t bytes() const { return memory_.bytes(); }

 private:
  /// All blocks add to the counter; it has a cache line of its own.
  static constexpr std::size_t kHeader = 16;
  DeviceArray<std::uint64_t> memory_;
};

}  // namespace relumbre::cuda
