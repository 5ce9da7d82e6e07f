/// Pinhole cameras and cam.json.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "relumbre/base/vec3.h"

namespace relumbre {

struct Scene;

struct Camera {
  std::string name;
  Vec3f eye{0, 0, 1};
  Vec3f target{};
  Vec3f up{0, 1, 0};
  float vfov_deg = 45;
};

/// {"eye":[x,y,z],"target":[..],"up":[..],"vfov_deg":45}. Throws FileError naming the key.
Camera read_camera(const std::filesystem::path& file);
Camera parse_camera(std::string_view text, const std::string& file_name);
/// Atomically. Throws ValueError for numbers that are not finite, FileError.
void write_camera(const std::filesystem::path& file, const Camera& camera);

/// A camera that shows the scene: its first own camera where it has one, otherwise
///   - a box with one open side (walls on three of the four around): from in
///     front of the opening, looking straight in, so that the whole opening fits;
///   - a room (walls on all four sides) with a ceiling: from inside, in the corner with the longest
///     free view of the opposite one, at eye height;
///   - anything else, a room without a ceiling included: from outside, three quarters from above,
///     so that the bounding sphere fits.
/// A side counts as a wall where triangles lie along it over half of its area. O(triangles).
Camera auto_camera(const Scene& scene);

}  // namespace relumbre
