#include "relumbre/archsim/trace.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/archsim/node_reads.h"
#include "relumbre/archsim/trace_testing.h"
#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {
namespace {

using namespace archsim_testing;

template <class T>
HugeArray<T> array_of(const std::vector<T>& values) {
  HugeArray<T> array(values.size());
  std::ranges::copy(values, array.data());
  return array;
}

/// Of one pixel.
Trace pixel(const std::vector<std::uint8_t>& reads, int levels) {
  return Trace({{1, 1, levels},
                array_of<std::uint32_t>({1}),
                array_of<std::uint32_t>({static_cast<std::uint32_t>(reads.size())}),
                array_of(reads)});
}

TEST(Trace, HasWhatWasRecorded) {
  for (const int levels : {1, 2, 5, kMaxTraceLevels}) {
    const TraceShape shape{13, 7, levels};
    const auto rays = random_rays(shape, 1);
    const Trace trace = record(shape, rays);
    std::size_t at = 0;
    PathDecoder decode;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(trace.tasks()[i], rays[i].tasks);
      ASSERT_EQ(trace.read_counts()[i], rays[i].reads.size());
      for (const Read& expected : rays[i].reads) {
        const auto read = decode(trace.reads()[at++]);
        ASSERT_EQ((Read{static_cast<int>(read.level), read.address}), expected);
      }
    }
    EXPECT_EQ(at, trace.reads().size());
  }
}

TEST(Trace, RowsFollowEachOther) {
  const Trace trace = random_trace({11, 5, 4}, 2);
  std::size_t sum = 0;
  for (std::uint32_t y = 0; y < 5; ++y) {
    EXPECT_EQ(trace.row_reads(y).data(), trace.reads().data() + sum);
    const auto counts = trace.read_counts().subspan(y * std::size_t{11}, 11);
    EXPECT_EQ(trace.row_reads(y).size(), std::accumulate(counts.begin(), counts.end(), 0U));
    sum += trace.row_reads(y).size();
  }
  EXPECT_EQ(sum, trace.reads().size());
}

TEST(Trace, RefusesShapesThatCannotBe) {
  EXPECT_THROW((TraceShape{0, 1, 1}.check()), ValueError);
  EXPECT_THROW((TraceShape{1, TraceShape::kMaxSide + 1, 1}.check()), ValueError);
  EXPECT_THROW((TraceShape{1, 1, 0}.check()), ValueError);
  EXPECT_THROW((TraceShape{1, 1, kMaxTraceLevels + 1}.check()), ValueError);
  EXPECT_THROW(Trace({{2, 1, 1}, array_of<std::uint32_t>({1}), array_of<std::uint32_t>({0}), {}}),
               ShapeError);
  EXPECT_THROW(Trace({{1, 1, 1}, array_of<std::uint32_t>({1}), array_of<std::uint32_t>({1}), {}}),
               ShapeError);
}

TEST(Trace, RefusesReadsThatDoNotFollow) {
  EXPECT_NO_THROW(pixel({}, 2));
  EXPECT_NO_THROW(pixel({kRootRead, pack_read(1, 0), kRootRead, pack_read(1, 7)}, 2));
  EXPECT_THROW(pixel({pack_read(0, 0)}, 2), ShapeError);
  EXPECT_THROW(pixel({pack_read(0, 2)}, 2), ShapeError);
  EXPECT_THROW(pixel({pack_read(1, 0)}, 2), ShapeError);
  EXPECT_THROW(pixel({kRootRead, pack_read(2, 0)}, 3), ShapeError);
  EXPECT_THROW(pixel({kRootRead, pack_read(1, 0), pack_read(2, 0)}, 2), ShapeError);
}

TEST(TraceRecorder, RefusesReadsWhoseParentWasNotTheLast) {
  TraceRecorder recorder({1, 1, 3});
  TraceRecorder::Row row = recorder.row(0);
  EXPECT_THROW(row.read(1, 0), ValueError);  // before the ray
  row.begin_ray();
  EXPECT_THROW(row.read(1, 1), ValueError);
  EXPECT_THROW(row.read(2, 0), ValueError);
  EXPECT_THROW(row.read(0, 0), ValueError);
  EXPECT_THROW(row.read(8, 1), ValueError);  // the root was not read
  EXPECT_THROW(row.read(3, 1), ValueError);
  row.read(1, 0);
  row.read(8, 1);
  row.read(9, 1);
  EXPECT_THROW(row.read(64, 2), ValueError);  // of 8, but 9 was the last
  row.read(72, 2);
  EXPECT_THROW(row.read(576, 3), ValueError);  // there is no level 3
  EXPECT_THROW(row.read(1, -1), ValueError);
}

TEST(TraceRecorder, CountsTheRaysOfARow) {
  TraceRecorder recorder({2, 1, 3});
  EXPECT_THROW(recorder.row(1), ValueError);
  TraceRecorder::Row row = recorder.row(0);
  row.begin_ray();
  EXPECT_THROW(row.finish(), ValueError);
  row.begin_ray();
  EXPECT_THROW(row.begin_ray(), ValueError);
  EXPECT_NO_THROW(row.finish());
}

TEST(TraceRecorder, ThreadsDoNotChangeTheTrace) {
  const TraceShape shape{5, 64, 6};
  const auto rays = random_rays(shape, 3);
  const Trace expected = record(shape, rays);
  TraceRecorder recorder(shape);
  parallel_for(0, shape.height, 1, [&](std::size_t y) {
    TraceRecorder::Row row = recorder.row(static_cast<std::uint32_t>(y));
    for (std::size_t x = 0; x < shape.width; ++x) {
      row.begin_ray();
      for (const Read& read : rays[y * shape.width + x].reads) row.read(read.address, read.level);
    }
    row.finish();
  });
  const Trace trace = recorder.finish();
  EXPECT_TRUE(std::ranges::equal(trace.reads(), expected.reads()));
  EXPECT_TRUE(std::ranges::equal(trace.read_counts(), expected.read_counts()));
}

TEST(NodeReads, AreCountedByAddress) {
  const TraceShape shape{31, 17, 7};
  const auto rays = random_rays(shape, 4);
  std::map<std::uint64_t, NodeReads> expected;
  for (const RayReads& ray : rays)
    for (const Read& read : ray.reads) {
      NodeReads& node = expected[read.address];
      node.level = read.level, node.address = read.address, ++node.reads;
    }
  const auto counted = count_node_reads(record(shape, rays));
  ASSERT_EQ(counted.size(), expected.size());
  auto at = counted.begin();
  for (const auto& [address, node] : expected) EXPECT_EQ(*at++, node);
}

TEST(NodeReads, ThereAreNoneInAnEmptyPicture) {
  EXPECT_TRUE(count_node_reads(record({1, 1, 3}, {RayReads{}})).empty());
}

}  // namespace
}  // namespace relumbre
