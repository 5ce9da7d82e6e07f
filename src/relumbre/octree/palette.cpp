#include "relumbre/octree/palette.h"

#include <algorithm>

namespace relumbre {

namespace {

unsigned level(std::uint16_t bin, unsigned axis) { return bin >> (5 * (2 - axis)) & 31; }

}  // namespace

void Palette::count(const Srgb8& color) {
  Bin& bin = bins_[bin_of(color)];
  ++bin.count;
  for (std::size_t c = 0; c < 3; ++c) bin.sum[c] += color[c];
}

void Palette::choose(std::size_t size) {
  for (std::size_t b = 0; b < kBins; ++b)
    if (bins_[b].count > 0) order_.push_back(static_cast<std::uint16_t>(b));
  std::vector<Range> ranges;
  if (!order_.empty()) ranges.push_back({0, order_.size()});
  while (ranges.size() < size) {
    // The widest range, along its longest axis; single bins have no extent.
    std::size_t widest = 0;
    unsigned most = 0, axis = 0;
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      unsigned extent = 0;
      const unsigned along = longest_axis(ranges[r], extent);
      if (extent > most) widest = r, most = extent, axis = along;
    }
    if (most == 0) break;
    const std::size_t middle = split(ranges[widest], axis);
    ranges.push_back({middle, ranges[widest].last});
    ranges[widest].last = middle;
  }
  for (const Range& range : ranges) add_color(range);
}

unsigned Palette::longest_axis(const Range& range, unsigned& extent) const {
  unsigned longest = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    unsigned low = 31, high = 0;
    for (std::size_t i = range.first; i < range.last; ++i) {
      low = std::min(low, level(order_[i], axis));
      high = std::max(high, level(order_[i], axis));
    }
    if (high - low > extent) extent = high - low, longest = axis;
  }
  return longest;
}

/// At the median of the colours' counts; both sides keep a bin at least.
std::size_t Palette::split(const Range& range, unsigned axis) {
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(range.first);
  std::sort(begin, order_.begin() + static_cast<std::ptrdiff_t>(range.last),
            [axis](std::uint16_t a, std::uint16_t b) {
              return level(a, axis) != level(b, axis) ? level(a, axis) < level(b, axis) : a < b;
            });
  std::uint64_t all = 0, below = 0;
  for (std::size_t i = range.first; i < range.last; ++i) all += bins_[order_[i]].count;
  std::size_t middle = range.first;
  while (middle + 1 < range.last && 2 * below < all) below += bins_[order_[middle++]].count;
  return std::max(middle, range.first + 1);
}

void Palette::add_color(const Range& range) {
  std::uint64_t count = 0;
  std::array<std::uint64_t, 3> sum{};
  for (std::size_t i = range.first; i < range.last; ++i) {
    const Bin& bin = bins_[order_[i]];
    count += bin.count;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += bin.sum[c];
    index_[order_[i]] = static_cast<std::uint16_t>(colors_.size());
  }
  Srgb8 mean;
  for (std::size_t c = 0; c < 3; ++c)
    mean[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
  colors_.push_back(mean);
}

}  // namespace relumbre
