#include "relumbre/scene/gltf_extras.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "relumbre/scene/affine.h"
#include "relumbre/scene/json_fields.h"

namespace relumbre {
namespace {

using nlohmann::json;

/// Lumens of 555 nm light a watt: SI's definition of the candela.
constexpr float kLumensPerWatt = 683;
constexpr float kDegrees = 180 / std::numbers::pi_v<float>;

Affine from_matrix(const std::vector<float>& m) {
  const auto column = [&](std::size_t c) {
    return Vec3d(Vec3f(m[4 * c], m[4 * c + 1], m[4 * c + 2]));
  };
  return {column(0), column(1), column(2), column(3)};
}

/// T · R · S, with the rotation a quaternion (x, y, z, w).
Affine from_parts(const Vec3d& t, const std::vector<float>& q, const Vec3d& s) {
  const Vec3d v = Vec3d(Vec3f(q[0], q[1], q[2]));
  const double w = static_cast<double>(q[3]);
  const double norm = dot(v, v) + w * w;
  const auto rotate = [&](const Vec3d& p) {
    if (!(norm > 0)) return p;
    return p + (cross(v, cross(v, p)) + cross(v, p) * w) * (2 / norm);
  };
  return {rotate({s.x, 0, 0}), rotate({0, s.y, 0}), rotate({0, 0, s.z}), t};
}

Affine local_transform(const JsonFields& node) {
  if (node.has("matrix")) return from_matrix(node.numbers("matrix", 16));
  const std::vector<float> rotation =
      node.has("rotation") ? node.numbers("rotation", 4) : std::vector<float>{0, 0, 0, 1};
  return from_parts(Vec3d(node.vec3("translation", {})), rotation,
                    Vec3d(node.vec3("scale", Vec3f(1.0F))));
}

class ExtrasReader {
 public:
  ExtrasReader(const json& document, const std::string& file_name, const GltfExtrasConfig& config)
      : root_(document, file_name, ""), file_name_(file_name), config_(config) {}

  GltfExtras run() {
    const json& scenes = root_.at("scenes");
    const json& scene = scenes[root_.index("scene", scenes.size(), 0)];
    const double scale = static_cast<double>(config_.scale);
    const Affine to_metres{{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, {}};
    if (scene.contains("nodes")) visit_all(scene["nodes"], to_metres);
    return std::move(result_);
  }

 private:
  void visit_all(const json& nodes, const Affine& parent) {
    for (const json& index : nodes) visit(index.get<std::size_t>(), parent);
  }

  void visit(std::size_t index, const Affine& parent) {
    const json& node_json = root_.at("nodes")[index];
    const JsonFields node(node_json, file_name_, "node " + std::to_string(index));
    const Affine world = parent * local_transform(node);
    if (node.has("camera")) add_camera(node, world);
    if (node.has("extensions")) {
      const JsonFields extensions = node.object("extensions");
      if (extensions.has("KHR_lights_punctual")) {
        add_light(node, extensions.object("KHR_lights_punctual"), world);
      }
    }
    if (node.has("children")) visit_all(node_json["children"], world);
  }

  /// Entry `index` of an array, as an object to read.
  JsonFields entry(const json& array, const JsonFields& user, const char* key) const {
    if (!array.is_array()) user.fail(key, "points into what is not an array");
    const std::size_t index = user.index(key, array.size());
    return {array[index], file_name_, std::string(key) + " " + std::to_string(index)};
  }

  void add_camera(const JsonFields& node, const Affine& world) {
    const JsonFields fields = entry(root_.at("cameras"), node, "camera");
    Camera camera;
    camera.name = node.text("name", fields.text("name", "camera"));
    if (fields.text("type") != "perspective") {
      result_.warnings.push_back("camera '" + camera.name + "' is orthographic and is left out");
      return;
    }
    const float yfov = fields.object("perspective").number("yfov");
    if (!(yfov > 0 && yfov < std::numbers::pi_v<float>)) {
      fields.fail("yfov", "must be between 0 and pi");
    }
    camera.vfov_deg = yfov * kDegrees;
    camera.eye = Vec3f(world.t);
    camera.target = camera.eye + direction(world, {0, 0, -1});
    camera.up = direction(world, {0, 1, 0});
    check_place(fields, camera.eye);
    result_.cameras.push_back(camera);
  }

  void add_light(const JsonFields& node, const JsonFields& use, const Affine& world) {
    const JsonFields lights = root_.object("extensions").object("KHR_lights_punctual");
    const JsonFields fields = entry(lights.at("lights"), use, "light");
    Light light;
    light.name = node.text("name", fields.text("name", "light"));
    set_type(fields, light);
    light.color = fields.vec3("color", Rgb(1.0F));
    light.intensity =
        fields.number("intensity", 1) / (config_.photometric_lights ? kLumensPerWatt : 1);
    if (light.color.x < 0 || light.color.y < 0 || light.color.z < 0) {
      fields.fail("color", "must not be negative");
    }
    if (light.intensity < 0) fields.fail("intensity", "must not be negative");
    light.position = Vec3f(world.t);
    light.direction = direction(world, {0, 0, -1});
    check_place(fields, light.position);
    result_.lights.push_back(std::move(light));
  }

  static void set_type(const JsonFields& fields, Light& light) {
    const std::string type = fields.text("type");
    if (type == "point") {
      light.type = LightType::kPoint;
    } else if (type == "directional") {
      light.type = LightType::kDirectional;
    } else if (type == "spot") {
      light.type = LightType::kSpot;
      set_cone(fields, light);
    } else {
      fields.fail("type", "must be point, spot or directional");
    }
  }

  static void set_cone(const JsonFields& fields, Light& light) {
    constexpr float widest = std::numbers::pi_v<float> / 2, rounding = 1e-5F;
    float inner = 0, outer = widest / 2;
    if (fields.has("spot")) {
      inner = fields.object("spot").number("innerConeAngle", inner);
      outer = fields.object("spot").number("outerConeAngle", outer);
    }
    if (!(outer > 0 && outer <= widest + rounding && inner >= 0 && inner <= outer)) {
      fields.fail("spot", "needs 0 <= innerConeAngle <= outerConeAngle <= pi/2");
    }
    light.inner_deg = inner * kDegrees;
    light.outer_deg = std::min(outer * kDegrees, 90.0F);
  }

  static void check_place(const JsonFields& fields, const Vec3f& position) {
    if (!is_finite(position)) fields.fail("its node moves it to infinity");
  }

  /// glTF's cameras and lights look along their node's -z; its scale does not matter.
  static Vec3f direction(const Affine& world, const Vec3d& local) {
    const Vec3d v = world.vector(local);
    return length(v) > 0 ? Vec3f(normalized(v)) : Vec3f(local);
  }

  JsonFields root_;
  const std::string& file_name_;
  const GltfExtrasConfig& config_;
  GltfExtras result_;
};

}  // namespace

GltfExtras read_gltf_extras(const json& document, const std::string& file_name,
                            const GltfExtrasConfig& config) {
  return ExtrasReader(document, file_name, config).run();
}

}  // namespace relumbre
