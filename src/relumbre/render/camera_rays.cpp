#include "relumbre/render/camera_rays.h"

#include <numbers>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void check(const Camera& camera, std::size_t width, std::size_t height) {
  const auto refuse = [&](std::string_view reason) {
    throw ValueError(fmt::format("camera '{}': {}", camera.name, reason));
  };
  const float distance = length(camera.target - camera.eye);
  if (!std::isfinite(distance)) refuse("eye or target is not finite, or too far away");
  if (!(distance > 0)) refuse("eye and target coincide");
  if (!is_finite(camera.up)) refuse("up is not finite");
  if (!(camera.vfov_deg > 0 && camera.vfov_deg < 180)) {
    refuse(fmt::format("vfov_deg is {}, not between 0 and 180", camera.vfov_deg));
  }
  if (width == 0 || height == 0) refuse("the image has no pixels");
}

}  // namespace

CameraRays::CameraRays(const Camera& camera, std::size_t width, std::size_t height) {
  check(camera, width, height);
  eye_ = camera.eye;
  forward_ = normalized(camera.target - camera.eye);
  const Vec3f right = cross(forward_, normalized(camera.up));
  right_ = length(right) > 1e-5F ? normalized(right) : Frame(forward_).t;
  up_ = cross(right_, forward_);

  const float half_height = std::tan(camera.vfov_deg * std::numbers::pi_v<float> / 360);
  const float pixel = 2 * half_height / static_cast<float>(height);
  pixels_per_tangent_ = 1 / static_cast<double>(pixel);
  step_x_ = right_ * pixel;
  step_y_ = up_ * -pixel;
  corner_ = forward_ + up_ * half_height - step_x_ * (static_cast<float>(width) / 2);
}

Ray CameraRays::through(float x, float y) const {
  return {.origin = eye_, .direction = corner_ + step_x_ * x + step_y_ * y};
}

Ray CameraRays::through_lens(float x, float y, const Vec2f& lens, float focus_distance) const {
  const Vec3f offset = right_ * lens.x + up_ * lens.y;
  const Ray pinhole = through(x, y);
  return {.origin = eye_ + offset, .direction = pinhole.direction - offset / focus_distance};
}

}  // namespace relumbre
