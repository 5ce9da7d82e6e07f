#include "relumbre/scene/gltf_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/png.h"
#include "relumbre/scene/gltf_output.h"

namespace relumbre {

namespace {

using Json = nlohmann::json;

constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180;

void check_vertices(std::span<const Vec3f> vectors, const char* what) {
  for (std::size_t i = 0; i < vectors.size(); ++i)
    if (!is_finite(vectors[i]))
      throw ValueError("glTF: " + std::string(what) + " " + std::to_string(i) +
                       " is not a finite number");
}

void check_scene(const Scene& scene) {
  const TriangleMesh& mesh = scene.mesh;
  check_vertices(mesh.positions, "vertex");
  check_vertices(scene.shading_normals, "shading normal");
  check_vertices(scene.colors, "vertex colour");
  const std::size_t vertices = mesh.positions.size();
  if ((!scene.texcoords.empty() && scene.texcoords.size() != vertices) ||
      (!scene.colors.empty() && scene.colors.size() != vertices) ||
      (!scene.shading_normals.empty() && scene.shading_normals.size() != vertices) ||
      mesh.material.size() != mesh.triangles.size() || mesh.object.size() != mesh.triangles.size())
    throw ValueError("glTF: the scene's arrays disagree in length");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const bool corners = std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(),
                                     [&](std::uint32_t v) { return v < vertices; });
    if (!corners || mesh.material[t] >= scene.materials.size() ||
        mesh.object[t] >= scene.objects.size())
      throw ValueError("glTF: triangle " + std::to_string(t) + " has an index out of range");
  }
}

/// The PNG file's bytes, by way of a temporary file beside the target.
std::string encoded(const Texture& texture, const std::filesystem::path& target) {
  std::filesystem::path name = target;
  const AtomicFile scratch(name.replace_extension(".texture.png"));
  write_png(scratch.path(), texture.rgb, texture.width, texture.height);
  return read_file(scratch.path());
}

void add_textures(GltfOutput& out, const Scene& scene, const std::filesystem::path& target) {
  for (const Texture& texture : scene.textures) {
    const std::size_t view = out.add_view(encoded(texture, target));
    const std::size_t image = out.append(
        "images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", texture.name}});
    out.append("textures", {{"source", image}, {"name", texture.name}});
  }
}

void add_emission(GltfOutput& out, Json& entry, const Rgb& emission) {
  const float strength = std::max(1.0F, max_component(emission));
  entry["emissiveFactor"] = to_json(emission / strength);
  if (strength == 1) return;
  entry["extensions"]["KHR_materials_emissive_strength"] = {
      {"emissiveStrength", short_decimal(strength)}};
  out.use_extension("KHR_materials_emissive_strength");
}

void add_materials(GltfOutput& out, const Scene& scene) {
  for (const Material& material : scene.materials) {
    if (!is_finite(material.reflectance) || !is_finite(material.emission))
      throw ValueError("glTF: material '" + material.name + "' is not finite");
    Json color = to_json(material.reflectance);
    color.push_back(1);
    Json surface{{"baseColorFactor", color}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    if (material.texture < scene.textures.size() && !scene.texcoords.empty())
      surface["baseColorTexture"] = {{"index", material.texture}};
    Json entry{{"name", material.name},
               {"pbrMetallicRoughness", surface},
               {"doubleSided", material.two_sided}};
    if (material.emissive()) add_emission(out, entry, material.emission);
    out.append("materials", entry);
  }
}

/// Triangles of one object by material, the materials in ascending order.
using Primitives = std::map<std::uint32_t, std::vector<std::uint32_t>>;

std::vector<Primitives> triangles_by_object(const Scene& scene) {
  std::vector<Primitives> objects(scene.objects.size());
  for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
    objects[scene.mesh.object[t]][scene.mesh.material[t]].push_back(t);
  return objects;
}

/// The vertices that some triangles use, numbered from 0 in order of appearance.
class VertexSubset {
 public:
  explicit VertexSubset(std::size_t vertices) : local_(vertices, kNone) {}

  /// Replaces the subset. O(triangles), not O(vertices).
  void select(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
    for (const std::uint32_t v : vertices_) local_[v] = kNone;
    vertices_.clear();
    indices_.clear();
    for (const std::uint32_t t : triangles)
      for (const std::uint32_t v : mesh.triangles[t]) indices_.push_back(number(v));
  }
  [[nodiscard]] std::span<const std::uint32_t> indices() const { return indices_; }
  template <class T>
  [[nodiscard]] std::vector<T> gather(const std::vector<T>& values) const {
    std::vector<T> chosen;
    chosen.reserve(vertices_.size());
    for (const std::uint32_t v : vertices_) chosen.push_back(values[v]);
    return chosen;
  }

 private:
  std::uint32_t number(std::uint32_t v) {
    if (local_[v] == kNone) {
      local_[v] = static_cast<std::uint32_t>(vertices_.size());
      vertices_.push_back(v);
    }
    return local_[v];
  }

  std::vector<std::uint32_t> local_, vertices_, indices_;
};

Json make_primitive(GltfOutput& out, const Scene& scene, const VertexSubset& subset,
                    std::uint32_t material) {
  Json attributes{{"POSITION", out.add_positions(subset.gather(scene.mesh.positions))}};
  if (!scene.shading_normals.empty())
    attributes["NORMAL"] = out.add_vectors(subset.gather(scene.shading_normals));
  if (!scene.texcoords.empty())
    attributes["TEXCOORD_0"] = out.add_texcoords(subset.gather(scene.texcoords));
  if (!scene.colors.empty()) attributes["COLOR_0"] = out.add_vectors(subset.gather(scene.colors));
  return {{"attributes", attributes},
          {"indices", out.add_indices(subset.indices())},
          {"material", material}};
}

void add_node(GltfOutput& out, Json node) {
  const std::size_t index = out.append("nodes", std::move(node));
  out.json["scenes"][0]["nodes"].push_back(index);
}

void add_objects(GltfOutput& out, const Scene& scene) {
  VertexSubset subset(scene.mesh.positions.size());
  const std::vector<Primitives> objects = triangles_by_object(scene);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Json primitives = Json::array();
    for (const auto& [material, triangles] : objects[i]) {
      subset.select(scene.mesh, triangles);
      primitives.push_back(make_primitive(out, scene, subset, material));
    }
    if (primitives.empty()) continue;
    const std::string& name = scene.objects[i].name;
    const auto mesh = out.append("meshes", {{"name", name}, {"primitives", primitives}});
    add_node(out, {{"name", name}, {"mesh", mesh}});
  }
}

/// The rotation that takes -z to `forward` and +y as near to `up` as it can, as (x, y, z, w).
/// Source: Shepperd 1978, for the choice of the largest component.
Json look_rotation(const Vec3f& forward, const Vec3f& up) {
  const Vec3d z = normalized(-Vec3d(forward));
  Vec3d x = cross(Vec3d(up), z);
  if (length(x) < 1e-6) x = cross(Vec3d(std::abs(z.y) < 0.9 ? Vec3f(0, 1, 0) : Vec3f(1, 0, 0)), z);
  x = normalized(x);
  const Vec3d y = cross(z, x);
  const std::array<double, 4> squares{1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z, 1 - x.x - y.y + z.z,
                                      1 + x.x + y.y + z.z};
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  const double s = 2 * std::sqrt(squares[static_cast<std::size_t>(largest)]);
  const double yz = y.z + z.y, zx = z.x + x.z, xy = x.y + y.x;
  const double wx = y.z - z.y, wy = z.x - x.z, wz = x.y - y.x;
  if (largest == 0) return {s / 4, xy / s, zx / s, wx / s};
  if (largest == 1) return {xy / s, s / 4, yz / s, wy / s};
  if (largest == 2) return {zx / s, yz / s, s / 4, wz / s};
  return {wx / s, wy / s, wz / s, s / 4};
}

/// The light as KHR_lights_punctual has it, or null where the extension has no such type.
Json punctual(const Light& light) {
  const char* type = light.type == LightType::kPoint         ? "point"
                     : light.type == LightType::kSpot        ? "spot"
                     : light.type == LightType::kDirectional ? "directional"
                                                             : nullptr;
  if (type == nullptr) return nullptr;
  const Rgb power = light.power();
  const float intensity = max_component(power);
  Json entry{{"name", light.name}, {"type", type}, {"intensity", short_decimal(intensity)}};
  if (intensity > 0) entry["color"] = to_json(power / intensity);
  if (light.type == LightType::kSpot) {
    const float outer = std::clamp(light.outer_deg, 0.01F, 90.0F);
    const float inner = std::clamp(light.inner_deg, 0.0F, outer * 0.9999F);
    entry["spot"] = {
        {"innerConeAngle", short_decimal(inner * kRadiansPerDegree)},
        {"outerConeAngle", std::min(double{outer} * std::numbers::pi / 180, std::numbers::pi / 2)}};
  }
  return entry;
}

void check_finite(const std::string& name, std::initializer_list<Vec3f> vectors) {
  for (const Vec3f& v : vectors)
    if (!is_finite(v)) throw ValueError("glTF: '" + name + "' has a number that is not finite");
}

void add_lights(GltfOutput& out, const Scene& scene) {
  Json lights = Json::array();
  for (const Light& light : scene.lights) {
    Json entry = punctual(light);
    if (entry.is_null()) continue;
    check_finite(light.name, {light.position, light.direction, light.power()});
    Json node{{"name", light.name},
              {"extensions", {{"KHR_lights_punctual", {{"light", lights.size()}}}}}};
    if (light.type != LightType::kDirectional) node["translation"] = to_json(light.position);
    if (light.type != LightType::kPoint)
      node["rotation"] = look_rotation(light.direction, {0, 1, 0});
    lights.push_back(std::move(entry));
    add_node(out, std::move(node));
  }
  if (lights.empty()) return;
  out.json["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lights);
  out.use_extension("KHR_lights_punctual");
}

void add_cameras(GltfOutput& out, const Scene& scene) {
  for (const Camera& camera : scene.cameras) {
    check_finite(camera.name, {camera.eye, camera.target, camera.up, Vec3f(camera.vfov_deg)});
    const Json perspective{{"yfov", short_decimal(camera.vfov_deg * kRadiansPerDegree)},
                           {"znear", 0.01}};
    const auto index = out.append(
        "cameras", {{"name", camera.name}, {"type", "perspective"}, {"perspective", perspective}});
    add_node(out, {{"name", camera.name},
                   {"camera", index},
                   {"translation", to_json(camera.eye)},
                   {"rotation", look_rotation(camera.target - camera.eye, camera.up)}});
  }
}

GltfOutput one_scene() {
  GltfOutput out;
  out.json["scene"] = 0;
  out.json["scenes"] = Json::array({Json::object()});
  return out;
}

void check_colored_mesh(std::span<const Vec3f> positions, std::span<const Index3> triangles,
                        std::span<const Rgb> colors) {
  if (colors.size() != positions.size())
    throw ShapeError("coloured mesh: " + std::to_string(colors.size()) + " colours for " +
                     std::to_string(positions.size()) + " vertices");
  for (const Index3& triangle : triangles)
    for (const std::uint32_t v : triangle)
      if (v >= positions.size())
        throw ShapeError("coloured mesh: vertex " + std::to_string(v) + " of " +
                         std::to_string(positions.size()));
  check_vertices(positions, "vertex");
}

std::vector<Rgb> displayable(std::span<const Rgb> colors) {
  std::vector<Rgb> clamped(colors.begin(), colors.end());
  for (Rgb& c : clamped)
    for (std::size_t i = 0; i < 3; ++i) c[i] = c[i] > 0 ? std::min(c[i], 1.0F) : 0.0F;
  return clamped;
}

}  // namespace

void write_gltf(const std::filesystem::path& path, const Scene& scene) {
  check_scene(scene);
  GltfOutput out = one_scene();
  add_textures(out, scene, path);
  add_materials(out, scene);
  add_objects(out, scene);
  add_lights(out, scene);
  add_cameras(out, scene);
  out.write(path);
}

void write_colored_mesh(const std::filesystem::path& path, std::span<const Vec3f> positions,
                        std::span<const Index3> triangles, std::span<const Rgb> colors) {
  check_colored_mesh(positions, triangles, colors);
  GltfOutput out = one_scene();
  out.use_extension("KHR_materials_unlit");
  out.append("materials",
             {{"name", "radiosity"},
              {"doubleSided", true},
              {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
              {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  if (!triangles.empty()) {
    const std::span indices(triangles.front().data(), triangles.size() * 3);
    const Json attributes{{"POSITION", out.add_positions(positions)},
                          {"COLOR_0", out.add_vectors(displayable(colors))}};
    const Json primitive{
        {"attributes", attributes}, {"indices", out.add_indices(indices)}, {"material", 0}};
    out.append("meshes", {{"name", "radiosity"}, {"primitives", Json::array({primitive})}});
    add_node(out, {{"name", "radiosity"}, {"mesh", 0}});
  }
  out.write(path);
}

}  // namespace relumbre
