#include "relumbre/visibility/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/visibility/ray_tracer.h"

namespace relumbre {

namespace {

void check_sizes(std::size_t rays, std::size_t results) {
  if (rays != results) {
    throw ShapeError(std::to_string(rays) + " rays but " + std::to_string(results) + " results");
  }
}

}  // namespace

float ray_epsilon(const TriangleMesh& mesh) {
  float largest = 0;
  for (const Vec3f& p : mesh.positions) {
    if (!is_finite(p)) continue;
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return 1e-5F * largest;
}

RayScene::RayScene(std::unique_ptr<const RayTracer> tracer, float epsilon)
    : tracer_(std::move(tracer)), epsilon_(epsilon) {}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

Hit RayScene::closest(const Ray& ray) const { return tracer_->closest(ray); }

bool RayScene::occluded(const Ray& ray) const { return tracer_->occluded(ray); }

void RayScene::closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const {
  tracer_->closest(rays, hits, active);
}

void RayScene::closest(std::span<const Ray> rays, std::span<Hit> hits) const {
  check_sizes(rays.size(), hits.size());
  tracer_->closest(rays, hits);
}

void RayScene::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
  check_sizes(rays.size(), blocked.size());
  tracer_->occluded(rays, blocked);
}

std::size_t RayScene::preferred_batch() const { return tracer_->preferred_batch(); }

std::size_t RayScene::bytes() const { return tracer_->bytes(); }

}  // namespace relumbre
