/// What a ray caster asked a memory for, ray by ray and in order: enough to simulate any machine
/// afterwards, since caches and tiles change no ray.
///
/// Addresses form a tree of eight children a node: root 1, child = 8 · parent + octant, so that an
/// address of level l has 3·l + 1 bits. Within a ray each read's parent is the *last* node read one
/// level up. Any traversal that walks a tree does that, since it learns of a node from its parent's
/// word. So a read needs no address, only a byte:
///
///   bits 7 ... 3   2 1 0
///       level      octant          address = 8 · (last address at level - 1, of this ray) + octant
///
/// Above the root there is address 0, so that the root's own byte is level 0, octant 1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "relumbre/base/huge_array.h"

namespace relumbre {

/// Of addresses of 61 bits.
inline constexpr int kMaxTraceLevels = 20;

inline constexpr std::uint8_t kRootRead = 1;
constexpr std::uint8_t pack_read(int level, unsigned octant) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(level) << 3 | octant);
}

/// Turns the bytes of reads back into addresses. Rays need not be told apart: each begins with the
/// root. Address: an unsigned type of 3 · levels - 2 bits at least.
template <class Address = std::uint64_t>
class PathDecoder {
 public:
  struct Read {
    unsigned level;
    Address address;
  };
  Read operator()(std::uint8_t read) {
    const unsigned level = read >> 3;
    const auto address = static_cast<Address>(last_[level] * 8 + (read & 7U));
    last_[level + 1] = address;
    return {level, address};
  }

 private:
  std::array<Address, 33> last_{};  ///< [level + 1]; 5 bits hold a level
};

/// Throws ValueError for what cannot be: pictures have 1 to kMaxSide pixels a side, and there are
/// 1 to kMaxTraceLevels levels.
struct TraceShape {
  static constexpr std::uint32_t kMaxSide = 65'536;
  std::uint32_t width = 0, height = 0;
  int levels = 0;  ///< 0 to levels-1 may be read

  [[nodiscard]] std::size_t pixels() const { return std::size_t{width} * height; }
  void check() const;
  friend bool operator==(const TraceShape&, const TraceShape&) = default;
};

/// Immutable; any number of threads may read it. One ray a pixel, pixels row by row.
class Trace {
 public:
  struct Parts {
    TraceShape shape;
    HugeArray<std::uint32_t> tasks;        ///< popped, of each pixel
    HugeArray<std::uint32_t> read_counts;  ///< of each pixel
    HugeArray<std::uint8_t> reads;         ///< of all pixels, one behind the other
  };

  /// Throws ValueError for a shape that cannot be, ShapeError for arrays that do not go together
  /// and, naming the pixel, for a read that does not follow from those before it. Threaded; about a
  /// nanosecond a read.
  explicit Trace(Parts parts);

  [[nodiscard]] const TraceShape& shape() const { return parts_.shape; }
  [[nodiscard]] std::span<const std::uint32_t> tasks() const { return parts_.tasks.span(); }
  [[nodiscard]] std::span<const std::uint32_t> read_counts() const {
    return parts_.read_counts.span();
  }
  [[nodiscard]] std::span<const std::uint8_t> reads() const { return parts_.reads.span(); }
  /// Of a row of pixels. `row` may be the height: then none, behind all others.
  [[nodiscard]] std::span<const std::uint8_t> reads_from_row(std::uint32_t row) const {
    return reads().subspan(row_begin_.data()[row]);
  }
  [[nodiscard]] std::span<const std::uint8_t> row_reads(std::uint32_t row) const {
    return reads_from_row(row).first(row_begin_.data()[row + 1] - row_begin_.data()[row]);
  }
  /// Memory held: 8 bytes a pixel and one a read.
  [[nodiscard]] std::size_t bytes() const;

 private:
  void check_reads() const;

  Parts parts_;
  HugeArray<std::size_t> row_begin_;  ///< height + 1
};

}  // namespace relumbre
