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

TEST(ScanCuda, NarrowElementsAreSummedAndCut) {
  RELUMBRE_NEEDS_DEVICE();
  expect_scans<std::uint16_t, std::uint8_t>(Plus<std::uint32_t>{}, "uint16 into uint8");
  expect_scans<float, std::int32_t>(Plus<double>{}, "float into int32 by float64");
}

TEST(ScanCuda, SumsOfWholeFloatsAreExact) {
  RELUMBRE_NEEDS_DEVICE();
  expect_scans<float, float>(Plus<float>{}, "float32");
  expect_scans<float, float>(Plus<double>{}, "float32 by float64");
  expect_scans<double, double>(Plus<double>{}, "float64");
}

TEST(ScanCuda, MinimumAndMaximum) {
  RELUMBRE_NEEDS_DEVICE();
  expect_scans<float, float>(Max<float>{}, "maximum");
  expect_scans<std::int32_t, std::int32_t>(Min<std::int32_t>{}, "minimum");
}

/// Maps under "first a, then b", of integers, which wrap: exact and not commutative.
using Map = Affine<std::uint32_t>;
using Maps = Compose<std::uint32_t>;

template <>
std::vector<Map> numbers(std::size_t size) {
  std::vector<Map> maps(size);
  const auto parts = numbers<std::uint32_t>(2 * size);
  for (std::size_t i = 0; i < size; ++i) maps[i] = {2 * parts[2 * i] + 1, parts[2 * i + 1]};
  return maps;
}

TEST(ScanCuda, OrderIsKept) {
  RELUMBRE_NEEDS_DEVICE();
  expect_scans<Map, Map>(Maps{}, "affine maps");
}

/// Joins runs: which elements, and whether they are neighbours in order.
template <std::size_t kWords>
struct Run {
  std::int32_t first = -1, last = -1, ordered = 1;
  std::int32_t padding[kWords - 3] = {};
};
template <>
struct Run<3> {
  std::int32_t first = -1, last = -1, ordered = 1;
};

template <std::size_t kWords>
struct Join {
  using value_type = Run<kWords>;
  [[nodiscard]] RELUMBRE_HOST_DEVICE value_type identity() const { return {}; }
  [[nodiscard]] RELUMBRE_HOST_DEVICE value_type operator()(const value_type& a,
                                                           const value_type& b) const {
    if (a.first < 0) return b;
    if (b.first < 0) return a;
    value_type run = a;
    run.last = b.last;
    run.ordered = a.ordered != 0 && b.ordered != 0 && a.last + 1 == b.first ? 1 : 0;
    return run;
  }
};

template <std::size_t kWords>
void expect_ordered_runs() {
  using R = Run<kWords>;
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : awkward_sizes<R, R, Join<kWords>>()) {
    std::vector<R> in(size);
    for (std::size_t i = 0; i < size; ++i) in[i].first = in[i].last = static_cast<std::int32_t>(i);
    const auto out = on_device<ScanKind::kInclusive, R>(in, Join<kWords>{}, scratch, stream);
    for (std::size_t i = 0; i < size; ++i) {
      ASSERT_EQ(out[i].first, 0);
      ASSERT_EQ(out[i].last, static_cast<std::int32_t>(i));
      ASSERT_EQ(out[i].ordered, 1);
    }
  }
}

TEST(ScanCuda, ValuesOf12And16And20Bytes) {
  RELUMBRE_NEEDS_DEVICE();
  expect_ordered_runs<3>();
  expect_ordered_runs<4>();
  expect_ordered_runs<5>();
}

TEST(ScanCuda, ManyGroupsOfTiles) {
  RELUMBRE_NEEDS_DEVICE();
  using T = std::uint64_t;
  constexpr std::size_t kTile = tile_size<T, T, Plus<T>>();
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t tiles : {31, 32, 33, 64, 65, 130}) {
    const auto in = numbers<T>(tiles * kTile - 5);
    expect_same(on_device<ScanKind::kInclusive, T>(in, Plus<T>{}, scratch, stream),
                twin<ScanKind::kInclusive, T>(in, Plus<T>{}), std::to_string(tiles) + " tiles");
  }
}

TEST(ScanCuda, ArraysMayBeginAnywhere) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const auto in = numbers<std::uint32_t>(
      2 * tile_size<std::uint32_t, std::uint32_t, Plus<std::uint32_t>>() + 3);
  for (const std::size_t offset : {1, 2, 3})
    expect_same(on_device<ScanKind::kExclusive, std::uint32_t>(in, Plus<std::uint32_t>{}, scratch,
                                                               stream, offset),
                twin<ScanKind::kExclusive, std::uint32_t>(in, Plus<std::uint32_t>{}),
                "offset " + std::to_string(offset));
}

TEST(ScanCuda, WorksInPlace) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  const Plus<float> plus;
  for (const std::size_t size : awkward_sizes<float, float, Plus<float>>()) {
    const auto in = numbers<float>(size);
    for (const ScanKind kind : {ScanKind::kInclusive, ScanKind::kExclusive}) {
      const auto values = to_device(std::span<const float>(in), stream);
      std::vector<float> out(size);
      if (kind == ScanKind::kInclusive)
        inclusive_scan(values.data(), size, values.data(), scratch, stream, plus);
      else
        exclusive_scan(values.data(), size, values.data(), scratch, stream, plus);
      copy_to_host(values.data(), out, stream);
      stream.wait();
      expect_same(out,
                  kind == ScanKind::kInclusive ? twin<ScanKind::kInclusive, float>(in, plus)
                                               : twin<ScanKind::kExclusive, float>(in, plus),
                  "in place");
    }
  }
}

TEST(ScanCuda, TotalIsTheFoldOfAll) {
  RELUMBRE_NEEDS_DEVICE();
  using T = std::uint32_t;
  const Stream stream;
  ScanScratch scratch;
  const DeviceArray<T> total(1);
  for (const std::size_t size : awkward_sizes<T, T, Plus<T>>()) {
    const auto in = numbers<T>(size);
    const auto from = to_device(std::span<const T>(in), stream);
    const DeviceArray<T> to(size);
    std::vector<T> result(1);
    exclusive_scan(from.data(), size, to.data(), scratch, stream, Plus<T>{}, total.data());
    copy_to_host(total.data(), result, stream);
    stream.wait();
    T expected = 0;
    for (const T v : in) expected += v;
    EXPECT_EQ(result[0], expected) << size;
  }
}

TEST(ScanCuda, SumsOfFloatsHaveTheSameBitsInEveryRun) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  // Groups of tiles too: it is the look-back that meets them in another order every time.
  const std::size_t size = 70 * tile_size<double, double, Plus<double>>() + 11;
  std::vector<double> in(size);
  std::mt19937 random(1);
  for (double& v : in) v = static_cast<double>(random()) / 3;
  const Plus<double> plus;
  const auto first = on_device<ScanKind::kInclusive, double>(in, plus, scratch, stream);
  for (int run = 0; run < 4; ++run)
    expect_same(on_device<ScanKind::kInclusive, double>(in, plus, scratch, stream), first, "again");
  const auto expected = twin<ScanKind::kInclusive, double>(in, plus);
  for (std::size_t i = 0; i < size; ++i) ASSERT_NEAR(first[i], expected[i], 1e-12 * expected[i]);
}

TEST(ScanCuda, ScratchServesAllSizesAndTypes) {
  RELUMBRE_NEEDS_DEVICE();
  const Stream stream;
  ScanScratch scratch;
  for (const std::size_t size : {20000, 3, 40000, 0, 9000, 40000}) {
    const auto in = numbers<std::uint32_t>(size);
    expect_same(
        on_device<ScanKind::kInclusive, std::uint32_t>(in, Plus<std::uint32_t>{}, scratch, stream),
        twin<ScanKind::kInclusive, std::uint32_t>(in, Plus<std::uint32_t>{}), "uint32");
    const auto maps = numbers<Map>(size / 2);
    expect_same(on_device<ScanKind::kExclusive, Map>(maps, Maps{}, scratch, stream),
                twin<ScanKind::kExclusive, Map>(maps, Maps{}), "maps");
  }
}

TEST(ScanCuda, GraphsScanAnew) {
  RELUMBRE_NEEDS_DEVICE();
  using T = std::uint32_t;
  const Stream stream;
  ScanScratch scratch;
  const auto in = numbers<T>(30000);
  const auto values = to_device(std::span<const T>(in), stream);
  const DeviceArray<T> once(in.size());
  inclusive_scan(values.data(), in.size(), once.data(), scratch, stream);
  const Graph graph(
      stream, [&] { inclusive_scan(values.data(), in.size(), values.data(), scratch, stream); });
  auto expected = in;
  for (int i = 0; i < 3; ++i) {
    graph.start(stream);
    expected = twin<ScanKind::kInclusive, T>(expected, Plus<T>{});
  }
  std::vector<T> out(in.size());
  copy_to_host(values.data(), out, stream);
  stream.wait();
  expect_same(out, expected, "graph");
}

__global__ void look_back(std::uint64_t* words, unsigned tiles, unsigned tile, Map own,
                          std::uint32_t tag, Map* before) {
  const Maps maps;
  const Map map = LookBack<Maps>(maps, words, tiles, tag)(tile, own, threadIdx.x);
  if (threadIdx.x == 0) *before = map;
}

/// The words of a scan that is under way: all tiles are published, and the first `groups` groups.
std::vector<std::uint64_t> words_under_way(const std::vector<Map>& tiles, std::size_t groups,
                                           std::uint32_t tag) {
  std::vector<std::uint64_t> words(LookBack<Maps>::words(tiles.size()));
  const auto publish = [&](std::size_t at, const Map& map) {
    words[2 * at] = std::uint64_t{tag} << 32 | map.scale;
    words[2 * at + 1] = std::uint64_t{tag} << 32 | map.offset;
  };
  Map all;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    publish(i, tiles[i]);
    all = Maps{}(all, tiles[i]);
    if (i % kWarp == kWarp - 1 && i / kWarp < groups) publish(tiles.size() + i / kWarp, all);
  }
  return words;
}

TEST(ScanCuda, LookBackFindsTheSameWhereverItBegins) {
  RELUMBRE_NEEDS_DEVICE();
  constexpr std::uint32_t kTag = 6;
  const Stream stream;
  const auto tiles = numbers<Map>(5 * kWarp + 9);
  const DeviceArray<Map> result(1);
  for (const unsigned tile : {4 * kWarp, 4 * kWarp + 1, 4 * kWarp + 20, 5 * kWarp - 1}) {
    Map expected;
    for (unsigned i = 0; i < tile; ++i) expected = Maps{}(expected, tiles[i]);
    for (const std::size_t groups : {2, 3, 4}) {
      const auto words =
          to_device(std::span<const std::uint64_t>(words_under_way(tiles, groups, kTag)), stream);
      launch(look_back, {.blocks = 1, .threads = kWarp}, stream, words.data(), tiles.size(), tile,
             tiles[tile], kTag, result.data());
      std::vector<Map> before(1);
      copy_to_host(result.data(), before, stream);
      stream.wait();
      EXPECT_EQ(before[0], expected) << "tile " << tile << " after " << groups << " groups";
    }
  }
}

}  // namespace
}  // namespace relumbre::cuda
