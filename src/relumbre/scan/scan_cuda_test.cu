#include <cstdint>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/scan/scan_cuda.cuh"

namespace relumbre::cuda {
namespace {

/// Small numbers, always the same for a size.
template <class T>
std::vector<T> numbers(std::size_t size) {
  std::mt19937 random(static_cast<unsigned>(size));
  std::vector<T> values(size);
  for (T& v : values) v = static_cast<T>(random() % 251);
  return values;
}

template <ScanKind kKind, class Out, class In, class M>
std::vector<Out> twin(const std::vector<In>& in, const M& m) {
  using Value = typename M::value_type;
  std::vector<Out> out;
  Value value = m.identity();
  for (const In& x : in) {
    const Value next = m(value, static_cast<Value>(x));
    out.push_back(static_cast<Out>(kKind == ScanKind::kInclusive ? next : value));
    value = next;
  }
  return out;
}

/// Device memory of which a scan gets all but the first `offset` elements.
template <ScanKind kKind, class Out, class In, class M>
std::vector<Out> on_device(const std::vector<In>& in, const M& m, ScanScratch& scratch,
                           const Stream& stream, std::size_t offset = 0) {
  DeviceArray<In> from(in.size() + offset);
  DeviceArray<Out> to(in.size() + offset);
  copy_to_device(std::span<const In>(in), from.data() + offset, stream);
  if constexpr (kKind == ScanKind::kInclusive)
    inclusive_scan(from.data() + offset, in.size(), to.data() + offset, scratch, stream, m);
  else
    exclusive_scan(from.data() + offset, in.size(), to.data() + offset, scratch, stream, m);
  std::vector<Out> out(in.size());
  copy_to_host(to.data() + offset, out, stream);
  stream.wait();
  return out;
}

template <class T>
bool same(const T& a, const T& b) {
  return a == b;
}

template <class Out>
void expect_same(const std::vector<Out>& result, const std::vector<Out>& expected,
                 const std::string& what) {
  ASSERT_EQ(result.size(), expected.size()) << what;
  for (std::size_t i = 0; i < result.size(); ++i)
    ASSERT_TRUE(same(result[i], expected[i])) << what << " at " << i << " of " << result.size();
}

template <class In, class Out, class M>
constexpr std::size_t tile_size() {
  return scan_detail::Tile<scan_detail::Arrays<In, Out, M>>::kSize;
}

template <class In, class Out, class M>
std::vector<std::size_t> awkward_sizes() {
  const std::size_t tile = tile_size<In, Out, M>();
  return {0, 1, 2, 31, 33, tile - 1, tile, tile + 1, 3 * tile + 77};
}

template <class In, class Out, class M>
void expect_scans(const M& m, const std::string& what) {
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : awkward_sizes<In, Out, M>()) {
    const auto in = numbers<In>(size);
    expect_same(on_device<ScanKind::kInclusive, Out>(in, m, scratch, stream),
                twin<ScanKind::kInclusive, Out>(in, m), what + ", inclusive");
    expect_same(on_device<ScanKind::kExclusive, Out>(in, m, scratch, stream),
                twin<ScanKind::kExclusive, Out>(in, m), what + ", exclusive");
  }
}

TEST(ScanCuda, SumsOfIntegersAreThoseOfALoop) {
  RELUMBRE_NEEDS_DEVICE();
  expect_scans<std::uint32_t, std::uint32_t>(Plus<std::uint32_t>{}, "uint32");
  expect_scans<std::int64_t, std::int64_t>(Plus<std::int64_t>{}, "int64");
  expect_scans<std::uint8_t, std::uint32_t>(Plus<std::uint32_t>{}, "uint8 into uint32");
  expect_scans<std::uint8_t, std::uint64_t>(Plus<std::uint64_t>{}, "uint8 into uint64");
  expect_scans<std::uint16_t, std::uint16_t>(Plus<std::uint16_t>{}, "uint16");
}

}  // namespace
}  // namespace relumbre::cuda
