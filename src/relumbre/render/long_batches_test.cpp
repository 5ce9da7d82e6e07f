// A tracer that wants long batches, as a GPU does, gets them, and nothing else changes.
#include <algorithm>
#include <atomic>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/parallel.h"
#include "relumbre/render/direct_light.h"
#include "relumbre/render/lens_view.h"
#include "relumbre/render/view_test_support.h"
#include "relumbre/visibility/bvh_tracer.h"

namespace relumbre {
namespace {

/// The same hits whatever the batch; keeps the length of the longest.
class LongBatches final : public BvhTracer {
 public:
  LongBatches(const TriangleMesh& mesh, std::atomic<std::size_t>& longest)
      : BvhTracer(mesh), longest_(longest) {}
  using BvhTracer::closest, BvhTracer::occluded;
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const override {
    longest_ = std::max<std::size_t>(longest_, rays.size());
    BvhTracer::closest(rays, hits);
  }
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override {
    longest_ = std::max<std::size_t>(longest_, rays.size());
    BvhTracer::occluded(rays, blocked);
  }
  [[nodiscard]] std::size_t preferred_batch() const override { return 5000; }

 private:
  std::atomic<std::size_t>& longest_;
};

/// A room seen from outside, so that walls are culled, with a block in it, sky and lamps.
test::Lit room() {
  Scene scene;
  const std::uint32_t m = test::add_material(scene, Rgb(0.5F), Rgb(0.1F));
  test::add_room(scene, m, {-1, -1, -1}, {1, 1, 1});
  test::add_quad(scene, m, {-0.5F, -0.5F, -0.2F}, {1, 0, 0.2F}, {0, 0.8F, 0});
  test::Lit lit(std::move(scene), 20, 200);
  Light point;
  point.position = {0.3F, 0.2F, 0.5F};
  lit.lights = {point, test::quad_light({-0.2F, 0.9F, -0.2F}, {0, 0, 0.4F}, {0.4F, 0, 0})};
  for (std::size_t i = 0; i < 200; ++i) {
    lit.lit.emission[i] = Rgb(0.1F);
    lit.lit.direct_irradiance[i] = Rgb(0.01F * static_cast<float>(i));
    lit.lit.radiosity[i] = Rgb(0.2F + 0.02F * static_cast<float>(i));
  }
  return lit;
}

/// The room twice: traced in batches of any length, and in long ones.
struct Rooms {
  test::Lit lit = room();
  std::atomic<std::size_t> longest = 0;
  RayScene plain{std::make_unique<BvhTracer>(mesh()), ray_epsilon(mesh())};
  RayScene batched{std::make_unique<LongBatches>(mesh(), longest), ray_epsilon(mesh())};

  [[nodiscard]] const TriangleMesh& mesh() const { return lit.cut.scene.mesh; }
  [[nodiscard]] LitScene by(const RayScene& rays) const {
    return {lit.cut.scene,   lit.cut.tessellation, lit.display, rays,
            lit.reflectance, lit.lights,           lit.lit};
  }
  static Camera outside() {
    Camera camera;
    camera.eye = {0.4F, 0.3F, 4};
    return camera;
  }
};

void expect_equal(const Image& a, const Image& b) {
  ASSERT_EQ(a.channels().size(), b.channels().size());
  for (std::size_t c = 0; c < a.channels().size(); ++c) {
    EXPECT_EQ(a.channels()[c].name, b.channels()[c].name);
    EXPECT_TRUE(a.channels()[c].values == b.channels()[c].values) << a.channels()[c].name;
  }
}

TEST(LongBatches, DoNotChangeAView) {
  Rooms rooms;
  const ViewConfig config{
      .width = 61, .height = 47, .samples = 9, .mode = ViewMode::kDirectPerPixel, .layers = 2};
  expect_equal(render_view(rooms.by(rooms.batched), Rooms::outside(), config),
               render_view(rooms.by(rooms.plain), Rooms::outside(), config));
  EXPECT_GE(rooms.longest, 2000U);
}

TEST(LongBatches, DoNotChangeALensView) {
  Rooms rooms;
  LensViewConfig config;
  config.view = {.width = 61, .height = 47, .samples = 19, .mode = ViewMode::kDirectPerPixel};
  config.lens = {
      .focal_length_mm = 50, .f_number = 1, .focus_distance_m = 3, .sensor_width_mm = 36};
  expect_equal(render_lens_view(rooms.by(rooms.batched), Rooms::outside(), config),
               render_lens_view(rooms.by(rooms.plain), Rooms::outside(), config));
  EXPECT_GE(rooms.longest, 4000U);
}

TEST(LongBatches, DoNotChangeThePinholesDepth) {
  Rooms rooms;
  const auto depth = [&](const RayScene& rays) {
    return pinhole_depth(rooms.lit.cut.scene, rays, Rooms::outside(), 131, 67);
  };
  EXPECT_EQ(depth(rooms.batched), depth(rooms.plain));
  EXPECT_GE(rooms.longest, 4000U);
}

TEST(LongBatches, DoNotChangeDirectLight) {
  Rooms rooms;
  for (const Light& light : rooms.lit.lights) {
    const auto response = [&](const RayScene& rays) {
      return light_response(rooms.lit.cut.scene, rooms.lit.cut.tessellation, rays, light);
    };
    EXPECT_EQ(response(rooms.batched), response(rooms.plain));
  }
  EXPECT_GE(rooms.longest, 2000U);
}

}  // namespace
}  // namespace relumbre
