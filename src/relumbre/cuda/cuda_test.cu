#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/device.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/cuda/warp.cuh"

namespace relumbre::cuda {
namespace {

struct Sum {
  __device__ int operator()(int a, int b) const { return a + b; }
};

__global__ void scan_warps(const int* in, int* out) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  out[i] = warp_inclusive_scan(in[i], threadIdx.x % kWarp, Sum{});
}

struct Reversal {
  int value[96];
};

__global__ void reverse_blocks(int* values) {
  auto& shared = shared_as<Reversal>();
  int* block = values + blockIdx.x * blockDim.x;
  shared.value[threadIdx.x] = block[threadIdx.x];
  __syncthreads();
  block[threadIdx.x] = shared.value[blockDim.x - 1 - threadIdx.x];
}

__global__ void count_up(unsigned* counter, unsigned* order) {
  if (threadIdx.x == 0) order[atomicAdd(counter, 1U)] = blockIdx.x;
}

TEST(Cuda, WarpsScan) {
  RELUMBRE_NEEDS_DEVICE();
  std::vector<int> in(32 * 6);
  std::iota(in.begin(), in.end(), 1);
  const Stream stream;
  const auto device = to_device(std::span<const int>(in), stream);
  DeviceArray<int> out(in.size());
  launch(scan_warps, {.blocks = 3, .threads = 64}, stream, device.data(), out.data());
  std::vector<int> result(in.size());
  copy_to_host(out.data(), result, stream);
  stream.wait();
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto first = in.begin() + static_cast<std::ptrdiff_t>(i / 32 * 32);
    EXPECT_EQ(result[i],
              std::accumulate(first, in.begin() + static_cast<std::ptrdiff_t>(i + 1), 0));
  }
}

TEST(Cuda, ThreadsOfABlockShareMemory) {
  RELUMBRE_NEEDS_DEVICE();
  std::vector<int> values(96 * 5);
  std::iota(values.begin(), values.end(), 0);
  const Stream stream;
  const auto device = to_device(std::span<const int>(values), stream);
  launch(reverse_blocks, {.blocks = 5, .threads = 96, .shared_bytes = sizeof(Reversal)}, stream,
         device.data());
  std::vector<int> result(values.size());
  copy_to_host(device.data(), result, stream);
  stream.wait();
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_EQ(result[i], static_cast<int>(i / 96 * 96 + 95 - i % 96));
}

TEST(Cuda, EveryBlockRunsOnce) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  DeviceArray<unsigned> counter(1), order(100);
  clear(counter.data(), 1, stream);
  launch(count_up, {.blocks = 100, .threads = 64}, stream, counter.data(), order.data());
  std::vector<unsigned> result(100);
  copy_to_host(order.data(), result, stream);
  stream.wait();
  std::sort(result.begin(), result.end());
  for (unsigned i = 0; i < 100; ++i) EXPECT_EQ(result[i], i);
}

TEST(Cuda, GraphDoesItsWorkAnew) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  DeviceArray<unsigned> counter(1), order(30);
  clear(counter.data(), 1, stream);
  const Graph graph(stream, [&] {
    launch(count_up, {.blocks = 10, .threads = 32}, stream, counter.data(), order.data());
  });
  for (int i = 0; i < 3; ++i) graph.start(stream);
  std::vector<unsigned> result(1);
  copy_to_host(counter.data(), result, stream);
  stream.wait();
  EXPECT_EQ(result[0], 30U);
}

TEST(Cuda, TooMuchMemoryIsRefusedWithFigures) {
  RELUMBRE_NEEDS_DEVICE();
  const std::size_t all = current_device().memory_bytes;
  try {
    const DeviceArray<std::byte> array(all + 1);
    FAIL() << "allocated";
  } catch (const OutOfDeviceMemory& error) {
    EXPECT_NE(std::string(error.what()).find("GB asked"), std::string::npos) << error.what();
  }
  try {
    expect_free(all + 1, "a test");
    FAIL() << "free";
  } catch (const OutOfDeviceMemory& error) {
    EXPECT_EQ(std::string(error.what()).find("a test: needs "), 0U) << error.what();
  }
  EXPECT_NO_THROW(expect_free(1, "a test"));
}

TEST(Cuda, DevicesAreNamedByTheirNumber) {
  RELUMBRE_NEEDS_DEVICE();
  const std::size_t count = devices().size();
  EXPECT_EQ(parse_device("cuda"), 0);
  EXPECT_EQ(parse_device("cuda:0"), 0);
  for (const std::string name :
       {"gpu", "cuda:", "cuda:x", "cuda:-1", "cuda:0x", "", "cuda:99999999999999999999"})
    EXPECT_THROW(parse_device(name), ValueError) << name;
  EXPECT_THROW(parse_device("cuda:" + std::to_string(count)), ValueError);
}

}  // namespace
}  // namespace relumbre::cuda
