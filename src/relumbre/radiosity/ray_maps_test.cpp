#include "relumbre/radiosity/ray_maps.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/vec3.h"
#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/ray_generator.h"

namespace relumbre {
namespace {

/// Triangles of different sizes that face different ways.
EmittingSurface surface_of(std::size_t facets) {
  EmittingSurface surface;
  for (std::size_t j = 0; j < facets; ++j) {
    const auto f = static_cast<float>(j);
    const Vec3f a{f, 2 - f, 0.3F * f}, b{f + 1, 1, 2 * f}, c{-f, f * f, 1};
    surface.add(a, b, c, 1e-4F);
  }
  surface.finish();
  return surface;
}

Vec3f of_lane(const std::array<RayPacket::Lanes, 3>& values, std::size_t i) {
  return {values[0][i], values[1][i], values[2][i]};
}

TEST(RayMaps, MatchTheGeneratorOnWholePackets) {
  const RayPattern pattern(1024);
  const DigitalShift shift = digital_shift(3, 8);
  for (const std::size_t facets : {1U, 2U, 3U, 4U, 5U, 16U, 33U}) {
    const EmittingSurface surface = surface_of(facets);
    ASSERT_EQ(surface.size(), facets);
    std::vector<RayPacket> packets(pattern.packets());
    generate_rays(pattern, surface, shift, 0, packets);
    for (std::size_t r = 0; r < pattern.rays(); ++r) {
      const auto at = [&](std::size_t d) {
        return ray_maps::to_cell(pattern.coordinate(d)[r] ^ shift[d]);
      };
      ray_maps::Point point{at(0), at(1), at(2), at(3)};
      const std::uint32_t facet = ray_maps::choose_facet(
          surface.cumulative(), static_cast<std::uint32_t>(surface.size()), point.x);
      alignas(16) const EmittingSurface::Record record = surface.records()[facet];
      const ElementRay ray = element_ray(record.data(), point);
      const Vec3f origin{ray.origin_x, ray.origin_y, ray.origin_z};
      const Vec3f direction{ray.direction_x, ray.direction_y, ray.direction_z};
      // Rounding differs only where the CPU has no fused multiply-add.
      EXPECT_LT(length(origin - of_lane(packets[r / 16].origin, r % 16)), 4e-6F * length(origin));
      EXPECT_LT(length(direction - of_lane(packets[r / 16].direction, r % 16)), 1e-6F);
    }
  }
}

TEST(RayMaps, FacetsAreChosenByTheirShare) {
  const std::vector<float> cumulative{0, 0.25F, 0.25F, 0.5F, 1};
  const auto choose = [&](float x) { return ray_maps::choose_facet(cumulative.data(), 4, x); };
  EXPECT_EQ(choose(0), 0U);
  EXPECT_EQ(choose(0.2499F), 0U);
  EXPECT_EQ(choose(0.25F), 2U);
  EXPECT_EQ(choose(0.5F), 3U);
  EXPECT_EQ(choose(0.9999F), 3U);
  float x = 0.75F;
  ray_maps::choose_facet(cumulative.data(), 4, x);
  EXPECT_EQ(x, 0.5F);
}

}  // namespace
}  // namespace relumbre
