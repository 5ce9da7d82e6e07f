#include <cmath>
#include <queue>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/grouping.h"

namespace relumbre {
namespace {

/// Patches a side from which on all patches are cut alike (216 = 6 · 36 in the paper).
constexpr std::size_t kPatchesPerSide = 6;

/// Times that `from` must be multiplied by 4 to be `to`, or -1.
int quadruplings(std::size_t from, std::size_t to) {
  int count = 0;
  for (; from < to; from *= 4) ++count;
  return from == to ? count : -1;
}

std::size_t nearest_patches(std::size_t sides, std::size_t asked) {
  return asked <= sides ? sides : sides + (asked - sides + 1) / 3 * 3;
}

std::size_t nearest_elements(std::size_t patches, std::size_t asked) {
  const double levels = std::log2(static_cast<double>(asked) / static_cast<double>(patches)) / 2;
  return patches << 2 * std::max(0L, std::lround(levels));
}

void check(const FacetForest& forest, const TessellationConfig& config) {
  const std::size_t sides = forest.sides(), k = config.patches, n = config.elements;
  if (k < sides || (k - sides) % 3 != 0) {
    throw ValueError(fmt::format(
        "patches: {} is not {} sides plus a multiple of 3, as 4-way cuts need; the nearest is {}",
        k, sides, nearest_patches(sides, k)));
  }
  if (quadruplings(k, n) < 0) {
    throw ValueError(fmt::format(
        "elements: {} is not {} patches times a power of 4, as 4-way cuts need; the nearest is {}",
        n, k, nearest_elements(k, n)));
  }
}

/// The number of patches that is reached by cutting the largest.
std::size_t irregular_patches(std::size_t sides, std::size_t patches) {
  while (patches % 4 == 0 && patches / 4 >= kPatchesPerSide * sides) patches /= 4;
  return patches;
}

std::uint32_t cut_or_throw(FacetForest& forest, std::uint32_t cell) {
  const auto first = forest.cut(cell);
  if (first) return *first;
  throw ValueError(
      fmt::format("mesh: triangle {} is too small or thin to be cut again", forest[cell].side / 2));
}

void cut_largest(FacetForest& forest, std::size_t patches) {
  const auto smaller = [&](std::uint32_t a, std::uint32_t b) {
    return forest[a].area != forest[b].area ? forest[a].area < forest[b].area : a > b;
  };
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, decltype(smaller)> queue(smaller);
  for (std::uint32_t side = 0; side < forest.sides(); ++side) queue.push(side);
  while (queue.size() < patches) {
    const std::uint32_t first = cut_or_throw(forest, queue.top());
    queue.pop();
    for (std::uint32_t child = first; child < first + 4; ++child) queue.push(child);
  }
}

void cut_all(FacetForest& forest, int times) {
  const auto last = static_cast<std::uint32_t>(forest.size());
  for (std::uint32_t cell = 0; times > 0 && cell < last; ++cell) {
    if (forest[cell].children == 0) cut_or_throw(forest, cell);
  }
  if (times > 0) cut_all(forest, times - 1);
}

std::vector<std::uint32_t> all_leaves(const FacetForest& forest) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t side = 0; side < forest.sides(); ++side) forest.append_leaves(side, leaves);
  return leaves;
}

/// 0, step, 2 step, ..., count · step.
std::vector<std::uint32_t> even_offsets(std::size_t count, std::size_t step) {
  std::vector<std::uint32_t> offsets(count + 1);
  for (std::size_t i = 0; i <= count; ++i) offsets[i] = static_cast<std::uint32_t>(i * step);
  return offsets;
}

}  // namespace

Grouping group_by_hierarchy(FacetForest& forest, const TessellationConfig& config) {
  check(forest, config);
  const std::size_t k = config.patches, n = config.elements;
  const std::size_t irregular = irregular_patches(forest.sides(), k);
  cut_largest(forest, irregular);
  // Cutting every patch, and then every element, keeps the descendants of a patch together in depth
  // first order: n/k of them each.
  cut_all(forest, quadruplings(irregular, n));
  return {all_leaves(forest), even_offsets(n, 1), even_offsets(k, n / k)};
}

}  // namespace relumbre
