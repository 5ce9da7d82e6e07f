/// The kernel of all scans on a GPU: one pass over memory, every element read once and written
/// once.
///
/// A block takes the next tile, in the order of tickets. A thread's elements, of which it loads and
/// stores kVector at once, lie as the warp's accesses want them:
///
///     tile │ warp 0 │ warp 1 │ …            a warp's part is contiguous
///     part │ row 0  │ row 1  │ … kRows      a row is one access of the warp, 512 bytes
///     row  │ lane 0 │ lane 1 │ … lane 31    a lane has kVector neighbours
///
/// So nothing is transposed through shared memory: a row is scanned by shuffles, of which an H200
/// has ten times as many as this takes. All rows' loads are under way before the first one is used.
///
/// Bytes in flight: 4.8 TB/s and about 1 µs of latency under load ask for 18 KB a multiprocessor in
/// loads, and as much again for each µs that tiles then wait for their predecessors. Tiles of 32 KB
/// in the registers of 256 threads, three or four of them at once, are 96 to 128 KB.
#pragma once

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/vectors.cuh"
#include "relumbre/scan/look_back_cuda.cuh"
#include "relumbre/scan/scan_kind.h"
#include "relumbre/scan/scan_scratch_cuda.h"

namespace relumbre::cuda::scan_detail {

inline constexpr unsigned kThreads = 256, kWarps = kThreads / kWarp;

/// What is scanned and where the results go:
///   Items                           what a thread keeps of kVector neighbours
///   load<kWhole>(first, count)      Items from `first` on, of which `count` exist; kWhole: all do
///   value(items, k)                 element k of them
///   store<kWhole>(first, count, results, items)   takes the results of those that exist
template <class Io>
struct Tile {
  using Items = typename Io::Items;
  using Value = typename Io::Value;
  /// 32 registers hold the items: 8 rows of four floats.
  static constexpr unsigned kFitting = 128 / sizeof(Items);
  static constexpr unsigned kRows = kFitting < 1 ? 1 : kFitting > 8 ? 8 : kFitting;
  static constexpr unsigned kRow = kWarp * Io::kVector, kPart = kRow * kRows;
  static constexpr std::size_t kSize = std::size_t{kPart} * kWarps;
  /// A multiprocessor runs at once: leaves 64, 80 or 128 registers a thread.
  static constexpr unsigned kBlocks = sizeof(Value) <= 4 ? 4 : sizeof(Value) <= 8 ? 3 : 2;

  static constexpr std::size_t count(std::size_t size) { return (size + kSize - 1) / kSize; }
};

template <class Io>
struct Shared {
  using Value = typename Io::Value;
  Value parts[kWarps];  ///< of each warp: the fold of its part, then the fold of all before it
  /// Of each thread: the fold of the part's elements before the row's. Registers are wanted for the
  /// look-back meanwhile.
  Value before[Tile<Io>::kRows][kThreads];
  Ticket ticket;
};

template <ScanKind kKind, Monoid M, class Io>
class TileScan {
 public:
  using Value = typename M::value_type;
  using Plan = Tile<Io>;
  using Rows = typename Io::Items[Plan::kRows];

  __device__ TileScan(const M& m, const Io& io, std::size_t size, Shared<Io>& shared)
      : m_(m), io_(io), size_(size), shared_(shared) {}

  template <bool kWhole>
  __device__ void run(unsigned tile, const LookBack<M>& look_back, Value* total) const {
    const unsigned place = warp() * Plan::kPart + lane() * Io::kVector;
    const Run of_thread = {tile * Plan::kSize + place,
                           kWhole ? 0 : less(size_ - tile * Plan::kSize, place)};
    Rows rows;
    const Value fold = load<kWhole>(of_thread, rows);
    if (lane() == 0) shared_.parts[warp()] = fold;
    __syncthreads();
    if (warp() == 0) fold_parts(tile, look_back, total);
    __syncthreads();
#pragma unroll
    for (unsigned r = 0; r < Plan::kRows; ++r) forget(rows[r]);
    store<kWhole>(of_thread, rows, shared_.parts[warp()]);
  }

 private:
  __device__ static unsigned lane() { return threadIdx.x % kWarp; }
  __device__ static unsigned warp() { return threadIdx.x / kWarp; }

  __device__ static unsigned less(std::size_t count, unsigned by) {
    return count > by ? static_cast<unsigned>(count) - by : 0;
  }

  /// A thread's first element, and how many of its tile exist from there on.
  struct Run {
    std::size_t first;
    unsigned count;
  };

  template <bool kWhole>
  __device__ Value value(const Rows& rows, unsigned row, unsigned k, const Run& run) const {
    if (kWhole || row * Plan::kRow + k < run.count) return io_.value(rows[row], k);
    return m_.identity();
  }

  /// The fold of the warp's part.
  template <bool kWhole>
  __device__ Value load(const Run& run, Rows& rows) const {
#pragma unroll
    for (unsigned r = 0; r < Plan::kRows; ++r)
      rows[r] =
          io_.template load<kWhole>(run.first + r * Plan::kRow, less(run.count, r * Plan::kRow));
    Value all = m_.identity();
#pragma unroll
    for (unsigned r = 0; r < Plan::kRows; ++r) {
      Value own = value<kWhole>(rows, r, 0, run);
#pragma unroll
      for (unsigned k = 1; k < Io::kVector; ++k) own = m_(own, value<kWhole>(rows, r, k, run));
      const Value up_to = warp_inclusive_scan(own, lane(), m_);
      const Value before = shuffle_up(up_to, 1);
      shared_.before[r][threadIdx.x] = lane() == 0 ? all : m_(all, before);
      all = m_(all, shuffle(up_to, kWarp - 1));
    }
    return all;
  }

  /// By the first warp: makes of each part's fold what lies before the part.
  __device__ void fold_parts(unsigned tile, const LookBack<M>& look_back, Value* total) const {
    const Value own = lane() < kWarps ? shared_.parts[lane()] : m_.identity();
    const Value up_to = warp_inclusive_scan(own, lane(), m_);
    const Value fold = shuffle(up_to, kWarps - 1), before = shuffle_up(up_to, 1);
    const Value before_tile = look_back(tile, fold, lane());
    if (lane() < kWarps)
      shared_.parts[lane()] = lane() == 0 ? before_tile : m_(before_tile, before);
    if (lane() == 0 && total != nullptr && tile == gridDim.x - 1) *total = m_(before_tile, fold);
  }

  template <bool kWhole>
  __device__ void store(const Run& run, const Rows& rows, const Value& before_part) const {
#pragma unroll
    for (unsigned r = 0; r < Plan::kRows; ++r) {
      Value up_to = m_(before_part, shared_.before[r][threadIdx.x]), results[Io::kVector];
#pragma unroll
      for (unsigned k = 0; k < Io::kVector; ++k) {
        if constexpr (kKind == ScanKind::kExclusive) results[k] = up_to;
        up_to = m_(up_to, value<kWhole>(rows, r, k, run));
        if constexpr (kKind == ScanKind::kInclusive) results[k] = up_to;
      }
      io_.template store<kWhole>(run.first + r * Plan::kRow, less(run.count, r * Plan::kRow),
                                 results, rows[r]);
    }
  }

  const M& m_;
  const Io& io_;
  std::size_t size_;
  Shared<Io>& shared_;
};

template <ScanKind kKind, Monoid M, class Io>
__global__ void __launch_bounds__(kThreads, Tile<Io>::kBlocks)
    scan_tiles(M m, Io io, std::size_t size, ScanScratch::View scratch,
               typename M::value_type* total) {
  auto& shared = shared_as<Shared<Io>>();
  if (threadIdx.x == 0) shared.ticket = take_ticket(scratch.counter, gridDim.x);
  __syncthreads();
  const Ticket ticket = shared.ticket;
  const LookBack<M> look_back(m, scratch.words, gridDim.x, ticket.tag);
  const TileScan<kKind, M, Io> scan(m, io, size, shared);
  if ((ticket.number + std::size_t{1}) * Tile<Io>::kSize <= size)
    scan.template run<true>(ticket.number, look_back, total);
  else
    scan.template run<false>(ticket.number, look_back, total);
}

/// Without elements there is only the total to be set.
template <ScanKind kKind, Monoid M, class Io>
void scan(const Io& io, std::size_t size, const M& m, ScanScratch& scratch, const Stream& stream,
          typename M::value_type* total) {
  if (size == 0 && total == nullptr) return;
  const std::size_t tiles = size == 0 ? 1 : Tile<Io>::count(size);
  const auto view = scratch.view(LookBack<M>::words(tiles), stream);
  launch(scan_tiles<kKind, M, Io>,
         {.blocks = static_cast<unsigned>(tiles),
          .threads = kThreads,
          .shared_bytes = sizeof(Shared<Io>)},
         stream, m, io, size, view, total);
}

/// An array into an array.
template <class In, class Out, Monoid M>
struct Arrays {
  using Value = typename M::value_type;
  static constexpr unsigned kVector = kPackOf<In, Out>;
  using Items = Pack<In, kVector>;

  const In* in;
  Out* out;
  bool aligned_in, aligned_out;

  Arrays(const In* from, Out* to)
      : in(from),
        out(to),
        aligned_in(is_aligned<kVector>(from)),
        aligned_out(is_aligned<kVector>(to)) {}

  template <bool kWhole>
  __device__ Items load(std::size_t first, unsigned count) const {
    if constexpr (kWhole) return load_pack<kVector>(in + first, aligned_in);
    return load_part<kVector>(in + first, count);
  }
  __device__ Value value(const Items& items, unsigned k) const {
    return static_cast<Value>(items.values[k]);
  }
  template <bool kWhole>
  __device__ void store(std::size_t first, unsigned count, const Value (&results)[kVector],
                        const Items&) const {
    Pack<Out, kVector> pack;
#pragma unroll
    for (unsigned k = 0; k < kVector; ++k) pack.values[k] = static_cast<Out>(results[k]);
    if constexpr (kWhole)
      store_pack(pack, out + first, aligned_out);
    else
      store_part(pack, out + first, count);
  }
};

}  // namespace relumbre::cuda::scan_detail
