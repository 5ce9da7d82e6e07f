#include "relumbre/scan/kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/scan/scan_testing.h"
#include "relumbre/scan/stream_writer.h"

namespace relumbre {
namespace {

using scan_testing::random_values;

/// Every kernel of every instruction set against a loop in the carry's type.
template <class In, class Carry, class Out, class M>
void expect_matches_loop(const ScanKernel<In, Carry, Out>& kernel, M m, In low, In high,
                         double tolerance) {
  for (const std::size_t size : {0UL, 1UL, 15UL, 16UL, 127UL, 128UL, 129UL, 1000UL}) {
    const std::vector<In> in = random_values<In>(size, low, high);
    const auto prefix = static_cast<Carry>(high);
    const Carry before = m(prefix, static_cast<Carry>(low));
    std::vector<Out> inclusive(size), exclusive(size);
    const auto local = static_cast<Carry>(low);
    const Carry total = kernel.inclusive(in.data(), size, inclusive.data(), prefix, local);
    EXPECT_EQ(kernel.exclusive(in.data(), size, exclusive.data(), prefix, local), total);
    EXPECT_EQ(kernel.fold(in.data(), size, local), total) << "a fold has a scan's bits";
    EXPECT_NEAR(static_cast<double>(m(m(prefix, local), kernel.quick_fold(in.data(), size))),
                static_cast<double>(m(prefix, total)), tolerance);
    Carry sum = before;
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(static_cast<double>(exclusive[i]), static_cast<double>(sum), tolerance) << i;
      sum = m(sum, static_cast<Carry>(in[i]));
      EXPECT_NEAR(static_cast<double>(inclusive[i]), static_cast<double>(sum), tolerance) << i;
    }
  }
}

TEST(ScanKernels, EveryInstructionSetMatchesLoops) {
  for (const ScanKernels& k : available_scan_kernels()) {
    SCOPED_TRACE(k.name);
    expect_matches_loop(k.plus_float, Plus<double>(), -1.0F, 1.0F, 1e-5);
    expect_matches_loop(k.plus_double_of_float, Plus<double>(), -1.0F, 1.0F, 1e-5);
    expect_matches_loop(k.plus_float_to_double, Plus<double>(), -1.0F, 1.0F, 1e-12);
    expect_matches_loop(k.plus_double, Plus<double>(), -1.0, 1.0, 1e-12);
    expect_matches_loop(k.plus_int32, Plus<std::int32_t>(), INT32_MIN, INT32_MAX, 0);
    expect_matches_loop(k.plus_uint32, Plus<std::uint32_t>(), 0U, UINT32_MAX, 0);
    expect_matches_loop(k.plus_int64, Plus<std::int64_t>(), std::int64_t{-1} << 40,
                        std::int64_t{1} << 40, 0);
    expect_matches_loop(k.plus_uint64, Plus<std::uint64_t>(), std::uint64_t{0},
                        std::uint64_t{1} << 40, 0);
    expect_matches_loop(k.min_float, Min<float>(), -9.0F, 9.0F, 0);
    expect_matches_loop(k.max_float, Max<float>(), -9.0F, 9.0F, 0);
    expect_matches_loop(k.min_double, Min<double>(), -9.0, 9.0, 0);
    expect_matches_loop(k.max_double, Max<double>(), -9.0, 9.0, 0);
    expect_matches_loop(k.min_int32, Min<std::int32_t>(), INT32_MIN, INT32_MAX, 0);
    expect_matches_loop(k.max_int32, Max<std::int32_t>(), INT32_MIN, INT32_MAX, 0);
    expect_matches_loop(k.min_uint32, Min<std::uint32_t>(), 0U, UINT32_MAX, 0);
    expect_matches_loop(k.max_uint32, Max<std::uint32_t>(), 0U, UINT32_MAX, 0);
  }
}

TEST(ScanKernels, MinimumDescendsInOrder) {
  for (const ScanKernels& k : available_scan_kernels()) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    std::vector<float> in(500), out(500);
    for (std::size_t i = 0; i < in.size(); ++i) in[i] = 1000.0F - static_cast<float>(i);
    k.min_float.inclusive(in.data(), in.size(), out.data(), infinity, infinity);
    EXPECT_EQ(out, in) << k.name;
  }
}

TEST(ScanKernels, RunsMayBeCutAtGranules) {
  const std::size_t size = 5 * kRunGranule + 9;
  const auto in = random_values<float>(size, -1, 1);
  for (const ScanKernels& k : available_scan_kernels()) {
    std::vector<float> whole(size), cut(size);
    const double total = k.plus_float.inclusive(in.data(), size, whole.data(), 7, 0);
    double local = 0;
    for (std::size_t i = 0; i < size; i += 2 * kRunGranule) {
      const std::size_t count = std::min(2 * kRunGranule, size - i);
      local = k.plus_float.inclusive(&in[i], count, &cut[i], 7, local);
    }
    EXPECT_EQ(local, total) << k.name;
    EXPECT_EQ(cut, whole) << k.name;
  }
}

template <class T>
void expect_streams(std::size_t offset, std::size_t size) {
  const auto values = random_values<T>(size, 1, 100);
  std::vector<T> out(offset + size + 64);
  StreamWriter<T> writer(&out[offset]);
  for (std::size_t i = 0; i < size; i += writer.kRun) {
    const std::size_t count = std::min(writer.kRun, size - i);
    std::copy_n(&values[i], count, writer.buffer());
    writer.commit(count);
  }
  writer.finish();
  std::vector<T> expected(offset);
  expected.insert(expected.end(), values.begin(), values.end());
  expected.resize(out.size());
  EXPECT_EQ(out, expected) << size << " behind " << offset;
}

TEST(StreamWriter, WritesWhatItIsGivenAndNoMore) {
  for (const std::size_t offset : {0UL, 1UL, 3UL, 15UL, 16UL, 17UL}) {
    for (const std::size_t size : {0UL, 1UL, 2UL, 16UL, 17UL, 1023UL, 1024UL, 1025UL, 5000UL}) {
      expect_streams<float>(offset, size);
      expect_streams<std::uint8_t>(offset, size);
      expect_streams<double>(offset, size);
    }
  }
}

}  // namespace
}  // namespace relumbre
