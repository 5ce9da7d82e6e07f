#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/cuda/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/radiosity/relight_cuda.h"

namespace relumbre::cuda {
namespace {

/// Random counts, patches and exchange; no scene is behind them.
struct RandomTransport {
  SparseCounts counts;
  std::vector<std::uint32_t> offsets;
  std::vector<float> weight;
  std::vector<Rgb> reflectance;
  std::array<std::vector<double>, 3> transport;

  /// `largest`: of a count.
  RandomTransport(std::size_t n, std::size_t k, std::uint32_t largest, std::uint64_t seed) {
    RandomStream random(seed);
    counts.columns = k;
    counts.rays = 40 * largest;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::uint32_t p = 0; p < k; ++p) {
        if (random.uniform() > 0.4F) continue;
        counts.column.push_back(p);
        const bool large = random.uniform() < 0.02F;
        const auto most = static_cast<float>(large ? largest : std::min(largest, 200U));
        counts.count.push_back(1 + static_cast<std::uint32_t>(random.uniform() * (most - 1)));
        if (counts.column.size() - counts.row_offsets.back() == 40) break;
      }
      counts.row_offsets.push_back(counts.column.size());
    }
    for (std::size_t p = 0; p <= k; ++p) offsets.push_back(static_cast<std::uint32_t>(p * n / k));
    for (std::size_t p = 0; p < k; ++p)
      for (std::uint32_t i = offsets[p]; i < offsets[p + 1]; ++i)
        weight.push_back(1.0F / static_cast<float>(offsets[p + 1] - offsets[p]));
    for (std::size_t i = 0; i < n; ++i)
      reflectance.push_back({random.uniform(), 0.9F * random.uniform(), 0.5F});
    for (auto& channel : transport)
      for (std::size_t q = 0; q < k * k; ++q)
        channel.push_back(static_cast<double>(random.uniform()) / static_cast<double>(k));
  }
  [[nodiscard]] RelightParts parts() const {
    return {counts, offsets, weight, reflectance, {transport[0], transport[1], transport[2]}};
  }

  /// B = E + R U M Vᵀ E, loop by loop, in doubles.
  [[nodiscard]] std::vector<double> relit(std::span<const float> emission) const {
    const std::size_t n = counts.rows(), k = counts.columns;
    std::vector<double> result(3 * n);
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<double> e(k), y(k);
      for (std::size_t p = 0; p < k; ++p)
        for (std::uint32_t i = offsets[p]; i < offsets[p + 1]; ++i)
          e[p] += static_cast<double>(weight[i]) * static_cast<double>(emission[3 * i + c]);
      for (std::size_t p = 0; p < k; ++p) {
        y[p] = e[p];
        for (std::size_t q = 0; q < k; ++q) y[p] += transport[c][p * k + q] * e[q];
      }
      for (std::size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (std::size_t at = counts.row_offsets[i]; at < counts.row_offsets[i + 1]; ++at)
          sum += counts.count[at] * y[counts.column[at]];
        result[3 * i + c] = static_cast<double>(emission[3 * i + c]) +
                            static_cast<double>(reflectance[i][c]) * sum / counts.rays;
      }
    }
    return result;
  }
};

std::vector<float> random_emission(std::size_t values, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<float> emission(values);
  for (float& e : emission) e = random.uniform() < 0.3F ? 1000 * random.uniform() : 0.0F;
  return emission;
}

/// Every source within `tolerance` of the largest B of the twin.
void expect_relit(const RandomTransport& scene, const RelightOperator& op, std::size_t sources,
                  double tolerance, const std::string& what) {
  const std::size_t per_source = 3 * scene.counts.rows();
  const std::vector<float> emission = random_emission(sources * per_source, 7);
  std::vector<float> radiosity(emission.size(), -1);
  op.apply(emission, radiosity, sources);
  for (std::size_t s = 0; s < sources; ++s) {
    const std::vector<double> wanted =
        scene.relit(std::span(emission).subspan(s * per_source, per_source));
    double largest = 0, worst = 0;
    for (std::size_t i = 0; i < per_source; ++i) {
      largest = std::max(largest, wanted[i]);
      const double off = std::abs(wanted[i] - static_cast<double>(radiosity[s * per_source + i]));
      worst = off <= worst ? worst : off;  // NaN is the worst
    }
    EXPECT_LE(worst, tolerance * largest) << what << ", source " << s;
  }
}

struct Size {
  std::size_t n, k;
};
constexpr Size kSizes[] = {{1, 1}, {15, 3}, {16, 16}, {33, 31}, {130, 65}, {257, 100}, {300, 216}};
constexpr CountFormat kFormats[] = {CountFormat::kCounts8, CountFormat::kCounts16,
                                    CountFormat::kFloat16};

TEST(RelightCuda, FusedPassIsTheProductInDoubles) {
  RELUMBRE_NEEDS_DEVICE();
  for (const auto& [n, k] : kSizes) {
    for (const CountFormat format : kFormats) {
      const RandomTransport scene(n, k, 200, n + k);
      const DeviceRelight op(scene.parts(), format);
      expect_relit(
          scene, op, 1, 3e-6,
          std::to_string(n) + " x " + std::to_string(k) + ", " + std::string(to_string(format)));
    }
  }
}

TEST(RelightCuda, CountsBeyondTheFormatAreExact) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(70, 50, 100'000, 3);
  for (const CountFormat format : {CountFormat::kCounts8, CountFormat::kCounts16})
    expect_relit(scene, DeviceRelight(scene.parts(), format), 1, 3e-6,
                 std::string(to_string(format)));
}

TEST(RelightCuda, BatchesAreTheSourcesOneByOne) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(50, 37, 300, 5);
  for (const CountFormat format : kFormats) {
    const DeviceRelight op(scene.parts(), format);
    for (const std::size_t sources : {2, 4, 5, 8, 9, 17})
      expect_relit(scene, op, sources, 3e-6,
                   std::string(to_string(format)) + ", " + std::to_string(sources) + " sources");
  }
}

TEST(RelightCuda, OperandLargerThanSharedMemoryGoesInChunks) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(17, 1950, 9, 11);
  const DeviceRelight op(scene.parts(), CountFormat::kCounts8);
  for (const std::size_t sources : {1, 8}) expect_relit(scene, op, sources, 3e-6, "chunks");
}

TEST(RelightCuda, LargeFieldsAreCopiedInParts) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(90'001, 3, 200, 43);
  const DeviceRelight op(scene.parts(), CountFormat::kCounts8);
  for (int i = 0; i < 2; ++i) expect_relit(scene, op, 1, 3e-6, "in parts");
}

TEST(RelightCuda, BrightAndFaintFieldsKeepTheirDigits) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(40, 20, 200, 13);
  const DeviceRelight op(scene.parts(), CountFormat::kCounts8);
  for (const float scale : {1e-30F, 1e-12F, 1e6F, 1e20F}) {
    std::vector<float> emission = random_emission(120, 3), radiosity(120);
    for (float& e : emission) e *= scale;
    op.apply(emission, radiosity);
    const std::vector<double> wanted = scene.relit(emission);
    for (std::size_t i = 0; i < 120; ++i)
      EXPECT_NEAR(static_cast<double>(radiosity[i]), wanted[i],
                  1e-5 * wanted[i] + 1e-6 * static_cast<double>(scale))
          << scale;
  }
}

TEST(RelightCuda, NoLightIsNoLight) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(33, 9, 200, 17);
  std::vector<float> radiosity(99, 1);
  DeviceRelight(scene.parts(), CountFormat::kCounts8).apply(std::vector<float>(99), radiosity);
  for (const float b : radiosity) EXPECT_EQ(b, 0);
}

TEST(RelightCuda, OwnBuffersNeedNoCopies) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(100, 10, 200, 19);
  const DeviceRelight op(scene.parts(), CountFormat::kCounts16);
  const std::vector<float> emission = random_emission(300, 23);
  std::vector<float> radiosity(300);
  op.apply(emission, radiosity);
  std::copy(emission.begin(), emission.end(), op.emission().begin());
  for (int i = 0; i < 2; ++i) op.relight();
  for (std::size_t i = 0; i < 300; ++i) EXPECT_EQ(op.radiosity()[i], radiosity[i]);
}

TEST(RelightCuda, NewReflectancesAreThoseOfANewOperator) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport before(60, 12, 200, 29), scene(60, 12, 200, 31);
  RandomTransport mixed = before;
  mixed.reflectance = scene.reflectance;
  mixed.transport = scene.transport;
  DeviceRelight op(before.parts(), CountFormat::kCounts8);
  op.set_reflectance(mixed.reflectance, mixed.parts().transport);
  expect_relit(mixed, op, 1, 3e-6, "edited");
}

TEST(RelightCuda, PapersStagesAgreeWithTheProductInDoubles) {
  RELUMBRE_NEEDS_DEVICE();
  for (const auto& [n, k] : kSizes) {
    const RandomTransport scene(n, k, 200, n);
    for (const PaperStage stage : kPaperStages)
      for (const double share : {0.3, 0.0, 1.0})
        if (stage == PaperStage::kSplitRows || share == 0.3)
          expect_relit(scene, PaperRelight(scene.parts(), stage, share), 2, 1e-5,
                       std::string(to_string(stage)) + ", " + std::to_string(n));
  }
}

TEST(RelightCuda, WhatIsNotFiniteIsNamed) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport scene(40, 7, 200, 37);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const std::size_t sources : {1, 3}) {
      std::vector<float> emission(120 * sources), radiosity(emission.size());
      emission[emission.size() - 119] = bad;  // element 0, channel 1 of the last source
      try {
        DeviceRelight(scene.parts(), CountFormat::kCounts8).apply(emission, radiosity, sources);
        FAIL() << "accepted";
      } catch (const ValueError& error) {
        EXPECT_NE(std::string(error.what()).find("element 0, channel 1"), std::string::npos)
            << error.what();
      }
    }
  }
}

TEST(RelightCuda, BadPartsAreRefused) {
  RELUMBRE_NEEDS_DEVICE();
  RandomTransport scene(40, 7, 200, 41);
  EXPECT_THROW(DeviceRelight(scene.parts(), CountFormat::kFloat32), ValueError);
  EXPECT_THROW(PaperRelight(scene.parts(), PaperStage::kSplitRows, 1.5), ValueError);
  scene.offsets.back() = 39;
  EXPECT_THROW(DeviceRelight(scene.parts(), CountFormat::kCounts8), ShapeError);
  scene.offsets.back() = 40;
  scene.transport[2].pop_back();
  EXPECT_THROW(DeviceRelight(scene.parts(), CountFormat::kCounts8), ShapeError);
  scene.transport[2].push_back(0);
  scene.reflectance[3].y = 1;
  EXPECT_THROW(DeviceRelight(scene.parts(), CountFormat::kCounts8), ValueError);
}

}  // namespace
}  // namespace relumbre::cuda
