// The emulator finds the faults that it is there for: each of these kernels has one.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"

namespace relumbre::cuda {
namespace {

/// What the emulator says of a kernel.
template <class... Parameters, class... Arguments>
std::string fault_of(void (*kernel)(Parameters...), dim3 blocks, dim3 threads,
                     Arguments... arguments) {
  const Stream stream;
  launch(kernel, {.blocks = blocks, .threads = threads, .shared_bytes = 256}, stream, arguments...);
  try {
    stream.wait();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "none";
}

__global__ void two_barriers() {
  if (threadIdx.x < 32) {
    __syncthreads();
  } else {
    __syncthreads();
  }
}
__global__ void lane_outside_its_mask() { __syncwarp(0xFFFF0000U); }
__global__ void lane_that_has_ended() {
  if (threadIdx.x == 3) return;
  __syncwarp();
}
__global__ void waits_for_ever(unsigned* flag) {
  while (*flag != 1) __nanosleep(10);
}

TEST(Emulator, ReportsBarriersThatThreadsReachAtDifferentPlaces) {
  EXPECT_NE(fault_of(two_barriers, 1, 64).find("different barriers"), std::string::npos);
}

TEST(Emulator, ReportsLanesAndMasksThatDisagree) {
  EXPECT_NE(fault_of(lane_outside_its_mask, 1, 32).find("outside its mask"), std::string::npos);
  EXPECT_NE(fault_of(lane_that_has_ended, 1, 32).find("ended"), std::string::npos);
}

TEST(Emulator, ReportsWaitingForEver) {
  const DeviceArray<unsigned> flag(1);
  EXPECT_NE(fault_of(waits_for_ever, 1, 1, flag.data()).find("for ever"), std::string::npos);
}

__global__ void in_order(unsigned* order, unsigned* next) {
  order[atomicAdd(next, 1U)] = blockIdx.x;
}

TEST(Emulator, BlocksComeInManyOrders) {
  const Stream stream;
  const DeviceArray<unsigned> order(20), next(1);
  bool mixed = false;
  for (int run = 0; run < 3; ++run) {
    clear(next.data(), 1, stream);
    launch(in_order, {.blocks = 20, .threads = 1}, stream, order.data(), next.data());
    std::vector<unsigned> result(20);
    copy_to_host(order.data(), result, stream);
    stream.wait();
    mixed = mixed || !std::is_sorted(result.begin(), result.end());
  }
  EXPECT_TRUE(mixed);
}

/// Neighbours' values without a barrier in between.
__global__ void race(unsigned* result) {
  auto& shared = shared_as<unsigned[64]>();
  shared[threadIdx.x] = threadIdx.x;
  __syncwarp();
  result[threadIdx.x] = shared[63 - threadIdx.x];
}

TEST(Emulator, AMissingBarrierShowsSoonerOrLater) {
  const Stream stream;
  const DeviceArray<unsigned> result(64);
  bool wrong = false;
  for (int run = 0; run < 50; ++run) {
    launch(race, {.blocks = 1, .threads = 64, .shared_bytes = 256}, stream, result.data());
    std::vector<unsigned> values(64);
    copy_to_host(result.data(), values, stream);
    stream.wait();
    for (unsigned i = 0; i < 64; ++i) wrong = wrong || values[i] != 63 - i;
  }
  EXPECT_TRUE(wrong);
}

TEST(Emulator, FreshDeviceMemoryIsNoData) {
  const Stream stream;
  const DeviceArray<float> fresh(3);
  std::vector<float> values(3);
  copy_to_host(fresh.data(), values, stream);
  stream.wait();
  for (const float v : values) EXPECT_TRUE(v != v);
}

TEST(Emulator, NothingHappensBeforeItIsWaitedFor) {
  const Stream stream;
  std::vector<unsigned> values{7};
  const DeviceArray<unsigned> there(1);
  copy_to_device<unsigned>(values, there.data(), stream);
  std::vector<unsigned> back{0};
  copy_to_host(there.data(), back, stream);
  EXPECT_EQ(back[0], 0U);
  stream.wait();
  EXPECT_EQ(back[0], 7U);
}

TEST(Emulator, DeviceMemoryIsCounted) {
  const std::size_t before = emulator::allocated_bytes();
  {
    const DeviceArray<double> array(100);
    EXPECT_EQ(emulator::allocated_bytes(), before + 800);
  }
  EXPECT_EQ(emulator::allocated_bytes(), before);
}

}  // namespace
}  // namespace relumbre::cuda
