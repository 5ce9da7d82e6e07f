/// Writes down what a ray caster asks for, on any number of threads, a row of pixels each.
///
///   TraceRecorder recorder(shape);
///   parallel_for(0, height, 1, [&](std::size_t y) {
///     TraceRecorder::Row row = recorder.row(y);
///     for each pixel:  row.begin_ray();  row.task() for each task popped;  row.read() for each
///     read row.finish();
///   });
///   const Trace trace = recorder.finish();          the same for any number of threads
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "relumbre/archsim/trace.h"

namespace relumbre {

class TraceRecorder {
 public:
  /// Throws ValueError for a shape that cannot be.
  explicit TraceRecorder(const TraceShape& shape);

  class Row {
   public:
    /// The row's next pixel.
    void begin_ray();
    /// Of the ray that has begun.
    void task() {
      assert(tasks_ != nullptr);
      ++*tasks_;
    }
    /// Throws ValueError unless a ray has begun, the address is of this level and its parent is
    /// what the ray read last one level up.
    void read(std::uint64_t address, int level) {
      const auto at = static_cast<std::size_t>(level);
      if (at >= levels_ || last_[at] != address >> 3 || (at == 0 && address != 1))
        refuse(address, level);
      last_[at + 1] = address;
      reads_.push_back(pack_read(level, static_cast<unsigned>(address & 7)));
      ++*read_counts_;
    }
    /// Hands the row over. Throws ValueError if it has not begun as many rays as there are pixels.
    void finish();

   private:
    friend class TraceRecorder;
    Row(TraceRecorder& recorder, std::uint32_t y);
    [[noreturn]] void refuse(std::uint64_t address, int level) const;

    TraceRecorder& recorder_;
    std::uint32_t y_, begun_ = 0;
    std::size_t levels_ = 0;  ///< that may be read: none before the first ray
    std::uint32_t *tasks_ = nullptr, *read_counts_ = nullptr;  ///< of the pixel
    /// [level + 1]; above the root 0, for what the ray has not read no address's parent.
    std::array<std::uint64_t, kMaxTraceLevels + 1> last_{};
    std::vector<std::uint8_t> reads_;
  };

  /// Each row once; different rows may be recorded at the same time. Throws ValueError for a row
  /// that is not in the picture.
  Row row(std::uint32_t y);

  /// Once, when all rows are finished; rows that never were have no tasks and no reads.
  Trace finish();

 private:
  TraceShape shape_;
  HugeArray<std::uint32_t> tasks_, read_counts_;
  std::vector<std::vector<std::uint8_t>> rows_;
};

}  // namespace relumbre
