#include "relumbre/radiosity/element_sampler.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/radiosity/ray_generator.h"

namespace relumbre {
namespace {

struct PlainRay {
  Vec3f origin, direction;
};

std::vector<PlainRay> unpack(std::span<const RayPacket> packets, std::size_t rays) {
  std::vector<PlainRay> result(rays);
  for (std::size_t r = 0; r < rays; ++r) {
    const RayPacket& packet = packets[r / 16];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result[r].origin[axis] = packet.origin[axis][r % 16];
      result[r].direction[axis] = packet.direction[axis][r % 16];
    }
  }
  return result;
}

std::vector<PlainRay> rays_of(const RayPattern& pattern, const EmittingSurface& surface,
                              const DigitalShift& shift) {
  std::vector<RayPacket> packets(pattern.packets());
  generate_rays(pattern, surface, shift, 0, packets);
  return unpack(packets, pattern.rays());
}

float shifted(const RayPattern& pattern, const DigitalShift& shift, std::size_t d, std::size_t r) {
  return to_unit(pattern.coordinate(d)[r] ^ shift[d]);
}

TEST(RayPattern, IsTheSobolSequenceInAnotherOrder) {
  for (const std::uint32_t rays : {1U, 15U, 16U, 17U, 500U}) {
    const RayPattern pattern(rays);
    ASSERT_EQ(pattern.packets(), (rays + 15) / 16);
    std::vector<std::uint32_t> found, expected;
    for (std::uint32_t r = 0; r < rays; ++r) {
      found.push_back(pattern.coordinate(1)[r]);
      expected.push_back(sobol4(r)[3]);
    }
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(found, expected);
    EXPECT_EQ(pattern.active(pattern.packets() - 1), (rays - 1) % 16 + 1);
  }
}

TEST(RayPattern, NeighboursGoMuchTheSameWay) {
  const RayPattern pattern(1024);
  double distance = 0;
  for (std::size_t r = 1; r < 1024; ++r) {
    for (const std::size_t d : {2U, 3U}) {
      distance +=
          std::abs(to_unit(pattern.coordinate(d)[r]) - to_unit(pattern.coordinate(d)[r - 1]));
    }
  }
  EXPECT_LT(distance / 1023, 0.1);  // 2/3 in random order
}

TEST(RayPattern, RefusesNoRaysAndTooMany) {
  EXPECT_THROW(RayPattern(0), ValueError);
  EXPECT_THROW(RayPattern((1U << 26) + 1), ValueError);
}

TEST(RayGenerator, MatchesTheScalarMaps) {
  const RayPattern pattern(1000);
  const DigitalShift shift = digital_shift(3, 5);
  EmittingSurface surface;
  const Vec3f a{1, 2, 3}, b{4, 1, 3.5F}, c{0, 3, 6};
  surface.add(a, b, c, 0);
  surface.finish();
  const Frame frame(normalized(cross(b - a, c - a)));
  const std::vector<PlainRay> rays = rays_of(pattern, surface, shift);
  for (std::size_t r = 0; r < rays.size(); ++r) {
    const Vec2f p =
        square_to_triangle(shifted(pattern, shift, 0, r), shifted(pattern, shift, 1, r));
    const Vec3f origin = a + (b - a) * p.x + (c - a) * p.y;
    const Vec3f direction = frame.to_world(
        square_to_cosine_hemisphere(shifted(pattern, shift, 2, r), shifted(pattern, shift, 3, r)));
    EXPECT_LT(length(rays[r].origin - origin), 1e-5F);
    // Towards the horizon the height is the root of a small difference.
    EXPECT_LT(length(rays[r].direction - direction), 1e-3F);
    EXPECT_NEAR(length(rays[r].direction), 1, 1e-6F);
  }
}

TEST(RayGenerator, AnyBatchIsPartOfTheWhole) {
  const RayPattern pattern(333);
  EmittingSurface surface;
  surface.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1e-4F);
  surface.add({1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 1e-4F);
  surface.finish();
  const DigitalShift shift = digital_shift(1, 2);
  const std::vector<PlainRay> whole = rays_of(pattern, surface, shift);
  std::vector<RayPacket> part(3);
  generate_rays(pattern, surface, shift, 7, part);
  const std::vector<PlainRay> rays = unpack(part, 48);
  for (std::size_t r = 0; r < rays.size(); ++r) {
    EXPECT_EQ(rays[r].origin, whole[7 * 16 + r].origin);
    EXPECT_EQ(rays[r].direction, whole[7 * 16 + r].direction);
  }
}

TEST(RayGenerator, FacetsGetRaysInProportionToTheirArea) {
  for (const std::size_t facets : {2U, 3U, 5U, 8U, 33U}) {
    EmittingSurface surface;  // triangle j, of area j + 1, stands at x = 100 j
    for (std::size_t j = 0; j < facets; ++j) {
      const Vec3f at{100.0F * static_cast<float>(j), 0, 0};
      const float size = std::sqrt(static_cast<float>(j + 1));
      surface.add(at, at + Vec3f{size, 0, 0}, at + Vec3f{0, size, 0}, 1e-5F);
    }
    surface.add({5, 5, 5}, {6, 6, 6}, {7, 7, 7}, 1e-5F);  // no area
    surface.finish();
    ASSERT_EQ(surface.size(), facets);
    std::vector<double> hits(facets);
    const RayPattern pattern(4096);
    for (const PlainRay& ray : rays_of(pattern, surface, digital_shift(9, facets))) {
      const auto facet = static_cast<std::size_t>(std::lround(std::floor(ray.origin.x / 99)));
      ASSERT_LT(facet, facets);
      const float size = std::sqrt(static_cast<float>(facet + 1));
      const float x = ray.origin.x - 100.0F * static_cast<float>(facet);
      EXPECT_GE(x, 0);
      EXPECT_GE(ray.origin.y, 0);
      EXPECT_LE(x + ray.origin.y, size);
      hits[facet] += 1;
    }
    const double all = static_cast<double>(facets * (facets + 1)) / 2;
    for (std::size_t j = 0; j < facets; ++j) {
      // Every 1/4096 of a one-dimensional projection of the sequence has one ray.
      EXPECT_NEAR(hits[j], 4096 * static_cast<double>(j + 1) / all, 2);
    }
  }
}

TEST(RayGenerator, DirectionsHaveCosineDensity) {
  const RayPattern pattern(4096);
  EmittingSurface surface;
  surface.add({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0);  // faces +x
  surface.finish();
  double cosine = 0, square = 0;
  for (const PlainRay& ray : rays_of(pattern, surface, digital_shift(4, 4))) {
    EXPECT_GT(ray.direction.x, 0);
    cosine += static_cast<double>(ray.direction.x) / 4096;
    square += static_cast<double>(ray.direction.x * ray.direction.x) / 4096;
  }
  EXPECT_NEAR(cosine, 2.0 / 3, 1e-3);
  EXPECT_NEAR(square, 1.0 / 2, 1e-3);
}

TEST(ElementSampler, PointsLieInsideTheElementsFacets) {
  const TriangleMesh mesh = shapes::sphere(12);
  TessellationConfig config;
  config.patches = 20, config.elements = 100;
  const Tessellation tessellation = tessellate(mesh, config);
  const float clearance = 1e-4F;
  const ElementSampler sampler(tessellation, 100, 1, clearance);
  EmittingSurface surface;
  std::vector<RayPacket> packets(sampler.pattern().packets());
  for (std::size_t e = 0; e < tessellation.elements(); ++e) {
    sampler.load(e, surface);
    EXPECT_NEAR(surface.area(), tessellation.area[e], 1e-5 * surface.area());
    sampler.generate(e, surface, 0, packets);
    for (const PlainRay& ray : unpack(packets, 100)) {
      std::size_t inside = 0;
      for (const Facet& facet : tessellation.facets_of(e)) {
        const Vec3f a = tessellation.positions[facet.corners[0]];
        const Vec3f u = tessellation.positions[facet.corners[1]] - a;
        const Vec3f v = tessellation.positions[facet.corners[2]] - a;
        const Vec3f n = cross(u, v), p = ray.origin - a;
        const float s = dot(cross(p, v), n) / dot(n, n), t = dot(cross(u, p), n) / dot(n, n);
        const float height = dot(p, normalized(n));
        inside += s > 0 && t > 0 && s + t < 1 && std::abs(height - clearance) < 1e-6F &&
                          dot(ray.direction, n) > 0
                      ? 1
                      : 0;
      }
      EXPECT_GE(inside, 1U);
    }
  }
}

TEST(ElementSampler, QuasiRandomErrorOnParallelSquares) {
  // Independent random rays have 7.6% and 3.4%.
  const double exact = 0.199824895698;
  EmittingSurface surface;
  surface.add({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, 0);
  surface.add({0, 0, 0}, {1, 1, 0}, {0, 1, 0}, 0);
  surface.finish();
  for (const auto& [count, limit] : {std::pair{1024U, 0.026}, std::pair{4096U, 0.012}}) {
    const RayPattern pattern(count);
    double squares = 0;
    for (std::uint64_t stream = 0; stream < 100; ++stream) {
      double hits = 0;
      for (const PlainRay& ray : rays_of(pattern, surface, digital_shift(1, stream))) {
        const Vec3f p = ray.origin + ray.direction / ray.direction.z;
        hits += p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1 ? 1 : 0;
      }
      squares += std::pow(hits / count / exact - 1, 2) / 100;
    }
    EXPECT_LT(std::sqrt(squares), limit);
    RecordProperty("relative_rmse_" + std::to_string(count), std::to_string(std::sqrt(squares)));
  }
}

TEST(ElementSampler, RefusesAnElementWithoutArea) {
  Tessellation tessellation;
  tessellation.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  tessellation.facets = {{{0, 1, 2}, 0, 0}};
  tessellation.facet_offsets = {0, 1};
  tessellation.area = {0};
  const ElementSampler sampler(tessellation, 16, 1, 0);
  EmittingSurface surface;
  EXPECT_THROW(sampler.load(0, surface), ValueError);
}

}  // namespace
}  // namespace relumbre
