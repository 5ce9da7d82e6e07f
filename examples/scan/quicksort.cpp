// Quicksort without recursion: in each round all segments are split at once, by segmented scans
// (Blelloch 1990, §1.5). Its twin is std::sort.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/segmented.h"

namespace {

using Keys = std::vector<std::int32_t>;
using Flags = std::vector<std::uint8_t>;
using Counts = std::vector<std::uint32_t>;

/// Left operand, unless there is none: under a segmented scan, the head's value for its segment.
struct First {
  using value_type = std::pair<bool, std::int32_t>;
  [[nodiscard]] value_type identity() const { return {false, 0}; }
  value_type operator()(const value_type& a, const value_type& b) const { return a.first ? a : b; }
};

/// In every segment, its first key at every place.
Keys pivots(const Keys& keys, const Flags& heads) {
  std::vector<First::value_type> values(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) values[i] = {true, keys[i]};
  relumbre::segmented_scan(values, heads, values, First());
  Keys pivot(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) pivot[i] = values[i].second;
  return pivot;
}

/// Below, at or above its pivot: 0, 1, 2.
Flags classes(const Keys& keys, const Keys& pivot) {
  Flags result(keys.size());
  relumbre::parallel_for(0, keys.size(), 1 << 14, [&](std::size_t i) {
    result[i] = static_cast<std::uint8_t>(keys[i] < pivot[i] ? 0 : keys[i] == pivot[i] ? 1 : 2);
  });
  return result;
}

/// How many of class c come before each place in its segment.
Counts before(const Flags& kind, const Flags& heads, std::uint8_t c) {
  Counts count(kind.size());
  for (std::size_t i = 0; i < kind.size(); ++i) count[i] = kind[i] == c ? 1 : 0;
  relumbre::segmented_scan(count, heads, count, relumbre::Plus<std::uint32_t>(),
                           relumbre::ScanKind::kExclusive);
  return count;
}

/// Splits every segment in three. Returns false where all were of one class already.
bool split(Keys& keys, Flags& heads) {
  const Flags kind = classes(keys, pivots(keys, heads));
  const Counts rank[3] = {before(kind, heads, 0), before(kind, heads, 1), before(kind, heads, 2)};
  Keys sorted(keys.size());
  Flags new_heads = heads;
  bool changed = false;
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    for (last = first + 1; last < keys.size() && !heads[last]; ++last) {
    }
    std::size_t start[4] = {first, 0, 0, last};
    for (int c = 0; c < 2; ++c)
      start[c + 1] = start[c] + rank[c][last - 1] + (kind[last - 1] == c ? 1 : 0);
    for (std::size_t i = first; i < last; ++i) sorted[start[kind[i]] + rank[kind[i]][i]] = keys[i];
    for (int c = 1; c < 3; ++c) {
      if (start[c] == last || start[c] == first) continue;
      new_heads[start[c]] = 1;
      changed = true;
    }
  }
  keys = std::move(sorted);
  heads = std::move(new_heads);
  return changed;
}

void quicksort(Keys& keys) {
  Flags heads(keys.size());
  if (keys.empty()) return;
  heads[0] = 1;
  while (split(keys, heads)) {
  }
}

}  // namespace

int main() {
  std::mt19937 random(1);
  for (const std::size_t size : {0UL, 1UL, 2UL, 3UL, 100UL, 50'021UL}) {
    for (const std::int32_t range : {1, 10, 2'000'000'000}) {
      std::uniform_int_distribution<std::int32_t> key(-range, range);
      Keys keys(size);
      for (auto& k : keys) k = key(random);
      Keys expected = keys;
      std::sort(expected.begin(), expected.end());
      quicksort(keys);
      if (keys != expected) {
        std::printf("quicksort: wrong for %zu keys in ±%d\n", size, range);
        return 1;
      }
    }
  }
  std::puts("quicksort: as std::sort");
}
