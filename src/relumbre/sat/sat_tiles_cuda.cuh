/// The kernel that builds summed-area tables on a GPU: every pixel is read once, every sum written
/// once, and in between a tile lives in its block's registers.
///
/// Tiles are 64 rows of 1 KB of floats (32 rows for sums of 8 bytes), begun by diagonals. A tile
/// needs
///
///     │ above │  the table's row above it: a chain down each column of tiles, one number a column
///  ───┼───────┤
///  l  │       │  the image's sums left of it: a chain along each row of tiles, one number a row
///  e  │ tile  │
///  f  │       │  t(x, y) = above(x) + Σ over the tile's rows down to y of (left + the row's sum so
///  t  │       │            far)
///
/// and hands on both. Both chains are looked back along (Merrill and Garland 2016), which keeps
/// tiles from waiting in line through the whole image; that the sums themselves are handed on
/// instead of the table's corners is the block-wise carry of Nehab et al. 2011, done in one
/// pass as in Emoto et al. 2018. Strips of columns, the CPU's way, would need as many strips as
/// there are multiprocessors, and each would begin a µs after the one to its left.
///
/// What a 4K image of RGBA floats costs besides its 64 KB a tile in and out: 2 · 256 numbers a
/// tile, written twice and read a few times, which the second-level cache keeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/vectors.cuh"
#include "relumbre/cuda/warp.cuh"
#include "relumbre/sat/sat_chain_cuda.cuh"
#include "relumbre/sat/sat_summands.h"
#include "relumbre/sat/tile_order_cuda.cuh"
#include "relumbre/scan/monoid.h"
#include "relumbre/scan/scan_scratch_cuda.h"

namespace relumbre::cuda::sat_detail {

/// A warp has kRows rows; a lane kValues neighbouring values of each, which are whole pixels.
template <class T, unsigned kChannels>
struct TileShape {
  static constexpr unsigned kValues = kChannels == 3 ? 3 : 4, kPixels = kValues / kChannels;
  static constexpr unsigned kRows = sizeof(T) == 8 ? 4 : 8;  ///< 32 registers of sums
  static constexpr unsigned kAcross = 2, kDown = 8;          ///< warps
  static constexpr unsigned kThreads = kAcross * kDown * kWarp;
  static constexpr unsigned kSegment = kWarp * kValues;   ///< values of a warp's row
  static constexpr unsigned kWidth = kAcross * kSegment;  ///< values
  static constexpr unsigned kWidthPixels = kWidth / kChannels, kHeight = kDown * kRows;
  static constexpr unsigned kSide = kHeight * kChannels;  ///< numbers handed on to the right
  static constexpr std::size_t kWords = std::size_t{kSide + kWidth} * kTaggedWords<T>;
};

/// How the tiles of an image lie.
struct TileGrid {
  std::uint32_t rows, columns;
};

template <class In, class T>
struct Build {
  const In* pixels;
  SatLayout layout;
  SatSummands<In> summands;
  T* table;
  TileGrid grid;
  bool aligned;  ///< every lane's pixels begin at a Pack's address
  unsigned long long* first_outside;
};

/// Integers as they are, and reals as SatSummands says; `inside` becomes false of what is refused.
template <class In, class T>
__device__ __forceinline__ T summand(In value, unsigned channel, const SatSummands<In>& how,
                                     bool& inside) {
  if constexpr (std::is_same_v<T, float>) {
    return static_cast<float>(value) - how.mean[channel];
  } else if constexpr (std::is_same_v<T, double>) {
    return static_cast<double>(value);
  } else {
    if (!(value >= how.lowest && value <= how.highest)) return inside = false, T{};
    if constexpr (std::is_integral_v<In>)
      return static_cast<T>(value);
    else if constexpr (sizeof(T) == 4)
      return static_cast<T>(__float2int_rn(value * static_cast<float>(how.scale)));
    else
      return static_cast<T>(__double2ll_rn(static_cast<double>(value) * how.scale));
  }
}

template <class T, unsigned kChannels>
struct Shared {
  using Shape = TileShape<T, kChannels>;
  /// Of each row and channel: the sum of a warp's segment, then that of all that lies left of it.
  T left[Shape::kAcross][Shape::kSide];
  /// Of each column of values: the sum of a warp's rows, then the table above them.
  alignas(16) T above[Shape::kDown][Shape::kWidth];
  Ticket ticket;
};

template <class In, class T, unsigned kChannels>
class TileBuild {
 public:
  using Shape = TileShape<T, kChannels>;

  __device__ TileBuild(const Build<In, T>& build, std::uint64_t* words, std::uint32_t tag,
                       const TilePlace& tile, Shared<T, kChannels>& shared)
      : build_(build), words_(words), tag_(tag), tile_(tile), shared_(shared) {}

  __device__ void run() const {
    T sums[Shape::kRows][Shape::kValues];
    load(sums);
    sum_rows(sums);
    __syncthreads();
    learn_left();
    __syncthreads();
    sum_columns(sums);
    __syncthreads();
    learn_above();
    __syncthreads();
    store(sums);
    write_zeros();
  }

 private:
  using Sums = T[Shape::kRows][Shape::kValues];
  using Packs = Pack<In, Shape::kValues>[Shape::kRows];

  __device__ static unsigned lane() { return threadIdx.x % kWarp; }
  __device__ static unsigned across() { return threadIdx.x / kWarp % Shape::kAcross; }
  __device__ static unsigned down() { return threadIdx.x / kWarp / Shape::kAcross; }
  /// Of the thread's first value: in the tile, and its pixel in the image.
  __device__ static unsigned column() {
    return across() * Shape::kSegment + lane() * Shape::kValues;
  }
  __device__ std::size_t x() const {
    return std::size_t{tile_.column} * Shape::kWidthPixels + column() / kChannels;
  }
  __device__ std::size_t y() const { return std::size_t{tile_.row} * Shape::kHeight; }
  __device__ static unsigned row(unsigned r) { return down() * Shape::kRows + r; }

  /// Summands; 0 beyond the image.
  __device__ void load(Sums& sums) const {
    const std::size_t width = build_.layout.width, left = x() < width ? width - x() : 0;
    const unsigned count =
        left < Shape::kPixels ? static_cast<unsigned>(left) * kChannels : Shape::kValues;
    bool inside = true;
    Packs packs;
    load(count, packs);
#pragma unroll
    for (unsigned r = 0; r < Shape::kRows; ++r) {
      const bool in_image = y() + row(r) < build_.layout.height;
#pragma unroll
      for (unsigned k = 0; k < Shape::kValues; ++k)
        sums[r][k] = in_image && k < count ? summand<In, T>(packs[r].values[k], k % kChannels,
                                                            build_.summands, inside)
                                           : T{};
    }
    if (!inside) report(count);
  }
  /// All rows' loads are under way before the first one is used.
  __device__ void load(unsigned count, Packs& packs) const {
    const bool whole =
        (tile_.column + 1) * std::size_t{Shape::kWidthPixels} <= build_.layout.width &&
        y() + Shape::kHeight <= build_.layout.height;
    if (whole && build_.aligned) {
#pragma unroll
      for (unsigned r = 0; r < Shape::kRows; ++r)
        packs[r] = load_pack<Shape::kValues>(build_.pixels + first_value(r), true);
    } else {
#pragma unroll
      for (unsigned r = 0; r < Shape::kRows; ++r)
        packs[r] = load_part<Shape::kValues>(build_.pixels + first_value(r),
                                             y() + row(r) < build_.layout.height ? count : 0);
    }
  }
  __device__ std::size_t first_value(unsigned r) const {
    return ((y() + row(r)) * build_.layout.width + x()) * kChannels;
  }
  /// Reads the thread's values again to find those that are refused.
  __device__ void report(unsigned count) const {
    for (unsigned r = 0; r < Shape::kRows && y() + row(r) < build_.layout.height; ++r) {
      for (unsigned k = 0; k < count; ++k) {
        bool inside = true;
        const std::size_t at = first_value(r) + k;
        summand<In, T>(build_.pixels[at], k % kChannels, build_.summands, inside);
        if (!inside) atomicMin(build_.first_outside, static_cast<unsigned long long>(at));
      }
    }
  }

  /// Makes of each row the sums from the segment's beginning.
  __device__ void sum_rows(Sums& sums) const {
#pragma unroll
    for (unsigned r = 0; r < Shape::kRows; ++r) {
#pragma unroll
      for (unsigned k = kChannels; k < Shape::kValues; ++k)
        sums[r][k] = static_cast<T>(sums[r][k] + sums[r][k - kChannels]);
#pragma unroll
      for (unsigned c = 0; c < kChannels; ++c) {
        constexpr unsigned kLast = Shape::kValues - kChannels;
        const T up_to = warp_inclusive_scan(sums[r][kLast + c], lane(), Plus<T>{});
        if (lane() == kWarp - 1) shared_.left[across()][row(r) * kChannels + c] = up_to;
        if constexpr (Shape::kPixels == 1) {
          sums[r][c] = up_to;
        } else {
          const T before = shuffle_up(up_to, 1);
          if (lane() == 0) continue;
#pragma unroll
          for (unsigned k = c; k < Shape::kValues; k += kChannels)
            sums[r][k] = static_cast<T>(before + sums[r][k]);
        }
      }
    }
  }

  __device__ void learn_left() const {
    const unsigned i = threadIdx.x;
    if (i >= Shape::kSide) return;
    T all{};
    for (unsigned a = 0; a < Shape::kAcross; ++a) all = static_cast<T>(all + shared_.left[a][i]);
    const std::size_t stride = std::size_t{Shape::kSide} * kTaggedWords<T>;
    const std::size_t tile = std::size_t{tile_.row} * build_.grid.columns + tile_.column;
    const SatChain<T> chain(words_ + tile * stride + i * kTaggedWords<T>, stride, tile_.column,
                            tag_);
    T before = chain(all);
    for (unsigned a = 0; a < Shape::kAcross; ++a) {
      const T own = shared_.left[a][i];
      shared_.left[a][i] = before;
      before = static_cast<T>(before + own);
    }
  }

  /// Makes of each value the sum of the warp's rows down to it, from the image's left edge.
  __device__ void sum_columns(Sums& sums) const {
    Pack<T, Shape::kValues> all{};
#pragma unroll
    for (unsigned r = 0; r < Shape::kRows; ++r) {
#pragma unroll
      for (unsigned k = 0; k < Shape::kValues; ++k) {
        const T left = shared_.left[across()][row(r) * kChannels + k % kChannels];
        all.values[k] = static_cast<T>(all.values[k] + static_cast<T>(left + sums[r][k]));
        sums[r][k] = all.values[k];
      }
    }
    store_pack(all, &shared_.above[down()][column()], true);
  }

  __device__ void learn_above() const {
    const unsigned i = threadIdx.x;
    if (i >= Shape::kWidth) return;
    T all{};
    for (unsigned d = 0; d < Shape::kDown; ++d) all = static_cast<T>(all + shared_.above[d][i]);
    const std::size_t stride = std::size_t{Shape::kWidth} * kTaggedWords<T>;
    const std::size_t tile = std::size_t{tile_.column} * build_.grid.rows + tile_.row;
    std::uint64_t* const chains = words_ + std::size_t{gridDim.x} * Shape::kSide * kTaggedWords<T>;
    const SatChain<T> chain(chains + tile * stride + i * kTaggedWords<T>, stride, tile_.row, tag_);
    T before = chain(all);
    for (unsigned d = 0; d < Shape::kDown; ++d) {
      const T own = shared_.above[d][i];
      shared_.above[d][i] = before;
      before = static_cast<T>(before + own);
    }
  }

  /// A row of the table has room for whole groups of pixels (SatLayout), so a lane whose first
  /// pixel is in the image may write all of them.
  __device__ void store(const Sums& sums) const {
    if (x() >= build_.layout.width) return;
    const auto above = load_pack<Shape::kValues>(&shared_.above[down()][column()], true);
#pragma unroll
    for (unsigned r = 0; r < Shape::kRows; ++r) {
      if (y() + row(r) >= build_.layout.height) break;
      Pack<T, Shape::kValues> result;
#pragma unroll
      for (unsigned k = 0; k < Shape::kValues; ++k)
        result.values[k] = static_cast<T>(above.values[k] + sums[r][k]);
      store_pack(result, build_.table + build_.layout.at(x() + 1, y() + row(r) + 1), true);
    }
  }

  /// The table's row 0 and column 0, by the tiles beside them.
  __device__ void write_zeros() const {
    const SatLayout& layout = build_.layout;
    const std::size_t first = std::size_t{tile_.column} * Shape::kWidthPixels;
    if (tile_.row == 0)
      for (unsigned i = threadIdx.x; i < Shape::kWidth; i += Shape::kThreads)
        if (first + i / kChannels < layout.width) build_.table[layout.at(first + 1, 0) + i] = T{};
    if (tile_.column > 0) return;
    for (unsigned i = threadIdx.x; i < Shape::kSide; i += Shape::kThreads)
      if (y() + i / kChannels < layout.height)
        build_.table[layout.at(0, y() + i / kChannels + 1) + i % kChannels] = T{};
    if (tile_.row == 0 && threadIdx.x < kChannels)
      build_.table[layout.at(0, 0) + threadIdx.x] = T{};
  }

  const Build<In, T>& build_;
  std::uint64_t* words_;
  std::uint32_t tag_;
  TilePlace tile_;
  Shared<T, kChannels>& shared_;
};

template <class In, class T, unsigned kChannels>
__global__ void __launch_bounds__(TileShape<T, kChannels>::kThreads, 2)
    build_tiles(Build<In, T> build, ScanScratch::View scratch) {
  auto& shared = shared_as<Shared<T, kChannels>>();
  if (threadIdx.x == 0) shared.ticket = take_ticket(scratch.counter, gridDim.x);
  __syncthreads();
  const Ticket ticket = shared.ticket;
  const TilePlace tile = tile_by_diagonals(ticket.number, build.grid.rows, build.grid.columns);
  TileBuild<In, T, kChannels>(build, scratch.words, ticket.tag, tile, shared).run();
}

template <class In, class T, unsigned kChannels>
void build_table(Build<In, T> build, ScanScratch& scratch, const Stream& stream) {
  using Shape = TileShape<T, kChannels>;
  const SatLayout& layout = build.layout;
  const auto parts = [](std::size_t whole, std::size_t part) {
    return static_cast<std::uint32_t>((whole + part - 1) / part);
  };
  build.grid = {parts(layout.height, Shape::kHeight), parts(layout.width, Shape::kWidthPixels)};
  build.aligned =
      is_aligned<Shape::kValues>(build.pixels) && layout.width * kChannels % Shape::kValues == 0;
  const std::size_t tiles = std::size_t{build.grid.rows} * build.grid.columns;
  const auto view = scratch.view(tiles * Shape::kWords, stream);
  launch(build_tiles<In, T, kChannels>,
         {.blocks = static_cast<unsigned>(tiles),
          .threads = Shape::kThreads,
          .shared_bytes = sizeof(Shared<T, kChannels>)},
         stream, build, view);
}

}  // namespace relumbre::cuda::sat_detail
