/// How a tile learns the fold of all tiles before it: a decoupled look-back (Merrill and Garland
/// 2016) that adds in one fixed order.
///
/// Tiles make groups of 32. Every tile publishes the fold of its own elements, and the last tile of
/// a group the fold of all elements up to there:
///
///     tiles   │ t0 t1 … t31 │ t32 t33 … t63 │ t64 …        each alone, as soon as it is loaded
///     groups              g0              g1               all up to the group's end
///
/// The fold before a tile is g ∘ (group) ∘ … ∘ (group) ∘ (the group's tiles before it), where g is
/// the nearest that is there already. Which one that is depends on timing, the result does not:
/// every g is the one before it ∘ (group), and a group is folded by one fixed tree. So
/// floating-point scans have the same bits always, which a look-back that adds whatever it meets
/// does not give.
///
/// How far one must look: at a rate of R tiles a second and a latency L from one block's store to
/// the other's use, the last R·L tiles' folds are on their way. An H200 reads 2.4 TB/s while it
/// writes as much, that is 73 tiles of 32 KB a µs, and L is about 1 µs. kReach = 4 groups, 97 to
/// 128 tiles, are looked at with one latency.
#pragma once

#include "relumbre/cuda/tagged.cuh"
#include "relumbre/cuda/warp.cuh"
#include "relumbre/scan/monoid.h"

namespace relumbre::cuda {

template <Monoid M>
class LookBack {
 public:
  using Value = typename M::value_type;

  static constexpr std::size_t words(std::size_t tiles) {
    return (tiles + tiles / kWarp) * kTaggedWords<Value>;
  }

  __device__ LookBack(const M& m, std::uint64_t* words, unsigned tiles, std::uint32_t tag)
      : m_(m),
        tiles_(words),
        groups_(words + std::size_t{tiles} * kTaggedWords<Value>),
        tag_(tag) {}

  /// By a whole warp: publishes the tile's own fold, and returns that of all tiles before it.
  __device__ Value operator()(unsigned tile, const Value& fold, unsigned lane) const {
    if (lane == 0) store_tagged(word(tiles_, tile), fold, tag_);
    const unsigned group = tile / kWarp, place = tile % kWarp;
    Found found = await(group, place, fold, lane);
    Value before = shuffle(found.start.value, found.nearest);
#pragma unroll
    for (unsigned b = kReach - 1; b-- > 0;)
      if (b < found.nearest) before = m_(before, fold_of_warp(found.earlier[b].value, lane));
    // Lanes from `place` on hold this tile and nothing.
    const Value own = warp_inclusive_scan(found.own.value, lane, m_);
    if (place == kWarp - 1 && lane == place)
      store_tagged(word(groups_, group), m_(before, own), tag_);
    return place == 0 ? before : m_(before, shuffle(own, place - 1));
  }

 private:
  static constexpr unsigned kReach = 4;
  static constexpr unsigned kPauseNanoseconds = 40;

  struct Awaited {
    Value value;
    bool is_there;
  };
  struct Found {
    Awaited own;                  ///< lane: a tile of this group
    Awaited earlier[kReach - 1];  ///< and of those before, nearest first
    Awaited start;                ///< lane b: of all up to the end of group − 1 − b
    unsigned nearest;             ///< b of the nearest start from which all is there
  };

  __device__ std::uint64_t* word(std::uint64_t* words, unsigned i) const {
    return words + std::size_t{i} * kTaggedWords<Value>;
  }
  __device__ void poll(Awaited& a, std::uint64_t* words, unsigned i) const {
    if (!a.is_there) a.is_there = load_tagged(word(words, i), a.value) == tag_;
  }
  __device__ Value fold_of_warp(const Value& value, unsigned lane) const {
    return shuffle(warp_inclusive_scan(value, lane, m_), kWarp - 1);
  }

  __device__ Found await(unsigned group, unsigned place, const Value& fold, unsigned lane) const {
    Found f;
    f.own = {lane == place ? fold : m_.identity(), lane >= place};
#pragma unroll
    for (unsigned b = 0; b + 1 < kReach; ++b) f.earlier[b] = {m_.identity(), b >= group};
    f.start = {m_.identity(), lane >= group};
    for (;;) {
      poll(f.own, tiles_, tile_of(group, lane));
#pragma unroll
      for (unsigned b = 0; b + 1 < kReach; ++b)
        poll(f.earlier[b], tiles_, tile_of(group - 1 - b, lane));
      if (lane < kReach) poll(f.start, groups_, group - 1 - lane);
      if (find_nearest(f)) return f;
      __nanosleep(kPauseNanoseconds);
    }
  }
  __device__ static unsigned tile_of(unsigned group, unsigned lane) { return group * kWarp + lane; }

  /// Whether enough is there.
  __device__ static bool find_nearest(Found& f) {
    const unsigned starts = __ballot_sync(kAllLanes, f.start.is_there ? 1 : 0);
    bool all = __all_sync(kAllLanes, f.own.is_there ? 1 : 0) != 0, found = false;
#pragma unroll
    for (unsigned b = 0; b < kReach; ++b) {
      if (all && !found && (starts >> b & 1) != 0) f.nearest = b, found = true;
      if (b + 1 < kReach) all = __all_sync(kAllLanes, f.earlier[b].is_there ? 1 : 0) != 0 && all;
    }
    return found;
  }

  const M& m_;
  std::uint64_t *tiles_, *groups_;
  std::uint32_t tag_;
};

}  // namespace relumbre::cuda
