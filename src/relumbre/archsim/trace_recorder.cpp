#include "relumbre/archsim/trace_recorder.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

const TraceShape& checked(const TraceShape& shape) {
  shape.check();
  return shape;
}

HugeArray<std::uint32_t> zeros(std::size_t count) {
  HugeArray<std::uint32_t> values(count);
  std::ranges::fill(values.span(), 0U);
  return values;
}

}  // namespace

TraceRecorder::TraceRecorder(const TraceShape& shape)
    : shape_(checked(shape)),
      tasks_(zeros(shape.pixels())),
      read_counts_(zeros(shape.pixels())),
      rows_(shape.height) {}

TraceRecorder::Row TraceRecorder::row(std::uint32_t y) {
  if (y >= shape_.height)
    throw ValueError(fmt::format("row {} of a trace of {} rows", y, shape_.height));
  return {*this, y};
}

Trace TraceRecorder::finish() {
  std::vector<std::size_t> begin(rows_.size() + 1);
  for (std::size_t y = 0; y < rows_.size(); ++y) begin[y + 1] = begin[y] + rows_[y].size();
  HugeArray<std::uint8_t> reads(begin.back());
  parallel_for(0, rows_.size(), 8, [&](std::size_t y) {
    std::ranges::copy(rows_[y], reads.data() + begin[y]);
    std::vector<std::uint8_t>().swap(rows_[y]);  // two copies of everything are never there
  });
  return Trace({shape_, std::move(tasks_), std::move(read_counts_), std::move(reads)});
}

TraceRecorder::Row::Row(TraceRecorder& recorder, std::uint32_t y) : recorder_(recorder), y_(y) {}

void TraceRecorder::Row::begin_ray() {
  const TraceShape& shape = recorder_.shape_;
  if (begun_ == shape.width)
    throw ValueError(fmt::format("row {} of a trace has more rays than {} pixels", y_, begun_));
  const std::size_t pixel = std::size_t{y_} * shape.width + begun_++;
  tasks_ = recorder_.tasks_.data() + pixel;
  read_counts_ = recorder_.read_counts_.data() + pixel;
  levels_ = static_cast<std::size_t>(shape.levels);
  last_.fill(~std::uint64_t{0});
  last_[0] = 0;
}

void TraceRecorder::Row::finish() {
  if (begun_ != recorder_.shape_.width)
    throw ValueError(fmt::format("row {} of a trace has {} rays instead of {}", y_, begun_,
                                 recorder_.shape_.width));
  reads_.shrink_to_fit();
  recorder_.rows_[y_] = std::move(reads_);
}

void TraceRecorder::Row::refuse(std::uint64_t address, int level) const {
  throw ValueError(fmt::format(
      "pixel ({}, {}): a read of address {:#x} at level {}, whose parent was not the last read one "
      "level up",
      begun_ == 0 ? 0 : begun_ - 1, y_, address, level));
}

}  // namespace relumbre
