#include "relumbre/render/direct_light.h"

#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/render/test_support.h"

namespace relumbre {
namespace {

using test::Cut;
constexpr float kPi = std::numbers::pi_v<float>;

Light point_light(const Vec3f& position) {
  Light light;
  light.name = "point";
  light.position = position;
  return light;
}

/// The unit square at z = 0 that faces +z, in n elements; object 0.
Scene floor_scene() {
  Scene scene;
  test::add_quad(scene, test::add_material(scene, Rgb(0.5F)), {}, {1, 0, 0}, {0, 1, 0});
  return scene;
}

/// Midpoint rule over an element cut 64 · 64 times, in double.
double integrate(const Tessellation& t, std::size_t element, auto&& f) {
  double sum = 0, area = 0;
  constexpr int kSteps = 64;
  for (const Facet& facet : t.facets_of(element)) {
    const Vec3d a(t.positions[facet.corners[0]]), b(t.positions[facet.corners[1]]),
        c(t.positions[facet.corners[2]]);
    const double facet_area = length(cross(b - a, c - a)) / 2;
    area += facet_area;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps - i; ++j) {
        const auto mid = [&](double du) {
          return a + (b - a) * ((i + du) / kSteps) + (c - a) * ((j + du) / kSteps);
        };
        const double small = facet_area / (kSteps * kSteps);
        sum += f(mid(1.0 / 3)) * small;
        if (j < kSteps - i - 1) sum += f(mid(2.0 / 3)) * small;
      }
    }
  }
  return sum / area;
}

TEST(DirectLight, PointFollowsInverseSquareAndCosine) {
  const Cut cut(floor_scene(), 4, 61);
  const Light light = point_light({0.3F, 0.4F, 0.6F});
  const auto response =
      light_response(cut.scene, cut.tessellation, cut.rays, light, {.points_per_element = 4096});
  for (std::size_t i = 0; i < response.size(); ++i) {
    const double expected = integrate(cut.tessellation, i, [&](const Vec3d& p) {
      const Vec3d d = Vec3d(light.position) - p;
      return d.z / std::pow(length(d), 3);
    });
    EXPECT_NEAR(static_cast<double>(response[i].x), expected, 5e-4 * expected) << i;
    EXPECT_EQ(response[i], Rgb(response[i].x));
  }
}

TEST(DirectLight, PowerOfTheLightDoesNotChangeTheResponse) {
  const Cut cut(floor_scene(), 4, 16);
  Light light = point_light({0.3F, 0.4F, 0.6F});
  const auto bright = light_response(cut.scene, cut.tessellation, cut.rays, light);
  light.color = {0.5F, 0, 3}, light.intensity = 7, light.on = false;
  EXPECT_EQ(light_response(cut.scene, cut.tessellation, cut.rays, light), bright);
}

TEST(DirectLight, DirectionalIsTheCosineAndZeroFromBehind) {
  const Cut cut(floor_scene(), 2, 8);
  Light light;
  light.type = LightType::kDirectional;
  light.direction = normalized(Vec3f{1, 0, -1});
  for (const Rgb& r : light_response(cut.scene, cut.tessellation, cut.rays, light)) {
    EXPECT_NEAR(r.x, std::numbers::sqrt2_v<float> / 2, 1e-6F);
  }
  light.direction = -light.direction;
  for (const Rgb& r : light_response(cut.scene, cut.tessellation, cut.rays, light)) {
    EXPECT_EQ(r, Rgb{});
  }
}

TEST(DirectLight, SpotIsAPointInsideTheInnerConeAndDarkOutsideTheOuter) {
  Scene scene;
  const std::uint32_t material = test::add_material(scene, Rgb(0.5F));
  for (const float x : {0.0F, 1.0F, 4.0F}) {
    test::add_quad(scene, material, {x, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0});
  }
  const Cut cut(std::move(scene), 3, 3);
  Light light = point_light({0.05F, 0.05F, 1});
  const auto point = light_response(cut.scene, cut.tessellation, cut.rays, light);
  light.type = LightType::kSpot;
  light.direction = {0, 0, -1};
  light.inner_deg = 30, light.outer_deg = 60;
  const auto spot = light_response(cut.scene, cut.tessellation, cut.rays, light);
  EXPECT_NEAR(cut.mean(spot, 0).x, cut.mean(point, 0).x, 1e-6F);
  EXPECT_GT(cut.mean(spot, 1).x, 0.1F * cut.mean(point, 1).x);
  EXPECT_LT(cut.mean(spot, 1).x, 0.9F * cut.mean(point, 1).x);
  EXPECT_EQ(cut.mean(spot, 2), Rgb{});
}

TEST(DirectLight, UniformIesProfileIsAPoint) {
  const Cut cut(floor_scene(), 4, 16);
  Light light = point_light({0.3F, 0.4F, 0.6F});
  const auto point = light_response(cut.scene, cut.tessellation, cut.rays, light);
  auto profile = std::make_shared<IesProfile>();
  profile->vertical_deg = {0, 180};
  profile->horizontal_deg = {0};
  profile->candela = {120, 120};
  light.type = LightType::kIes;
  light.ies = profile;
  const auto ies = light_response(cut.scene, cut.tessellation, cut.rays, light);
  for (std::size_t i = 0; i < ies.size(); ++i) EXPECT_NEAR(ies[i].x, point[i].x, 1e-6F);
}

TEST(DirectLight, IesAxisAndRotationPointTheProfile) {
  const Cut cut(floor_scene(), 2, 2);
  Light light = point_light({0.5F, 0.5F, 2});
  light.type = LightType::kIes;
  light.direction = {0, 0, -1};
  auto profile = std::make_shared<IesProfile>();
  profile->vertical_deg = {0, 90};
  profile->horizontal_deg = {0};
  profile->candela = {1, 0};
  light.ies = profile;
  const auto down = light_response(cut.scene, cut.tessellation, cut.rays, light);
  EXPECT_GT(down[0].x, 0.1F);
  light.direction = {0, 0, 1};
  EXPECT_EQ(light_response(cut.scene, cut.tessellation, cut.rays, light)[0], Rgb{});
}

TEST(DirectLight, QuadMatchesParallelRectangles) {
  const Cut cut(floor_scene(), 4, 64);
  const Light light = test::quad_light({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  const auto response =
      light_response(cut.scene, cut.tessellation, cut.rays, light, {.points_per_element = 1024});
  EXPECT_NEAR(cut.mean(response, 0).x, 0.199824895698F, 5e-5F);
}

TEST(DirectLight, QuadShinesOnOneSideOnly) {
  const Cut cut(floor_scene(), 4, 16);
  const Light light = test::quad_light({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  const auto response = light_response(cut.scene, cut.tessellation, cut.rays, light);
  EXPECT_EQ(cut.mean(response, 0), Rgb{});
}

TEST(DirectLight, LightAMillimetreAwayIsAsBrightAsItself) {
  const Cut cut(floor_scene(), 4, 64);
  const Light light = test::quad_light({-1, -1, 0.001F}, {0, 3, 0}, {3, 0, 0});
  for (const Rgb& r : light_response(cut.scene, cut.tessellation, cut.rays, light)) {
    EXPECT_NEAR(r.x, 1, 1e-4F);
  }
}

TEST(DirectLight, TouchingPerpendicularEmitterMatchesClosedForm) {
  Scene scene = floor_scene();
  const std::uint32_t lamp = test::add_material(scene, Rgb(0.0F), Rgb{1, 2, 4});
  const std::uint32_t object = test::add_quad(scene, lamp, {}, {0, 1, 0}, {0, 0, 1});
  const Cut cut(std::move(scene), 4, 128);
  const auto response = light_response(cut.scene, cut.tessellation, cut.rays,
                                       test::emitter_light(object), {.points_per_element = 64});
  const Rgb mean = cut.mean(response, 0);
  EXPECT_NEAR(mean.x, 0.200043776075F, 1e-3F);
  EXPECT_NEAR(mean.z / mean.x, 4, 1e-4F);
  EXPECT_EQ(cut.mean(response, object), Rgb{});  // a plane does not light itself
}

TEST(DirectLight, EmitterEqualsQuad) {
  Scene scene = floor_scene();
  const std::uint32_t lamp = test::add_material(scene, Rgb(0.0F), Rgb(2.0F));
  const Light quad = test::quad_light({0.2F, 0.3F, 0.5F}, {0, 0.4F, 0}, {0.5F, 0, 0});
  const std::uint32_t object = test::add_quad(scene, lamp, quad.position, quad.edge1, quad.edge2);
  const Cut with_lamp(std::move(scene), 4, 64);
  const Cut bare(floor_scene(), 4, 64);
  const DirectLightConfig config{.points_per_element = 64, .light_samples = 16};
  const Rgb emitted =
      with_lamp.mean(light_response(with_lamp.scene, with_lamp.tessellation, with_lamp.rays,
                                    test::emitter_light(object), config),
                     0);
  const Rgb from_quad =
      bare.mean(light_response(bare.scene, bare.tessellation, bare.rays, quad, config), 0);
  EXPECT_NEAR(emitted.x, 2 * from_quad.x, 1e-3F * emitted.x);
}

TEST(DirectLight, EmitterShinesFromItsBackOnlyIfTwoSided) {
  for (const bool two_sided : {false, true}) {
    Scene scene = floor_scene();
    const std::uint32_t lamp = test::add_material(scene, Rgb(0.0F), Rgb(1.0F), two_sided);
    const std::uint32_t object = test::add_quad(scene, lamp, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
    const Cut cut(std::move(scene), 4, 64);
    const auto response =
        light_response(cut.scene, cut.tessellation, cut.rays, test::emitter_light(object));
    EXPECT_NEAR(cut.mean(response, 0).x, two_sided ? 0.1998F : 0.0F, 2e-3F);
  }
}

TEST(DirectLight, ClosedFurnaceIsExact) {
  Scene scene;
  const std::uint32_t material = test::add_material(scene, Rgb(0.5F), Rgb{1, 2, 3});
  test::add_room(scene, material, {-1, -1, -1}, {1, 1, 1});
  for (std::uint32_t& object : scene.mesh.object) object = 0;
  const Cut cut(std::move(scene), 12, 384);
  const auto response =
      light_response(cut.scene, cut.tessellation, cut.rays, test::emitter_light(0));
  for (const Rgb& r : response) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(r[c], static_cast<float>(c + 1), 1e-5F);
    }
  }
}

Light sky_light(std::size_t width, std::size_t height, auto&& radiance) {
  auto image = std::make_shared<Image>(rgb_image(width, height));
  for (std::size_t i = 0; i < image->pixels(); ++i) image->set_rgb(i, radiance(i / width));
  Light light;
  light.name = "sky";
  light.type = LightType::kSky;
  light.sky = image;
  return light;
}

TEST(DirectLight, UniformSkyGivesPiTimesRadiance) {
  Scene scene;
  test::add_quad(scene, test::add_material(scene, Rgb(0.5F)), {}, {0, 0, 1}, {1, 0, 0});
  const Cut cut(std::move(scene), 4, 64);
  const Light light = sky_light(16, 8, [](std::size_t) { return Rgb{1, 2, 0}; });
  const auto response = light_response(cut.scene, cut.tessellation, cut.rays, light);
  EXPECT_NEAR(cut.mean(response, 0).x, kPi, 2e-3F * kPi);
  EXPECT_NEAR(cut.mean(response, 0).y, 2 * kPi, 4e-3F * kPi);
  for (const Rgb& r : response) EXPECT_NEAR(r.x, kPi, 0.03F * kPi);
}

TEST(DirectLight, SkyIsAboveInItsFirstRows) {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F));
  test::add_quad(scene, m, {0, 1, 0}, {0, 0, 1}, {1, 0, 0});  // faces up
  test::add_quad(scene, m, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});  // faces down
  const Cut cut(std::move(scene), 2, 32);
  const Light light = sky_light(8, 4, [](std::size_t row) { return row < 2 ? Rgb(1.0F) : Rgb{}; });
  const auto response = light_response(cut.scene, cut.tessellation, cut.rays, light);
  EXPECT_NEAR(cut.mean(response, 0).x, kPi, 5e-3F * kPi);
  EXPECT_EQ(cut.mean(response, 1), Rgb{});
}

TEST(DirectLight, OccluderBlocksEveryKindOfLight) {
  Scene scene = floor_scene();
  const std::uint32_t wall = test::add_material(scene, Rgb(0.5F));
  test::add_quad(scene, wall, {-50, -50, 0.1F}, {100, 0, 0}, {0, 100, 0});
  const std::uint32_t lamp = test::add_material(scene, Rgb(0.0F), Rgb(1.0F));
  const std::uint32_t object = test::add_quad(scene, lamp, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  const Cut cut(std::move(scene), 4, 64);
  Light directional;
  directional.type = LightType::kDirectional;
  directional.direction = {0, 0, -1};
  Light sky = sky_light(4, 2, [](std::size_t) { return Rgb(1.0F); });
  for (const Light& light : {point_light({0.5F, 0.5F, 1}), directional, test::emitter_light(object),
                             test::quad_light({0, 0, 1}, {0, 1, 0}, {1, 0, 0})}) {
    const auto response = light_response(cut.scene, cut.tessellation, cut.rays, light);
    EXPECT_EQ(cut.mean(response, 0), Rgb{}) << light.name;
  }
  EXPECT_LT(cut.mean(light_response(cut.scene, cut.tessellation, cut.rays, sky), 0).x, 1e-3F);
}

TEST(DirectLight, LampsThatLieInASurfaceStillShine) {
  Scene scene = floor_scene();
  const std::uint32_t wall = test::add_material(scene, Rgb(0.5F));
  test::add_quad(scene, wall, {-1, -1, 1}, {0, 3, 0}, {3, 0, 0});  // a ceiling
  const Cut cut(std::move(scene), 8, 64);
  const Light quad = test::quad_light({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  EXPECT_NEAR(cut.mean(light_response(cut.scene, cut.tessellation, cut.rays, quad), 0).x, 0.1998F,
              5e-3F);
  const auto point =
      light_response(cut.scene, cut.tessellation, cut.rays, point_light({0.5F, 0.5F, 1}));
  for (const std::size_t i : cut.elements_of(0)) EXPECT_GT(point[i].x, 0.2F);
}

TEST(DirectLight, IsTheSameForAnyNumberOfThreads) {
  const Cut cut(floor_scene(), 4, 257);
  const Light light = test::quad_light({0, 0, 0.5F}, {0, 1, 0}, {1, 0, 0});
  std::vector<std::vector<Rgb>> results;
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const ThreadLimit limit(threads);
    results.push_back(light_response(cut.scene, cut.tessellation, cut.rays, light));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(DirectLight, SumsPowerTimesResponse) {
  std::vector<Light> lights(3);
  lights[0].color = {1, 0.5F, 0}, lights[0].intensity = 4;
  lights[1].on = false;
  lights[2].intensity = 2;
  const std::vector<LightResponse> responses = {
      std::make_shared<std::vector<Rgb>>(2, Rgb(1.0F)),
      std::make_shared<std::vector<Rgb>>(2, Rgb(100.0F)),
      std::make_shared<std::vector<Rgb>>(2, Rgb{1, 2, 3})};
  EXPECT_EQ(direct_irradiance(2, lights, responses), std::vector<Rgb>(2, Rgb{6, 6, 6}));
  EXPECT_EQ(direct_irradiance(2, {}, {}), std::vector<Rgb>(2));
  EXPECT_THROW(direct_irradiance(3, lights, responses), ShapeError);
  EXPECT_THROW(direct_irradiance(2, lights, std::span(responses).first(2)), ShapeError);
}

TEST(DirectLight, RefusesLightsThatCannotBe) {
  const Cut cut(floor_scene(), 2, 2);
  const auto response = [&](const Light& light, const DirectLightConfig& config = {}) {
    return light_response(cut.scene, cut.tessellation, cut.rays, light, config);
  };
  EXPECT_THROW(response(point_light({NAN, 0, 0})), ValueError);
  EXPECT_THROW(response(test::quad_light({}, {1, 0, 0}, {2, 0, 0})), ValueError);
  EXPECT_THROW(response(test::emitter_light(99)), ValueError);
  Light light;
  light.type = LightType::kSky;
  EXPECT_THROW(response(light), ValueError);
  light.type = LightType::kIes;
  EXPECT_THROW(response(light), ValueError);
  light.type = LightType::kSpot;
  light.direction = {};
  EXPECT_THROW(response(light), ValueError);
  EXPECT_THROW(response(sky_light(2, 1, [](std::size_t) { return Rgb(INFINITY); })), ValueError);
  EXPECT_THROW(response(point_light({}), {.points_per_element = 0}), ValueError);
  EXPECT_THROW(response(test::quad_light({}, {1, 0, 0}, {0, 1, 0}),
                        {.points_per_element = 1U << 20, .light_samples = 1U << 20}),
               ValueError);
}

TEST(DirectLight, ObjectWithoutEmissionBringsNothing) {
  const Cut cut(floor_scene(), 2, 2);
  const auto response =
      light_response(cut.scene, cut.tessellation, cut.rays, test::emitter_light(0));
  EXPECT_EQ(response, std::vector<Rgb>(2));
}

class Impatient final : public Progress {
  [[nodiscard]] bool cancelled() const override { return true; }
};

TEST(DirectLight, StopsWhenAsked) {
  const Cut cut(floor_scene(), 4, 64);
  Impatient impatient;
  EXPECT_THROW(
      light_response(cut.scene, cut.tessellation, cut.rays, point_light({0, 0, 1}), {}, impatient),
      Cancelled);
}

}  // namespace
}  // namespace relumbre
