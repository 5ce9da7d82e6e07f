#include "relumbre/store/scene_json.h"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "relumbre/base/error.h"
#include "relumbre/scene/json_fields.h"

namespace relumbre {

namespace {

using nlohmann::json;

constexpr std::array<std::pair<LightType, std::string_view>, 5> kLightTypes{{
    {LightType::kPoint, "point"},
    {LightType::kSpot, "spot"},
    {LightType::kDirectional, "directional"},
    {LightType::kQuad, "quad"},
    {LightType::kEmitter, "emitter"},
}};

json to_json(const Vec3f& v) { return json::array({v.x, v.y, v.z}); }

json to_json(const Material& material) {
  json out = {{"name", material.name},
              {"reflectance", to_json(material.reflectance)},
              {"emission", to_json(material.emission)},
              {"two_sided", material.two_sided}};
  if (material.texture != kNone) out["texture"] = material.texture;
  return out;
}

json to_json(const Object& object) { return {{"name", object.name}}; }

json to_json(const Texture& texture) { return {{"name", texture.name}}; }

std::string_view type_name(const Light& light) {
  for (const auto& [type, name] : kLightTypes) {
    if (type == light.type) return name;
  }
  throw ValueError(fmt::format("light '{}' needs the file {}: it cannot be part of a store",
                               light.name, light.file));
}

json to_json(const Light& light) {
  json out = {{"name", light.name},
              {"type", type_name(light)},
              {"position", to_json(light.position)},
              {"direction", to_json(light.direction)},
              {"edge1", to_json(light.edge1)},
              {"edge2", to_json(light.edge2)},
              {"inner_deg", light.inner_deg},
              {"outer_deg", light.outer_deg},
              {"rotation_deg", light.rotation_deg},
              {"color", to_json(light.color)},
              {"intensity", light.intensity},
              {"on", light.on}};
  if (light.type == LightType::kEmitter) out["object"] = light.object;
  return out;
}

json to_json(const Camera& camera) {
  return {{"name", camera.name},
          {"eye", to_json(camera.eye)},
          {"target", to_json(camera.target)},
          {"up", to_json(camera.up)},
          {"vfov_deg", camera.vfov_deg}};
}

template <class T>
json list(const std::vector<T>& items) {
  json out = json::array();
  for (const T& item : items) out.push_back(to_json(item));
  return out;
}

void from_json(const JsonFields& fields, Material& material) {
  material.name = fields.text("name");
  material.reflectance = fields.vec3("reflectance");
  material.emission = fields.vec3("emission");
  material.two_sided = fields.boolean("two_sided", false);
  material.texture = static_cast<std::uint32_t>(fields.index("texture", kNone, kNone));
}

void from_json(const JsonFields& fields, Object& object) { object.name = fields.text("name"); }

void from_json(const JsonFields& fields, Texture& texture) { texture.name = fields.text("name"); }

LightType type_of(const JsonFields& fields) {
  const std::string found = fields.text("type");
  for (const auto& [type, name] : kLightTypes) {
    if (name == found) return type;
  }
  fields.fail("type", fmt::format("is '{}', which no stored light is", found));
}

void from_json(const JsonFields& fields, Light& light) {
  light.name = fields.text("name");
  light.type = type_of(fields);
  light.position = fields.vec3("position");
  light.direction = fields.vec3("direction");
  light.edge1 = fields.vec3("edge1");
  light.edge2 = fields.vec3("edge2");
  light.inner_deg = fields.number("inner_deg");
  light.outer_deg = fields.number("outer_deg");
  light.rotation_deg = fields.number("rotation_deg");
  light.color = fields.vec3("color");
  light.intensity = fields.number("intensity");
  light.on = fields.boolean("on", true);
  if (light.type == LightType::kEmitter) {
    light.object = static_cast<std::uint32_t>(fields.index("object", kNone));
  }
}

void from_json(const JsonFields& fields, Camera& camera) {
  camera.name = fields.text("name");
  camera.eye = fields.vec3("eye");
  camera.target = fields.vec3("target");
  camera.up = fields.vec3("up");
  camera.vfov_deg = fields.number("vfov_deg");
}

template <class T>
void read_list(const JsonFields& whole, const char* key, const std::string& file,
               std::vector<T>& items) {
  const json& entries = whole.at(key);
  if (!entries.is_array()) whole.fail(key, "is not an array");
  items.assign(entries.size(), {});
  for (std::size_t i = 0; i < items.size(); ++i) {
    from_json(JsonFields(entries[i], file, fmt::format("scene/description {}[{}]", key, i)),
              items[i]);
  }
}

}  // namespace

std::string scene_to_json(const Scene& scene) {
  const json out = {{"materials", list(scene.materials)},
                    {"objects", list(scene.objects)},
                    {"textures", list(scene.textures)},
                    {"lights", list(scene.lights)},
                    {"cameras", list(scene.cameras)}};
  return out.dump(-1, ' ', false, json::error_handler_t::ignore);
}

void scene_from_json(std::string_view text, const std::string& file_name, Scene& scene) {
  const json root = parse_json(text, file_name);
  const JsonFields whole(root, file_name, "scene/description");
  read_list(whole, "materials", file_name, scene.materials);
  read_list(whole, "objects", file_name, scene.objects);
  read_list(whole, "textures", file_name, scene.textures);
  read_list(whole, "lights", file_name, scene.lights);
  read_list(whole, "cameras", file_name, scene.cameras);
}

}  // namespace relumbre
