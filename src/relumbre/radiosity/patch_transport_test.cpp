#include "relumbre/radiosity/patch_transport.h"

#include <gtest/gtest.h>

#include "relumbre/radiosity/random_transport.h"

namespace relumbre {
namespace {

/// M − I of the kind that contact edges give: a few large entries in a row of small ones.
std::vector<double> spiky_matrix(std::size_t k) {
  RandomStream random(k);
  std::vector<double> m(k * k);
  for (std::size_t p = 0; p < k; ++p) {
    for (std::size_t q = 0; q < k; ++q)
      m[p * k + q] = static_cast<double>(random.uniform()) / static_cast<double>(k);
    m[p * k + random.bits() % k] = 0.5;
  }
  return m;
}

std::vector<float> applied(const PatchTransport& transport, const std::vector<float>& e) {
  HugeBuffer operand(transport.operand_bytes());
  transport.pack(e.data(), operand.data());
  std::vector<float> y(e.size());
  transport.multiply(1, 0, e.size(), e.data(), operand.data(), y.data());
  return y;
}

TEST(PatchTransport, MultipliesByIdentityPlusTheMatrix) {
  for (const std::size_t k : {1U, 7U, 64U, 131U, 401U}) {
    const std::vector<double> m = spiky_matrix(k);
    const std::vector<float> e = random_emission(k, 3);
    std::vector<double> expected(e.begin(), e.end());
    for (std::size_t p = 0; p < k; ++p) {
      for (std::size_t q = 0; q < k; ++q) expected[p] += m[p * k + q] * static_cast<double>(e[q]);
    }
    for (const RowKernels& kernels : available_row_kernels()) {
      PatchTransport exact(k, TransportFormat::kFloat32, kernels);
      exact.set_channel(1, m);
      EXPECT_LT(relative_difference(applied(exact, e), expected), 1e-6) << kernels.name;
      PatchTransport fixed(k, TransportFormat::kFixed16, kernels);
      fixed.set_channel(1, m);
      EXPECT_LT(relative_difference(applied(fixed, e), expected), k < 128 ? 2e-5 : 1e-5)
          << kernels.name;
    }
  }
}

TEST(PatchTransport, FixedPointListsSpikesExactly) {
  const std::size_t k = 512;
  std::vector<double> m(k * k, 1e-4);
  for (std::size_t p = 0; p < k; ++p) m[p * k + (p + 1) % k] = 0.75;
  PatchTransport transport(k, TransportFormat::kFixed16);
  transport.set_channel(1, m);
  std::vector<float> lamp(k);
  lamp[7] = 1;
  const std::vector<float> y = applied(transport, lamp);
  EXPECT_FLOAT_EQ(y[6], 0.75F);
  EXPECT_FLOAT_EQ(y[7], 1.0001F);
  EXPECT_NEAR(y[100], 1e-4, 1e-8);  // a scale that reached 0.75 would be off by up to 6e-6
}

TEST(PatchTransport, NegativeRoundingIsTakenForZero) {
  PatchTransport transport(2, TransportFormat::kFixed16);
  transport.set_channel(1, std::vector<double>{-1e-18, 0.0, 0.0, -1e-18});
  EXPECT_EQ(applied(transport, {3.0F, 5.0F}), (std::vector<float>{3.0F, 5.0F}));
}

TEST(PatchTransport, FixedPointHalvesTheBytes) {
  const std::size_t k = 256;
  PatchTransport fixed(k, TransportFormat::kFixed16), exact(k, TransportFormat::kFloat32);
  for (std::size_t c = 0; c < 3; ++c) {
    fixed.set_channel(c, spiky_matrix(k));
    exact.set_channel(c, spiky_matrix(k));
  }
  EXPECT_EQ(exact.bytes(), 3 * k * k * 4);
  EXPECT_LT(fixed.bytes(), exact.bytes() * 6 / 10);
}

TEST(Interreflections, AreNonNegativeAndConserveEnergy) {
  RandomTransportConfig config;
  config.escaped = 0, config.empty_rows = false;
  RandomTransport t = random_transport(config);
  t.reflectance.assign(t.elements(), Rgb(0.8F));
  const CountMatrix counts(t.counts, CountFormat::kCounts8);
  const SegmentMean mean(t.patch_offsets, t.area);
  const std::vector<double> m = interreflections(counts, mean, t.reflectance, 0);
  for (std::size_t p = 0; p < t.patches(); ++p) {
    double sum = 0;
    for (std::size_t q = 0; q < t.patches(); ++q) {
      EXPECT_GE(m[p * t.patches() + q], -1e-12);
      sum += m[p * t.patches() + q];
    }
    // Σ over all orders of 0.8^j, where rays that bundles leave over escape
    EXPECT_NEAR(sum, 4.0, 1e-5);
  }
}

TEST(SegmentMean, MatchesTheAreaWeightedMean) {
  RandomTransportConfig config;
  config.elements = 1511, config.patches = 17;
  const RandomTransport t = random_transport(config);
  const std::vector<float> field = random_emission(3 * t.elements(), 2);
  for (const RowKernels& kernels : available_row_kernels()) {
    const SegmentMean mean(t.patch_offsets, t.area, kernels);
    std::vector<float> gathered(3 * t.patches());
    mean.gather(field.data(), 0, t.patches(), gathered.data());
    for (std::size_t c = 0; c < 3; ++c) {
      const std::vector<double> expected = patch_means(t, field, c);
      for (std::size_t p = 0; p < t.patches(); ++p)
        EXPECT_NEAR(static_cast<double>(gathered[c * t.patches() + p]), expected[p], 1e-5);
    }
  }
}

}  // namespace
}  // namespace relumbre
