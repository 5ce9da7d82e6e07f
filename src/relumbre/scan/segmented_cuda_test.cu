#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/scan/compact_cuda.cuh"
#include "relumbre/scan/segmented_cuda.cuh"

namespace relumbre::cuda {
namespace {

const std::vector<std::size_t> kSizes = {0, 1, 31, 33, 1000, 5119, 5120, 5121, 23456};

/// About one in `period` is a head.
std::vector<std::uint8_t> random_flags(std::size_t size, unsigned period) {
  std::mt19937 random(period);
  std::vector<std::uint8_t> flags(size);
  for (auto& f : flags) f = random() % period == 0 ? 1 : 0;
  return flags;
}

template <class T>
std::vector<T> numbers(std::size_t size) {
  std::mt19937 random(static_cast<unsigned>(size));
  std::vector<T> values(size);
  for (T& v : values) v = static_cast<T>(random() % 251);
  return values;
}

template <class T, class M>
std::vector<T> twin(const std::vector<T>& in, const std::vector<std::uint8_t>& heads, const M& m,
                    ScanKind kind) {
  std::vector<T> out;
  T value = m.identity();
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (heads[i] != 0) value = m.identity();
    const T next = m(value, in[i]);
    out.push_back(kind == ScanKind::kInclusive ? next : value);
    value = next;
  }
  return out;
}

template <class T, class Scan>
std::vector<T> on_device(const std::vector<T>& in, const Stream& stream, const Scan& scan) {
  const auto from = to_device(std::span<const T>(in), stream);
  const DeviceArray<T> to(in.size());
  scan(from.data(), to.data());
  std::vector<T> out(in.size());
  copy_to_host(to.data(), out, stream);
  stream.wait();
  return out;
}

TEST(SegmentedScanCuda, BeginsAnewAtHeads) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : kSizes) {
    for (const unsigned period : {1U, 5U, 3000U}) {
      const auto in = numbers<std::uint32_t>(size);
      const auto flags = random_flags(size, period);
      const auto heads = to_device(std::span<const std::uint8_t>(flags), stream);
      for (const ScanKind kind : {ScanKind::kInclusive, ScanKind::kExclusive}) {
        const auto out = on_device(in, stream, [&](const std::uint32_t* from, std::uint32_t* to) {
          segmented_scan(from, heads.data(), size, to, scratch, stream, Max<std::uint32_t>{}, kind);
        });
        EXPECT_EQ(out, twin(in, flags, Max<std::uint32_t>{}, kind)) << size << ", " << period;
      }
    }
  }
}

TEST(SegmentedScanCuda, BeginsAnewWhereKeysChange) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : kSizes) {
    const auto in = numbers<double>(size);
    auto flags = random_flags(size, 40);
    if (size > 0) flags[0] = 1;
    std::vector<std::int32_t> keys(size);
    std::int32_t key = 0;
    for (std::size_t i = 0; i < size; ++i) keys[i] = flags[i] != 0 ? ++key % 3 : key % 3;
    const auto on_gpu = to_device(std::span<const std::int32_t>(keys), stream);
    for (const ScanKind kind : {ScanKind::kInclusive, ScanKind::kExclusive}) {
      const auto out = on_device(in, stream, [&](const double* from, double* to) {
        scan_by_key(on_gpu.data(), from, size, to, scratch, stream, Plus<double>{}, kind);
      });
      EXPECT_EQ(out, twin(in, flags, Plus<double>{}, kind)) << size;
    }
  }
}

TEST(SegmentedScanCuda, TotalIsThatOfTheLastSegment) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const auto in = numbers<std::uint32_t>(9000);
  const auto flags = random_flags(in.size(), 700);
  const auto heads = to_device(std::span<const std::uint8_t>(flags), stream);
  const DeviceArray<Headed<std::uint32_t>> total(1);
  on_device(in, stream, [&](const std::uint32_t* from, std::uint32_t* to) {
    segmented_scan(from, heads.data(), in.size(), to, scratch, stream, Plus<std::uint32_t>{},
                   ScanKind::kInclusive, total.data());
  });
  std::vector<Headed<std::uint32_t>> result(1);
  copy_to_host(total.data(), result, stream);
  stream.wait();
  EXPECT_EQ(result[0].value, twin(in, flags, Plus<std::uint32_t>{}, ScanKind::kInclusive).back());
  EXPECT_TRUE(result[0].head);
}

struct IsOdd {
  template <class T>
  RELUMBRE_HOST_DEVICE bool operator()(T value) const {
    return value % 2 != 0;
  }
};

/// What is kept, and marks behind it which show whether they were left alone.
template <class T, class Compact>
void expect_compacted(const std::vector<T>& in, const std::vector<T>& expected,
                      const Stream& stream, const Compact& compact_into) {
  constexpr T kMark = 77;
  const auto from = to_device(std::span<const T>(in), stream);
  const std::vector<T> marks(in.size(), kMark);
  const auto to = to_device(std::span<const T>(marks), stream);
  const DeviceArray<std::uint64_t> kept(1);
  compact_into(from.data(), to.data(), kept.data());
  std::vector<T> out(in.size());
  std::vector<std::uint64_t> count(1);
  copy_to_host(to.data(), out, stream);
  copy_to_host(kept.data(), count, stream);
  stream.wait();
  ASSERT_EQ(count[0], expected.size()) << in.size();
  for (std::size_t i = 0; i < in.size(); ++i)
    ASSERT_EQ(out[i], i < expected.size() ? expected[i] : kMark) << i << " of " << in.size();
}

TEST(CompactCuda, KeepsWhatIsAskedForInOrder) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : kSizes) {
    const auto in = numbers<std::uint16_t>(size);
    std::vector<std::uint16_t> odd;
    for (const auto v : in)
      if (IsOdd{}(v)) odd.push_back(v);
    expect_compacted(in, odd, stream, [&](const auto* from, auto* to, std::uint64_t* kept) {
      compact(from, size, to, IsOdd{}, scratch, stream, kept);
    });
  }
}

TEST(CompactCuda, KeepsWhatIsFlaggedInOrder) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : kSizes) {
    const auto in = numbers<std::uint32_t>(size);
    const auto flags = random_flags(size, 3);
    const auto on_gpu = to_device(std::span<const std::uint8_t>(flags), stream);
    std::vector<std::uint32_t> flagged;
    for (std::size_t i = 0; i < size; ++i)
      if (flags[i] != 0) flagged.push_back(in[i]);
    expect_compacted(in, flagged, stream, [&](const auto* from, auto* to, std::uint64_t* kept) {
      compact_flagged(from, on_gpu.data(), size, to, scratch, stream, kept);
    });
  }
}

}  // namespace
}  // namespace relumbre::cuda
