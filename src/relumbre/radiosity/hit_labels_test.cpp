#include "relumbre/radiosity/hit_labels.h"

#include <numeric>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

/// Half of the points lie on the cuts.
float coordinate(RandomStream& random) {
  const float x = random.uniform();
  return random.uniform() < 0.5F ? x : std::round(x * 16) / 16;
}

TEST(HitLabels, MatchTheLocator) {
  const TriangleMesh mesh = shapes::soup(40, 3);  // a third of it two-sided
  TessellationConfig config;
  config.patches = 30, config.elements = 900;
  const Tessellation tessellation = tessellate(mesh, config);
  const LabelLocator locator = prune(tessellation.locator, tessellation.element_of_facet());
  RandomStream random(1);
  std::size_t absorbed = 0;
  for (int round = 0; round < 2000; ++round) {
    HitPacket hits;
    for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
      hits.triangle[i] = static_cast<std::uint32_t>(random.bits() % 41);
      if (hits.triangle[i] == 40) hits.triangle[i] = kNone;
      hits.back[i] = static_cast<std::uint32_t>(random.bits() % 2);
      hits.u[i] = coordinate(random);
      hits.v[i] = (1 - hits.u[i]) * coordinate(random);
    }
    HitLabels labels;
    find_labels(locator, hits, labels);
    for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
      if (hits.triangle[i] == kNone) {
        EXPECT_EQ(labels[i], kEscaped);
        continue;
      }
      const std::uint32_t expected =
          locator.find(hits.triangle[i], hits.back[i] != 0, hits.u[i], hits.v[i]);
      EXPECT_EQ(labels[i], expected == kNone ? kAbsorbed : expected);
      absorbed += expected == kNone ? 1 : 0;
    }
  }
  EXPECT_GT(absorbed, 1000U);
}

}  // namespace
}  // namespace relumbre
