#include "relumbre/scan/scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan_testing.h"

namespace relumbre {
namespace {

using scan_testing::random_values;
using scan_testing::sizes_around;

/// The obvious loops.
template <class Out, class In, class M>
std::vector<Out> slow_inclusive(const std::vector<In>& in, const M& m) {
  std::vector<Out> out;
  auto sum = m.identity();
  for (const In& x : in)
    out.push_back(static_cast<Out>(sum = m(sum, static_cast<typename M::value_type>(x))));
  return out;
}

template <class Out, class In, class M>
std::vector<Out> slow_exclusive(const std::vector<In>& in, const M& m) {
  std::vector<Out> out;
  auto sum = m.identity();
  for (const In& x : in) {
    out.push_back(static_cast<Out>(sum));
    sum = m(sum, static_cast<typename M::value_type>(x));
  }
  return out;
}

template <class In, class M>
auto slow_fold(const std::vector<In>& in, const M& m) {
  auto sum = m.identity();
  for (const In& x : in) sum = m(sum, static_cast<typename M::value_type>(x));
  return sum;
}

/// Exact monoids: equal to the loops, at every awkward size, in place and not, by 1 to 8 threads.
template <class In, class Out, class M>
void expect_matches_loops(const std::function<std::vector<In>(std::size_t)>& make, const M& m) {
  for (const std::size_t size : sizes_around(scan_detail::kTile<In>)) {
    const std::vector<In> in = make(size);
    const auto total = slow_fold(in, m);
    const std::vector<Out> inclusive = slow_inclusive<Out>(in, m);
    const std::vector<Out> exclusive = slow_exclusive<Out>(in, m);
    for (const std::size_t threads : {1, 2, 3, 8}) {
      SCOPED_TRACE(std::to_string(size) + " elements, threads: " + std::to_string(threads));
      const ThreadLimit limit(threads);
      std::vector<Out> out(size);
      EXPECT_TRUE(inclusive_scan(in, out, m) == total);
      EXPECT_TRUE(out == inclusive);
      EXPECT_TRUE(exclusive_scan(in, out, m) == total);
      EXPECT_TRUE(out == exclusive);
      if constexpr (std::is_same_v<In, Out>) {
        out = in;
        EXPECT_TRUE(inclusive_scan(out, out, m) == total);
        EXPECT_TRUE(out == inclusive);
        out = in;
        EXPECT_TRUE(exclusive_scan(out, out, m) == total);
        EXPECT_TRUE(out == exclusive);
      }
    }
  }
}

template <class T>
std::vector<T> any_integers(std::size_t size) {
  return random_values<T>(size, std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max());
}

TEST(Scan, ExclusiveScanOfTheReportsExample) {
  const std::vector<int> in{3, 1, 7, 0, 4, 1, 6, 3};
  std::vector<int> out(in.size());
  EXPECT_EQ(exclusive_scan(in, out), 25);
  EXPECT_EQ(out, (std::vector<int>{0, 3, 4, 11, 11, 15, 16, 22}));
  EXPECT_EQ(inclusive_scan(in, out), 25);
  EXPECT_EQ(out, (std::vector<int>{3, 4, 11, 11, 15, 16, 22, 25}));
}

TEST(Scan, IntegerSumsMatchLoopsAndWrapAround) {
  expect_matches_loops<std::int32_t, std::int32_t>(any_integers<std::int32_t>,
                                                   Plus<std::int32_t>());
  expect_matches_loops<std::uint32_t, std::uint32_t>(any_integers<std::uint32_t>,
                                                     Plus<std::uint32_t>());
  expect_matches_loops<std::int64_t, std::int64_t>(any_integers<std::int64_t>,
                                                   Plus<std::int64_t>());
  expect_matches_loops<std::uint64_t, std::uint64_t>(any_integers<std::uint64_t>,
                                                     Plus<std::uint64_t>());
}

TEST(Scan, NarrowElementsAccumulateInWideTypes) {
  expect_matches_loops<std::uint8_t, std::uint64_t>(any_integers<std::uint8_t>,
                                                    Plus<std::uint64_t>());
  expect_matches_loops<std::uint8_t, std::uint32_t>(any_integers<std::uint8_t>,
                                                    Plus<std::uint64_t>());
  expect_matches_loops<std::int16_t, std::int16_t>(any_integers<std::int16_t>,
                                                   Plus<std::int16_t>());
}

TEST(Scan, MinimaAndMaximaMatchLoops) {
  const auto floats = [](std::size_t n) { return random_values<float>(n, -1e6F, 1e6F); };
  const auto doubles = [](std::size_t n) { return random_values<double>(n, -1e6, 1e6); };
  expect_matches_loops<float, float>(floats, Min<float>());
  expect_matches_loops<float, float>(floats, Max<float>());
  expect_matches_loops<double, double>(doubles, Min<double>());
  expect_matches_loops<double, double>(doubles, Max<double>());
  expect_matches_loops<std::int32_t, std::int32_t>(any_integers<std::int32_t>, Min<std::int32_t>());
  expect_matches_loops<std::int32_t, std::int32_t>(any_integers<std::int32_t>, Max<std::int32_t>());
  expect_matches_loops<std::uint32_t, std::uint32_t>(any_integers<std::uint32_t>,
                                                     Min<std::uint32_t>());
  expect_matches_loops<std::uint32_t, std::uint32_t>(any_integers<std::uint32_t>,
                                                     Max<std::uint32_t>());
  expect_matches_loops<std::int64_t, std::int64_t>(any_integers<std::int64_t>, Max<std::int64_t>());
}

TEST(Scan, MinimaAndMaximaSkipNan) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const auto with_nan = [](std::size_t n) {
    std::vector<float> values = random_values<float>(n, -1e6F, 1e6F);
    for (std::size_t i = 0; i < n; i += 3) values[i] = nan;
    return values;
  };
  expect_matches_loops<float, float>(with_nan, Min<float>());
  expect_matches_loops<float, float>(with_nan, Max<float>());
  EXPECT_EQ(Min<float>()(nan, 1), 1);
  EXPECT_EQ(Max<float>()(1, nan), 1);
}

/// The first and last letters of a string and its length: what concatenation does to it.
struct Ends {
  char first = 0, last = 0;
  std::uint32_t length = 0;
  friend bool operator==(const Ends&, const Ends&) = default;
};
struct JoinEnds {
  using value_type = Ends;
  [[nodiscard]] Ends identity() const { return {}; }
  Ends operator()(const Ends& a, const Ends& b) const {
    if (a.length == 0) return b;
    if (b.length == 0) return a;
    return {a.first, b.last, a.length + b.length};
  }
};

struct Matrix {
  std::array<std::uint32_t, 4> m{1, 0, 0, 1};
  friend bool operator==(const Matrix&, const Matrix&) = default;
};
struct MatrixProduct {
  using value_type = Matrix;
  [[nodiscard]] Matrix identity() const { return {}; }
  Matrix operator()(const Matrix& a, const Matrix& b) const {
    const auto &x = a.m, &y = b.m;
    return {{x[0] * y[0] + x[1] * y[2], x[0] * y[1] + x[1] * y[3], x[2] * y[0] + x[3] * y[2],
             x[2] * y[1] + x[3] * y[3]}};
  }
};

TEST(Scan, OrderIsKeptWhereTheOperationDoesNotCommute) {
  const auto ends = [](std::size_t n) {
    std::vector<Ends> values(n);
    for (std::size_t i = 0; i < n; ++i)
      values[i] = {static_cast<char>('a' + i % 26), static_cast<char>('a' + i % 26), 1};
    return values;
  };
  expect_matches_loops<Ends, Ends>(ends, JoinEnds());
  const auto matrices = [](std::size_t n) {
    const std::vector<std::uint32_t> entries = any_integers<std::uint32_t>(4 * n);
    std::vector<Matrix> values(n);
    for (std::size_t i = 0; i < n; ++i) std::copy_n(&entries[4 * i], 4, values[i].m.begin());
    return values;
  };
  expect_matches_loops<Matrix, Matrix>(matrices, MatrixProduct());
  const auto affine = [](std::size_t n) {
    const std::vector<std::uint32_t> entries = any_integers<std::uint32_t>(2 * n);
    std::vector<Affine<std::uint32_t>> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = {entries[2 * i], entries[2 * i + 1]};
    return values;
  };
  expect_matches_loops<Affine<std::uint32_t>, Affine<std::uint32_t>>(affine,
                                                                     Compose<std::uint32_t>());
}

struct Concatenate {
  using value_type = std::string;
  [[nodiscard]] std::string identity() const { return {}; }
  std::string operator()(const std::string& a, const std::string& b) const { return a + b; }
};

TEST(Scan, StringsConcatenateInOrder) {
  const std::size_t size = scan_detail::kTile<std::string> + 7;
  std::vector<std::string> in(size);
  for (std::size_t i = 0; i < size; ++i) in[i] = std::string(1, static_cast<char>('a' + i % 26));
  const std::vector<std::string> inclusive = slow_inclusive<std::string>(in, Concatenate());
  for (const std::size_t threads : {1, 3}) {
    const ThreadLimit limit(threads);
    std::vector<std::string> out(size);
    EXPECT_EQ(inclusive_scan(in, out, Concatenate()), inclusive.back());
    EXPECT_EQ(out, inclusive);
  }
}

void expect_same_bits_for_any_number_of_threads(std::size_t size, int repeats) {
  const auto in = random_values<float>(size, -1, 1);
  const auto scan_with = [&](std::size_t threads, auto m, auto out) {
    const ThreadLimit limit(threads);
    inclusive_scan(in, out, m);
    std::vector<std::remove_cvref_t<decltype(out[0])>> both = out;
    exclusive_scan(in, out, m);
    both.insert(both.end(), out.begin(), out.end());
    return both;
  };
  const auto expect_same = [&](auto m, auto out) {
    const auto alone = scan_with(1, m, out);
    for (const std::size_t threads : {2, 3, 8}) {
      for (int again = 0; again < repeats; ++again)
        EXPECT_TRUE(scan_with(threads, m, out) == alone);
    }
  };
  expect_same(Plus<float>(), std::vector<float>(size));
  expect_same(Plus<double>(), std::vector<float>(size));
  expect_same(Plus<double>(), std::vector<double>(size));
  expect_same(Plus<long double>(), std::vector<double>(size));  // element by element
}

TEST(Scan, FloatSumsHaveTheSameBitsForAnyNumberOfThreads) {
  expect_same_bits_for_any_number_of_threads(9 * scan_detail::kTile<float> + 77, 3);
}

TEST(Scan, FloatSumsThatOutgrowTheCachesHaveTheSameBitsForAnyNumberOfThreads) {
  const std::size_t size = 4'500'077;  // 36 MB in and out
  expect_same_bits_for_any_number_of_threads(size, 1);
}

/// |error| ≤ 8u·Σ|x| + 2u·|result| for all results, with u = 2⁻²⁴.
void expect_precise(const std::vector<float>& in, const std::vector<float>& out, double bound) {
  long double sum = 0, size = 0, worst = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    sum += static_cast<long double>(in[i]);
    size += std::abs(static_cast<long double>(in[i]));
    const long double error = std::abs(static_cast<long double>(out[i]) - sum);
    const long double allowed = bound * size + 0x1p-23L * std::abs(sum);
    worst = std::max(worst, error / std::max(allowed, 1e-30L));
  }
  EXPECT_LE(worst, 1.0L);
}

TEST(Scan, FloatSumsKeepTheirPrecisionHoweverLong) {
  for (const std::size_t size : {127UL, 5000UL, 1UL << 20, 5UL << 20}) {
    for (const float low : {0.0F, -1.0F}) {
      const auto in = random_values<float>(size, low, 1);
      std::vector<float> out(size);
      inclusive_scan(in, out);
      expect_precise(in, out, 8 * 0x1p-24);
      inclusive_scan(in, out, Plus<double>());
      expect_precise(in, out, 1e-12);
    }
  }
}

TEST(Scan, FloatSumOfOnesIsTheirNumber) {
  const std::size_t size = (std::size_t{1} << 24) + 1001;  // a float32 counter stops at 2²⁴
  const std::vector<float> ones(size, 1.0F);
  std::vector<float> out(size);
  inclusive_scan(ones, out);
  EXPECT_EQ(out.back(), static_cast<float>(size));
}

TEST(Scan, InfinityAndNanReachOnlyWhatIsBehindThem) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const std::size_t at : {0UL, 5UL, 300UL, 1023UL}) {
    std::vector<float> in(1100, 1), out(1100);
    in[at] = infinity;
    inclusive_scan(in, out);
    for (std::size_t i = 0; i < in.size(); ++i)
      EXPECT_EQ(out[i], i < at ? static_cast<float>(i + 1) : infinity) << i;
    in[at] = std::numeric_limits<float>::quiet_NaN();
    inclusive_scan(in, out);
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(std::isnan(out[i]), i >= at) << i;
  }
  std::vector<float> huge(1000, std::numeric_limits<float>::max());
  inclusive_scan(huge, huge);
  EXPECT_EQ(huge[0], std::numeric_limits<float>::max());
  EXPECT_EQ(huge.back(), infinity);
}

TEST(Scan, LongArraysAreWrittenPastTheCachesAtAnyAlignment) {
  const std::size_t size = 5'000'003;  // 40 MB in and out
  const auto in = random_values<std::uint32_t>(size, 0, 1U << 31);
  const std::vector<std::uint32_t> expected =
      slow_inclusive<std::uint32_t>(in, Plus<std::uint32_t>());
  ASSERT_TRUE(outgrows_cache(std::size_t{1} << 40));
  for (const std::size_t offset : {0UL, 1UL, 15UL}) {
    std::vector<std::uint32_t> out(size + 2 * 16, 7);
    inclusive_scan(in, std::span(out).subspan(offset, size));
    EXPECT_TRUE(
        std::equal(expected.begin(), expected.end(), out.begin() + static_cast<int>(offset)));
    for (std::size_t i = 0; i < offset; ++i) EXPECT_EQ(out[i], 7);
    for (std::size_t i = offset + size; i < out.size(); ++i) EXPECT_EQ(out[i], 7);
  }
}

TEST(Scan, SizesMustAgree) {
  const std::vector<int> in(5);
  std::vector<int> out(4);
  EXPECT_THROW(inclusive_scan(in, out), ShapeError);
  EXPECT_THROW(exclusive_scan(in, out), ShapeError);
}

TEST(Scan, PartialOverlapIsRefused) {
  std::vector<int> memory(10);
  const std::span all(memory);
  EXPECT_THROW(inclusive_scan(all.first(6), all.subspan(1, 6)), ValueError);
  EXPECT_THROW(exclusive_scan(all.subspan(1, 6), all.first(6)), ValueError);
  EXPECT_NO_THROW(exclusive_scan(all.first(5), all.last(5)));
  const std::span bytes(reinterpret_cast<unsigned char*>(memory.data()), 10);
  EXPECT_THROW(inclusive_scan(bytes, all), ValueError);  // same place, other size of elements
}

struct Fails {
  using value_type = int;
  int at;
  [[nodiscard]] int identity() const { return 0; }
  int operator()(int a, int b) const {
    if (b == at) throw std::runtime_error("refused");
    return std::max(a, b);
  }
};

TEST(Scan, ExceptionsOfTheOperationArePassedOn) {
  const int size = static_cast<int>(8 * scan_detail::kTile<int>);
  std::vector<int> in(static_cast<std::size_t>(size)), out(in.size());
  std::iota(in.begin(), in.end(), 0);
  for (const std::size_t threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    for (const int at : {0, 5, size / 2, size - 1})
      EXPECT_THROW(inclusive_scan(in, out, Fails{at}), std::runtime_error) << at;
  }
}

// What the standard library's does not do: libstdc++ 12's exclusive_scan with a policy gives wrong
// results in place, and both accumulate in the type of the initial value.
TEST(Scan, InPlaceExclusiveScanDoesNotReadItsOwnResults) {
  std::vector<int> values(100'000, 1);
  exclusive_scan(values, values);
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], static_cast<int>(i));
}

TEST(Scan, SumsOfBytesDoNotNarrow) {
  const std::vector<std::uint8_t> in(100'000, 255);
  std::vector<std::uint64_t> out(in.size());
  EXPECT_EQ(exclusive_scan(in, out), 25'500'000U);
  EXPECT_EQ(out.back(), 25'500'000U - 255);
  std::vector<float> floats(in.size());
  EXPECT_EQ(inclusive_scan(in, floats), 25'500'000.0);  // by way of float64
}

}  // namespace
}  // namespace relumbre
