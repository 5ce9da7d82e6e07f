#include "relumbre/radiosity/relight_operator.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/radiosity/compressed_operator.h"
#include "relumbre/radiosity/random_transport.h"

namespace relumbre {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr CountFormat kFormats[] = {CountFormat::kFloat32, CountFormat::kFloat16,
                                    CountFormat::kCounts16, CountFormat::kCounts8};

std::vector<float> relit(const RelightOperator& op, const std::vector<float>& emission,
                         std::size_t sources = 1) {
  std::vector<float> radiosity(emission.size(), -1.0F);
  op.apply(emission, radiosity, sources);
  return radiosity;
}

struct Shape {
  std::size_t elements, patches;
  std::uint32_t rays;
};

void PrintTo(const Shape& s, std::ostream* to) {
  *to << "n" << s.elements << "_k" << s.patches << "_rays" << s.rays;
}

class OperatorShape : public testing::TestWithParam<Shape> {
 protected:
  [[nodiscard]] static RandomTransport transport(float concentration = 0.3F) {
    const Shape& s = GetParam();
    RandomTransportConfig config;
    config.elements = s.elements, config.patches = s.patches, config.rays = s.rays;
    config.concentration = concentration;
    return random_transport(config);
  }
};

TEST_P(OperatorShape, EveryFormatMatchesTheDenseTwin) {
  const RandomTransport t = transport();
  const std::vector<float> emission = random_emission(3 * t.elements(), 5);
  const std::vector<double> expected = dense_relight(t, emission);
  for (const CountFormat format : kFormats) {
    const auto op = make_compressed_operator(t.input(), format);
    const double tolerance = format == CountFormat::kFloat16 ? 3e-4 : 1e-5;
    EXPECT_LT(relative_difference(relit(*op, emission), expected), tolerance) << to_string(format);
  }
}

TEST_P(OperatorShape, EveryInstructionSetMatchesTheDenseTwin) {
  const RandomTransport t = transport(0.7F);
  const std::vector<float> emission = random_emission(3 * t.elements(), 6);
  const std::vector<double> expected = dense_relight(t, emission);
  for (const RowKernels& kernels : available_row_kernels()) {
    for (const CountFormat format : kFormats) {
      const CompressedOperator op(t.input(), format, kernels);
      const double tolerance = format == CountFormat::kFloat16 ? 3e-4 : 1e-5;
      EXPECT_LT(relative_difference(relit(op, emission), expected), tolerance)
          << to_string(format) << ' ' << kernels.name;
    }
  }
}

TEST_P(OperatorShape, PaperOperatorMatchesTheDenseTwin) {
  const RandomTransport t = transport();
  const std::vector<float> emission = random_emission(6 * t.elements(), 7);
  const auto op = make_paper_operator(t.input());
  const std::vector<float> radiosity = relit(*op, emission, 2);
  for (std::size_t s = 0; s < 2; ++s) {
    const auto at = static_cast<std::ptrdiff_t>(s * 3 * t.elements());
    const auto length = static_cast<std::ptrdiff_t>(3 * t.elements());
    const std::vector<float> e(emission.begin() + at, emission.begin() + at + length);
    const std::vector<float> b(radiosity.begin() + at, radiosity.begin() + at + length);
    EXPECT_LT(relative_difference(b, dense_relight(t, e)), 1e-5);
  }
}

TEST_P(OperatorShape, BatchIsTheLoopOverItsSources) {
  const RandomTransport t = transport();
  constexpr std::size_t sources = 5;
  const std::size_t length = 3 * t.elements();
  const std::vector<float> emission = random_emission(sources * length, 8);
  for (const CountFormat format : kFormats) {
    const auto op = make_compressed_operator(t.input(), format);
    const std::vector<float> together = relit(*op, emission, sources);
    std::vector<float> alone(emission.size());
    for (std::size_t s = 0; s < sources; ++s)
      op->apply(std::span(emission).subspan(s * length, length),
                std::span(alone).subspan(s * length, length));
    EXPECT_EQ(together, alone) << to_string(format);
  }
}

INSTANTIATE_TEST_SUITE_P(Awkward, OperatorShape,
                         testing::Values(Shape{1, 1, 64}, Shape{2, 1, 512}, Shape{101, 1, 512},
                                         Shape{7, 7, 512}, Shape{97, 97, 1024}, Shape{251, 63, 512},
                                         Shape{251, 64, 512}, Shape{251, 65, 512},
                                         Shape{509, 131, 16384}, Shape{383, 149, 200'000},
                                         Shape{521, 257, 2'000'000}));

RandomTransport example(std::size_t elements = 1009, std::size_t patches = 211) {
  RandomTransportConfig config;
  config.elements = elements, config.patches = patches;
  return random_transport(config);
}

TEST(RelightOperator, ThreadsDoNotChangeABit) {
  const RandomTransport t = example(2003, 401);
  const std::vector<float> emission = random_emission(6 * t.elements(), 9);
  for (const CountFormat format : kFormats) {
    const auto op = make_compressed_operator(t.input(), format);
    std::vector<std::vector<float>> results;
    for (const std::size_t threads : {1, 2, 3, 8}) {
      const ThreadLimit limit(threads);
      results.push_back(relit(*op, emission, 2));
    }
    for (const auto& result : results) EXPECT_EQ(result, results.front()) << to_string(format);
  }
}

TEST(RelightOperator, EmissionAndRadiosityMayBeTheSame) {
  const RandomTransport t = example();
  const std::vector<float> emission = random_emission(3 * 3 * t.elements(), 10);
  const auto compressed = make_compressed_operator(t.input(), CountFormat::kCounts8);
  const auto paper = make_paper_operator(t.input());
  for (const RelightOperator* op : {static_cast<RelightOperator*>(compressed.get()), paper.get()}) {
    std::vector<float> in_place = emission;
    op->apply(in_place, in_place, 3);
    EXPECT_EQ(in_place, relit(*op, emission, 3)) << op->name();
  }
}

TEST(RelightOperator, PaperAndCompressedAgree) {
  const RandomTransport t = example();
  const std::vector<float> emission = random_emission(3 * t.elements(), 11);
  const std::vector<float> paper = relit(*make_paper_operator(t.input()), emission);
  for (const CountFormat format : kFormats) {
    const auto op = make_compressed_operator(t.input(), format);
    EXPECT_LT(relative_difference(relit(*op, emission), paper),
              format == CountFormat::kFloat16 ? 3e-4 : 1e-5);
  }
}

TEST(Furnace, RadiosityIsOneOverOneMinusRho) {
  RandomTransportConfig config;
  config.escaped = 0, config.empty_rows = false;
  config.elements = 307, config.patches = 71;
  RandomTransport t = random_transport(config);
  for (const float rho : {0.0F, 0.5F, 0.9F}) {
    t.reflectance.assign(t.elements(), Rgb(rho, rho / 2, 0));
    const std::vector<float> emission(3 * t.elements(), 2.0F);
    for (const CountFormat format : kFormats) {
      const std::vector<float> b = relit(*make_compressed_operator(t.input(), format), emission);
      for (std::size_t i = 0; i < t.elements(); ++i) {
        ASSERT_NEAR(b[3 * i], 2 / (1 - rho), 1e-4F / (1 - rho));
        ASSERT_NEAR(b[3 * i + 1], 2 / (1 - rho / 2), 1e-4F);
        ASSERT_EQ(b[3 * i + 2], 2.0F);
      }
    }
  }
}

TEST(RelightOperator, IsLinear) {
  const RandomTransport t = example();
  const auto op = make_compressed_operator(t.input(), CountFormat::kCounts8);
  const std::vector<float> a = random_emission(3 * t.elements(), 12);
  const std::vector<float> b = random_emission(3 * t.elements(), 13);
  std::vector<float> both(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) both[i] = 3 * a[i] - b[i];
  const std::vector<float> ra = relit(*op, a), rb = relit(*op, b);
  std::vector<float> sum(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] = 3 * ra[i] - rb[i];
  EXPECT_LT(relative_difference(relit(*op, both), sum), 2e-6);
}

TEST(RelightOperator, DarknessStaysDark) {
  const RandomTransport t = example();
  const std::vector<float> emission(3 * t.elements(), 0.0F);
  for (const CountFormat format : kFormats)
    EXPECT_EQ(relit(*make_compressed_operator(t.input(), format), emission), emission);
}

TEST(RelightOperator, AlbedoEditEqualsANewOperator) {
  RandomTransport t = example();
  const std::vector<float> emission = random_emission(3 * t.elements(), 14);
  for (const CountFormat format : kFormats) {
    t.reflectance = random_reflectance(t.elements(), 0.9F, 20);
    const auto edited = make_compressed_operator(t.input(), format);
    t.reflectance = random_reflectance(t.elements(), 0.6F, 21);
    edited->set_reflectance(t.reflectance);
    const auto fresh = make_compressed_operator(t.input(), format);
    EXPECT_EQ(relit(*edited, emission), relit(*fresh, emission)) << to_string(format);
    EXPECT_EQ(edited->bytes_per_apply(), fresh->bytes_per_apply());
  }
}

TEST(RelightOperator, ARefusedAlbedoEditChangesNothing) {
  const RandomTransport t = example();
  const std::vector<float> emission = random_emission(3 * t.elements(), 15);
  const auto op = make_compressed_operator(t.input(), CountFormat::kCounts8);
  const std::vector<float> before = relit(*op, emission);
  std::vector<Rgb> bright = t.reflectance;
  bright[17].y = 1.0F;
  EXPECT_THROW(op->set_reflectance(bright), ValueError);
  bright.pop_back();
  EXPECT_THROW(op->set_reflectance(bright), ShapeError);
  EXPECT_EQ(relit(*op, emission), before);
}

TEST(RelightOperator, APatchWithoutElementsIsHarmless) {
  RandomTransport t = example(53, 11);
  t.patch_offsets[4] = t.patch_offsets[3];
  const std::vector<float> emission = random_emission(3 * t.elements(), 16);
  const std::vector<float> b =
      relit(*make_compressed_operator(t.input(), CountFormat::kCounts8), emission);
  for (const float value : b) EXPECT_TRUE(std::isfinite(value));
}

TEST(RelightOperator, RefusesEmissionThatIsNotFinite) {
  const RandomTransport t = example();
  const auto compressed = make_compressed_operator(t.input(), CountFormat::kCounts8);
  const auto paper = make_paper_operator(t.input());
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    std::vector<float> emission = random_emission(6 * t.elements(), 17);
    emission[3 * (t.elements() + 500) + 2] = bad;
    std::vector<float> radiosity(emission.size(), -1.0F);
    const std::vector<float> untouched = radiosity;
    for (const RelightOperator* op :
         {static_cast<RelightOperator*>(compressed.get()), paper.get()}) {
      EXPECT_THAT([&] { op->apply(emission, radiosity, 2); },
                  ThrowsMessage<ValueError>(HasSubstr("source 1, element 500, channel 2")));
      EXPECT_EQ(radiosity, untouched);
    }
  }
}

TEST(RelightOperator, RefusesFieldsOfTheWrongSize) {
  const RandomTransport t = example();
  const auto op = make_compressed_operator(t.input(), CountFormat::kCounts8);
  std::vector<float> field(3 * t.elements());
  const std::span<float> all(field);
  EXPECT_THROW(op->apply(all.first(5), all.first(5)), ShapeError);
  EXPECT_THROW(op->apply(all, all.first(5)), ShapeError);
  EXPECT_THROW(op->apply(all, all, 2), ShapeError);
  EXPECT_THROW(op->apply(all, all, 0), ShapeError);
  EXPECT_THROW(op->apply(all, all, std::numeric_limits<std::size_t>::max()), ShapeError);
  EXPECT_NO_THROW(op->apply({}, {}, 0));
}

template <class Refusal>
void expect_refused(const RandomTransport& t, const std::string& reason) {
  EXPECT_THAT([&] { make_compressed_operator(t.input(), CountFormat::kCounts8); },
              ThrowsMessage<Refusal>(HasSubstr(reason)));
  EXPECT_THAT([&] { make_paper_operator(t.input()); }, ThrowsMessage<Refusal>(HasSubstr(reason)));
}

TEST(RelightOperator, RefusesReflectancesOutsideTheUnitInterval) {
  for (const float bad : {1.0F, -0.1F, std::numeric_limits<float>::quiet_NaN()}) {
    RandomTransport t = example(53, 11);
    t.reflectance[12].z = bad;
    expect_refused<ValueError>(t, "reflectance of element 12, channel 2");
  }
}

TEST(RelightOperator, RefusesInputsWhoseSizesDisagree) {
  RandomTransport t = example(53, 11);
  t.area.pop_back();
  expect_refused<ShapeError>(t, "52 areas for 53 elements");
  t = example(53, 11);
  t.reflectance.pop_back();
  expect_refused<ShapeError>(t, "52 reflectances for 53 elements");
  t = example(53, 11);
  t.patch_offsets.pop_back();
  expect_refused<ShapeError>(t, "11 patch offsets for 11 patches");
  t = example(53, 11);
  t.patch_offsets.back() = 52;
  expect_refused<ShapeError>(t, "patch offsets");
  t = example(53, 11);
  std::swap(t.patch_offsets[3], t.patch_offsets[5]);
  expect_refused<ShapeError>(t, "patch offsets");
}

TEST(RelightOperator, RefusesInvalidCountsAndAreas) {
  RandomTransport t = example(53, 11);
  t.counts.column[3] = 11;
  expect_refused<ValueError>(t, "column 11");
  t = example(53, 11);
  t.area[5] = 0;
  expect_refused<ValueError>(t, "area of element 5");
  t = example(53, 11);
  t.counts.columns = 50'000;
  t.patch_offsets.resize(50'001, 53);
  expect_refused<ValueError>(t, "50000 patches");
  EXPECT_THROW(make_compressed_operator({SparseCounts{}, {}, {}, {}}, CountFormat::kCounts8),
               ShapeError);
}

TEST(SmallestFormat, IsEightBitsUntilTheListIsLonger) {
  EXPECT_EQ(smallest_format(example().counts), CountFormat::kCounts8);
  RandomTransportConfig config;
  config.rays = 100'000;
  EXPECT_EQ(smallest_format(random_transport(config).counts), CountFormat::kCounts16);
}

}  // namespace
}  // namespace relumbre
