/// How a tile of a table learns the sums that lie before it in its row, or its column, of tiles.
#pragma once

#include <cstddef>
#include <cstdint>

#include "relumbre/cuda/tagged.cuh"

namespace relumbre::cuda {

/// One number a tile and place in it: its own sum, tagged `tag`, which the sum of it and all before
/// replaces, tagged tag + 1. A thread looks back for itself, in a chain of its own.
///
/// The sum before a tile is that before an earlier one, the nearest there is, plus all tiles' own
/// sums in between, from the far end to the near one. That is what the earlier tiles added in the
/// same order, so results do not depend on which one was found.
template <class T>
class SatChain {
 public:
  /// `words` are this tile's; the tile before has its own `stride` in front of them, and there are
  /// `before` such.
  __device__ SatChain(std::uint64_t* words, std::size_t stride, unsigned before, std::uint32_t tag)
      : words_(words), stride_(stride), before_(before), tag_(tag) {}

  /// Publishes the tile's own sum; returns the sum of all tiles before.
  __device__ T operator()(const T& own) const {
    if (before_ > 0) store_tagged(words_, own, tag_);
    const T sum = look_back();
    store_tagged(words_, static_cast<T>(sum + own), tag_ + 1);
    return sum;
  }

 private:
  /// A diagonal of tiles takes an H200 about a µs, and so does it to hand a number on: one or two
  /// tiles are on their way, and more while the first diagonals are. Wide sums have registers for 2
  /// beside those of a tile.
  static constexpr unsigned kReach = sizeof(T) == 8 ? 2 : 4;
  static constexpr unsigned kPauseNanoseconds = 40;

  __device__ T look_back() const {
    T sums[kReach] = {};
    std::uint32_t tags[kReach] = {};
    for (;;) {
#pragma unroll
      for (unsigned d = 0; d < kReach; ++d) poll(d, sums[d], tags[d]);
      unsigned nearest = kReach;
#pragma unroll
      for (unsigned d = kReach; d-- > 0;) {
        if (tags[d] == tag_ + 1) nearest = d;
        if (tags[d] == 0) nearest = kReach;  // nothing beyond it is of use
      }
      if (nearest < kReach) return forward(sums, nearest);
      __nanosleep(kPauseNanoseconds);
    }
  }

  __device__ void poll(unsigned d, T& sum, std::uint32_t& tag) const {
    if (d >= before_) {
      sum = T{}, tag = tag_ + 1;
    } else if (tag != tag_ + 1) {
      tag = load_tagged(words_ - (d + 1) * stride_, sum);
      if (tag != tag_ + 1 && tag != tag_) tag = 0;
    }
  }

  __device__ static T forward(const T (&sums)[kReach], unsigned nearest) {
    T sum{};
#pragma unroll
    for (unsigned d = kReach; d-- > 0;) {
      if (d == nearest) sum = sums[d];
      if (d < nearest) sum = static_cast<T>(sum + sums[d]);
    }
    return sum;
  }

  std::uint64_t* words_;
  std::size_t stride_;
  unsigned before_;
  std::uint32_t tag_;
};

}  // namespace relumbre::cuda
