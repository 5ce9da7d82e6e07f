#include "relumbre/render/camera_rays.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

void expect_near(const Vec3f& a, const Vec3f& b, float tolerance = 1e-5F) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Camera camera() {
  Camera c;
  c.eye = {1, 2, 3};
  c.target = {1, 2, -5};
  c.vfov_deg = 90;
  return c;
}

TEST(CameraRays, CornersSpanTheFieldOfView) {
  const CameraRays rays(camera(), 400, 200);
  expect_near(rays.through(200, 100).direction, {0, 0, -1});
  expect_near(rays.through(0, 0).direction, {-2, 1, -1});
  expect_near(rays.through(400, 0).direction, {2, 1, -1});
  expect_near(rays.through(0, 200).direction, {-2, -1, -1});
  expect_near(rays.through(400, 200).direction, {2, -1, -1});
  EXPECT_EQ(rays.through(7, 9).origin, camera().eye);
}

TEST(CameraRays, AdvanceOneMetreAlongTheAxis) {
  Camera c = camera();
  c.target = {-3, 7, 1};
  c.vfov_deg = 33;
  const CameraRays rays(c, 37, 91);
  for (const Vec2f at : {Vec2f{0, 0}, Vec2f{37, 3}, Vec2f{20.5F, 90.5F}}) {
    EXPECT_NEAR(dot(rays.through(at.x, at.y).direction, rays.forward()), 1, 1e-5F);
  }
}

TEST(CameraRays, LookStraightDownWithAnyUp) {
  Camera c = camera();
  c.target = c.eye - Vec3f{0, 1, 0};
  const CameraRays rays(c, 10, 10);
  expect_near(rays.through(5, 5).direction, {0, -1, 0});
  EXPECT_TRUE(is_finite(rays.through(0, 0).direction));
  EXPECT_NEAR(length(rays.through(0, 0).direction), std::sqrt(3.0F), 1e-5F);
  c.up = {};
  EXPECT_TRUE(is_finite(CameraRays(c, 10, 10).through(0, 0).direction));
}

TEST(CameraRays, RefusesCamerasThatSeeNothing) {
  const auto refused = [](auto&& change) {
    Camera c = camera();
    change(c);
    EXPECT_THROW(CameraRays(c, 4, 4), ValueError);
  };
  refused([](Camera& c) { c.target = c.eye; });
  refused([](Camera& c) { c.eye.x = NAN; });
  refused([](Camera& c) { c.target.x = 3e38F, c.eye.x = -3e38F; });
  refused([](Camera& c) { c.up.y = INFINITY; });
  refused([](Camera& c) { c.vfov_deg = 0; });
  refused([](Camera& c) { c.vfov_deg = 180; });
  refused([](Camera& c) { c.vfov_deg = NAN; });
  EXPECT_THROW(CameraRays(camera(), 0, 4), ValueError);
  EXPECT_THROW(CameraRays(camera(), 4, 0), ValueError);
}

}  // namespace
}  // namespace relumbre
