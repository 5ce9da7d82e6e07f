#include "relumbre/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

constexpr std::size_t kHuge = std::numeric_limits<std::size_t>::max();

TEST(Parallel, ChunksCoverTheRangeOnce) {
  for (const std::size_t size : {0UL, 1UL, 2UL, 7UL, 64UL, 1009UL}) {
    for (const std::size_t grain : {0UL, 1UL, 3UL, 64UL, 1009UL, 5000UL, kHuge}) {
      constexpr std::size_t begin = 13;
      std::vector<std::atomic<int>> visits(size);
      parallel_chunks(begin, begin + size, grain, [&](std::size_t first, std::size_t last) {
        EXPECT_LT(first, last);
        EXPECT_LE(last - first, std::max<std::size_t>(grain, 1));
        for (std::size_t i = first; i < last; ++i) ++visits[i - begin];
      });
      for (const auto& count : visits) EXPECT_EQ(count, 1) << size << " in chunks of " << grain;
    }
  }
}

TEST(Parallel, RangeMayEndAtTheLargestIndex) {
  std::atomic<std::size_t> count = 0;
  parallel_for(kHuge - 10, kHuge, 3, [&](std::size_t) { ++count; });
  EXPECT_EQ(count, 10);
}

TEST(Parallel, ReversedRangeIsEmpty) {
  parallel_for(5, 3, 1, [](std::size_t) { FAIL(); });
}

TEST(Parallel, BoundariesDependOnlyOnRangeAndGrain) {
  const auto boundaries = [](std::size_t threads) {
    const ThreadLimit limit(threads);
    std::mutex mutex;
    std::set<std::pair<std::size_t, std::size_t>> chunks;
    parallel_chunks(3, 1000, 37, [&](std::size_t first, std::size_t last) {
      const std::lock_guard lock(mutex);
      chunks.emplace(first, last);
    });
    return chunks;
  };
  EXPECT_EQ(boundaries(1), boundaries(4));
}

TEST(Parallel, ExceptionIsRethrown) {
  const auto body = [](std::size_t i) {
    if (i == 777) throw std::runtime_error("at 777");
  };
  EXPECT_THROW(parallel_for(0, 1000, 10, body), std::runtime_error);
  EXPECT_THROW(parallel_for(0, 1000, 1000, body), std::runtime_error);
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const std::size_t before = thread_count();
  {
    const ThreadLimit one(1);
    EXPECT_EQ(thread_count(), 1);
    std::mutex mutex;
    std::set<std::thread::id> threads;
    parallel_for(0, 100, 1, [&](std::size_t) {
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
    });
    EXPECT_EQ(threads.size(), 1);
  }
  EXPECT_EQ(thread_count(), before);
}

TEST(ThreadLimit, ZeroMeansAllTheMachineHas) {
  const ThreadLimit all(0);
  EXPECT_EQ(thread_count(), std::max(1U, std::thread::hardware_concurrency()));
}

TEST(ThreadLimit, MovesAndIsReplaced) {
  ThreadLimit limit(1);
  ThreadLimit moved = std::move(limit);
  EXPECT_EQ(thread_count(), 1);
  moved = ThreadLimit(2);
  EXPECT_EQ(thread_count(), 2);
}

}  // namespace
}  // namespace relumbre
