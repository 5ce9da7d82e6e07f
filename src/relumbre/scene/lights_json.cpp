#include "relumbre/scene/lights_json.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/exr.h"
#include "relumbre/scene/json_fields.h"
#include "relumbre/scene/overcast_sky.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 28;

using LightsByName = std::unordered_map<std::string, const Light*>;

Vec3f unit_vector(const JsonFields& fields, std::string_view key, const Vec3f& value) {
  // Scaled first: squares of very large or small components would leave the range of float.
  const float scale = std::max({std::abs(value.x), std::abs(value.y), std::abs(value.z)});
  if (!(scale > 0)) fields.fail(key, "must not be zero");
  return normalized(value / scale);
}

fs::path file_of(const JsonFields& fields, const fs::path& folder) {
  const fs::path file = fields.text("file");
  if (file.empty()) fields.fail("file", "must not be empty");
  return file.is_absolute() ? file : folder / file;
}

void read_point(const JsonFields& fields, const fs::path&, Light& light) {
  fields.allow_only({"name", "type", "color", "intensity", "on", "position"});
  light.position = fields.vec3("position");
}

void read_spot(const JsonFields& fields, const fs::path&, Light& light) {
  fields.allow_only({"name", "type", "color", "intensity", "on", "position", "direction",
                     "inner_deg", "outer_deg"});
  light.position = fields.vec3("position");
  light.direction = unit_vector(fields, "direction", fields.vec3("direction"));
  light.outer_deg = fields.number("outer_deg");
  light.inner_deg = fields.number("inner_deg", 0);
  if (!(light.outer_deg > 0 && light.outer_deg <= 90)) {
    fields.fail("outer_deg", "must be above 0 and at most 90");
  }
  if (!(light.inner_deg >= 0 && light.inner_deg <= light.outer_deg)) {
    fields.fail("inner_deg", "must be from 0 to outer_deg");
  }
}

void read_directional(const JsonFields& fields, const fs::path&, Light& light) {
  fields.allow_only({"name", "type", "color", "intensity", "on", "direction"});
  light.direction = unit_vector(fields, "direction", fields.vec3("direction"));
}

void read_quad(const JsonFields& fields, const fs::path&, Light& light) {
  fields.allow_only({"name", "type", "color", "intensity", "on", "corner", "edge1", "edge2"});
  light.position = fields.vec3("corner");
  light.edge1 = fields.vec3("edge1");
  light.edge2 = fields.vec3("edge2");
  const Vec3f normal = cross(light.edge1, light.edge2);
  if (!(length(normal) > 0) || !is_finite(normal)) {
    fields.fail("edge2", "must span an area together with 'edge1'");
  }
  light.direction = normalized(normal);
}

void read_ies_light(const JsonFields& fields, const fs::path& folder, Light& light) {
  fields.allow_only({"name", "type", "color", "intensity", "on", "file", "position", "direction",
                     "rotation_deg"});
  light.position = fields.vec3("position");
  light.direction = unit_vector(fields, "direction", fields.vec3("direction", light.direction));
  light.rotation_deg = fields.number("rotation_deg", 0);
  const fs::path file = file_of(fields, folder);
  light.file = file.string();
  light.ies = std::make_shared<const IesProfile>(read_ies(file));
}

std::shared_ptr<const Image> read_sky_image(const fs::path& file) {
  auto image = std::make_shared<const Image>(read_exr(file));
  for (const char* channel : {"R", "G", "B"}) {
    if (!image->has(channel)) {
      throw FileError(file.string(), std::string("a sky needs a channel ") + channel);
    }
    const bool radiance = std::ranges::all_of(image->channel(channel),
                                              [](float v) { return std::isfinite(v) && v >= 0; });
    if (!radiance) {
      throw FileError(file.string(), std::string("channel ") + channel +
                                         " of the sky has values that are negative or not finite");
    }
  }
  return image;
}

void read_sky(const JsonFields& fields, const fs::path& folder, Light& light) {
  fields.allow_only({"name", "type", "color", "intensity", "on", "file", "rotation_deg"});
  light.rotation_deg = fields.number("rotation_deg", 0);
  if (!fields.has("file")) {
    light.sky = std::make_shared<const Image>(overcast_sky());
    return;
  }
  const fs::path file = file_of(fields, folder);
  light.file = file.string();
  light.sky = read_sky_image(file);
}

struct Kind {
  const char* name;
  LightType type;
  void (*read)(const JsonFields&, const fs::path&, Light&);
};

constexpr Kind kKinds[] = {
    {"point", LightType::kPoint, read_point},
    {"spot", LightType::kSpot, read_spot},
    {"directional", LightType::kDirectional, read_directional},
    {"quad", LightType::kQuad, read_quad},
    {"ies", LightType::kIes, read_ies_light},
    {"sky", LightType::kSky, read_sky},
};

Rgb read_color(const JsonFields& fields) {
  const Rgb color = fields.vec3("color", Rgb(1.0F));
  if (color.x < 0 || color.y < 0 || color.z < 0) fields.fail("color", "must not be negative");
  return color;
}

float read_intensity(const JsonFields& fields) {
  const float intensity = fields.number("intensity", 1);
  if (intensity < 0) fields.fail("intensity", "must not be negative");
  return intensity;
}

Light adjusted(const JsonFields& fields, const LightsByName& scene_lights) {
  fields.allow_only({"name", "type", "color", "intensity", "on"});
  const auto found = scene_lights.find(fields.text("name"));
  if (found == scene_lights.end()) fields.fail("name", "is not that of a light of the scene");
  Light light = *found->second;
  light.color *= read_color(fields);
  light.intensity *= read_intensity(fields);
  light.on = fields.boolean("on", true);
  if (!is_finite(light.color * light.intensity)) fields.fail("intensity", "is too large");
  return light;
}

Light read_light(const JsonFields& fields, const std::string& default_name, const fs::path& folder,
                 const LightsByName& scene_lights) {
  const std::string type = fields.text("type");
  if (type == "scene") return adjusted(fields, scene_lights);
  const auto kind = std::ranges::find(kKinds, type, &Kind::name);
  if (kind == std::end(kKinds)) {
    fields.fail("type", "must be point, spot, directional, quad, ies, sky or scene");
  }
  Light light;
  light.name = fields.text("name", default_name);
  if (scene_lights.contains(light.name)) {
    fields.fail("name", "is that of a light of the scene: to adjust it, use type 'scene'");
  }
  light.type = kind->type;
  light.color = read_color(fields);
  light.intensity = read_intensity(fields);
  light.on = fields.boolean("on", true);
  if (!is_finite(light.color * light.intensity)) fields.fail("intensity", "is too large");
  kind->read(fields, folder, light);
  return light;
}

/// "light 2", or "light 2 'lamp'" where it has a name to show.
std::string describe(const nlohmann::json& light, std::size_t index) {
  std::string where = "light " + std::to_string(index);
  if (!light.is_object() || !light.contains("name") || !light["name"].is_string()) return where;
  std::string name = light["name"].get<std::string>().substr(0, 80);
  std::erase_if(name, [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  return where + " '" + name + "'";
}

const nlohmann::json& lights_array(const nlohmann::json& json, const std::string& file_name) {
  const nlohmann::json* array = &json;
  if (json.is_object()) {
    const JsonFields fields(json, file_name, "");
    fields.allow_only({"lights"});
    if (!fields.has("lights")) fields.fail("lights", "is missing");
    array = &json["lights"];
  }
  if (!array->is_array()) throw FileError(file_name, "must hold an array of lights");
  return *array;
}

}  // namespace

std::vector<Light> parse_lights(std::string_view text, const std::string& file_name,
                                const fs::path& folder, const Scene& scene) {
  const nlohmann::json json = parse_json(text, file_name);
  LightsByName scene_lights;
  for (const Light& light : scene.lights) scene_lights.emplace(light.name, &light);

  std::vector<Light> lights;
  std::unordered_set<std::string> names;
  for (const nlohmann::json& entry : lights_array(json, file_name)) {
    const std::size_t index = lights.size();
    const JsonFields fields(entry, file_name, describe(entry, index));
    lights.push_back(read_light(fields, "light " + std::to_string(index), folder, scene_lights));
    if (!names.insert(lights.back().name).second) fields.fail("name", "is used twice");
  }
  return lights;
}

std::vector<Light> read_lights(const fs::path& file, const Scene& scene) {
  return parse_lights(read_file(file, kMaxBytes), file.string(), file.parent_path(), scene);
}

std::vector<Light> combine_lights(std::span<const Light> scene_lights, std::span<const Light> read,
                                  bool use_scene_lights) {
  LightsByName adjustments;
  for (const Light& light : read) adjustments.emplace(light.name, &light);

  std::vector<Light> lights;
  for (const Light& light : scene_lights) {
    const auto found = adjustments.find(light.name);
    if (found != adjustments.end()) {
      lights.push_back(*found->second);
      adjustments.erase(found);
    } else if (use_scene_lights) {
      lights.push_back(light);
    }
  }
  for (const Light& light : read) {
    if (adjustments.contains(light.name)) lights.push_back(light);
  }
  return lights;
}

}  // namespace relumbre
