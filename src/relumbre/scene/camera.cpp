#include "relumbre/scene/camera.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/scene/json_fields.h"

namespace relumbre {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 20;

nlohmann::json to_json(const Vec3f& v) { return {v.x, v.y, v.z}; }

void check(const Camera& camera, const JsonFields& fields) {
  const Vec3f view = camera.target - camera.eye;
  if (!(length(view) > 0)) fields.fail("target", "must differ from 'eye'");
  if (!is_finite(normalized(view))) fields.fail("target", "is too far from 'eye'");
  if (!(length(cross(normalized(view), normalized(camera.up))) > 1e-6F)) {
    fields.fail("up", "must not be zero or along the view");
  }
  if (!(camera.vfov_deg > 0 && camera.vfov_deg < 180)) {
    fields.fail("vfov_deg", "must be between 0 and 180");
  }
}

}  // namespace

Camera parse_camera(std::string_view text, const std::string& file_name) {
  const nlohmann::json json = parse_json(text, file_name);
  const JsonFields fields(json, file_name, "");
  fields.allow_only({"name", "eye", "target", "up", "vfov_deg"});
  Camera camera;
  camera.name = fields.text("name", "");
  camera.eye = fields.vec3("eye");
  camera.target = fields.vec3("target");
  camera.up = fields.vec3("up", camera.up);
  camera.vfov_deg = fields.number("vfov_deg", camera.vfov_deg);
  check(camera, fields);
  return camera;
}

Camera read_camera(const std::filesystem::path& file) {
  return parse_camera(read_file(file, kMaxBytes), file.string());
}

void write_camera(const std::filesystem::path& file, const Camera& camera) {
  if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up) ||
      !std::isfinite(camera.vfov_deg)) {
    throw ValueError("camera '" + camera.name + "' has numbers that are not finite");
  }
  nlohmann::ordered_json json;
  if (!camera.name.empty()) json["name"] = camera.name;
  json["eye"] = to_json(camera.eye);
  json["target"] = to_json(camera.target);
  json["up"] = to_json(camera.up);
  json["vfov_deg"] = camera.vfov_deg;
  write_file(file, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace relumbre
