#include "relumbre/archsim/trace.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// Whether each read's parent was read before: levels begin with the root and deepen one by one.
bool is_path(std::span<const std::uint8_t> ray, int levels) {
  int reached = 0;  // levels whose last address is known
  bool good = true;
  for (const std::uint8_t read : ray) {
    const int level = read >> 3;
    good &= level <= reached && (level > 0 || read == kRootRead);
    reached = std::max(reached, level + 1);
  }
  return good && reached <= levels;
}

}  // namespace

void TraceShape::check() const {
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide)
    throw ValueError(
        fmt::format("a trace of {} x {} pixels: sides have 1 to {}", width, height, kMaxSide));
  if (levels < 1 || levels > kMaxTraceLevels)
    throw ValueError(
        fmt::format("a trace of {} levels: there must be 1 to {}", levels, kMaxTraceLevels));
}

Trace::Trace(Parts parts) : parts_(std::move(parts)) {
  const TraceShape& shape = parts_.shape;
  shape.check();
  if (parts_.tasks.size() != shape.pixels() || parts_.read_counts.size() != shape.pixels())
    throw ShapeError(fmt::format("a trace of {} x {} pixels has counts of {} and {}", shape.width,
                                 shape.height, parts_.tasks.size(), parts_.read_counts.size()));
  row_begin_ = HugeArray<std::size_t>(std::size_t{shape.height} + 1);
  row_begin_.data()[0] = 0;
  for (std::size_t y = 0; y < shape.height; ++y) {
    const auto row = read_counts().subspan(y * shape.width, shape.width);
    row_begin_.data()[y + 1] = std::accumulate(row.begin(), row.end(), row_begin_.data()[y]);
  }
  if (row_begin_.data()[shape.height] != parts_.reads.size())
    throw ShapeError(fmt::format("a trace of {} reads says that it has {}", parts_.reads.size(),
                                 row_begin_.data()[shape.height]));
  check_reads();
}

std::size_t Trace::bytes() const {
  return parts_.reads.size() + (parts_.tasks.size() + parts_.read_counts.size()) * 4 +
         row_begin_.size() * sizeof(std::size_t);
}

void Trace::check_reads() const {
  const TraceShape& shape = parts_.shape;
  parallel_for(0, shape.height, 8, [&](std::size_t y) {
    auto rest = row_reads(static_cast<std::uint32_t>(y));
    for (std::size_t x = 0; x < shape.width; ++x) {
      const std::size_t count = read_counts()[y * shape.width + x];
      if (!is_path(rest.first(count), shape.levels))
        throw ShapeError(fmt::format("the reads of pixel ({}, {}) do not follow each other", x, y));
      rest = rest.subspan(count);
    }
  });
}

}  // namespace relumbre
