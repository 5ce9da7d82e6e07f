#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "relumbre/scene/gltf_reduction.h"
#include "relumbre/scene/gltf_uri.h"

namespace relumbre {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxTexcoords = 4;
constexpr std::size_t kMaxUri = 1000;  // what Assimp's strings hold

json image(const GltfReduction& r, const JsonFields& fields) {
  if (fields.has("bufferView")) {
    return {{"bufferView", fields.index("bufferView", r.count("bufferViews"))},
            {"mimeType", fields.text("mimeType", "") == "image/jpeg" ? "image/jpeg" : "image/png"}};
  }
  const std::string uri = fields.text("uri");
  if (data_uri_size(uri)) return {{"uri", uri}};
  const std::optional<std::string> name = decode_relative_uri(uri);
  // An image elsewhere is reported where a material uses it, as a file that is not there.
  return {{"uri", name && name->size() < kMaxUri ? *name : "image outside of the scene's folder"}};
}

json texture(const GltfReduction& r, const JsonFields& fields) {
  if (!fields.has("source")) return json::object();
  return {{"source", fields.index("source", r.count("images"))}};
}

/// {"index", "texCoord"}, or nothing if the texture has no plain image.
std::optional<json> texture_use(GltfReduction& r, const JsonFields& fields) {
  const std::size_t index = fields.index("index", r.count("textures"));
  if (!r.out.at("textures")[index].contains("source")) {
    r.warn("texture " + std::to_string(index) + " has no PNG or JPEG image and is left out");
    return std::nullopt;
  }
  return json{{"index", index}, {"texCoord", fields.index("texCoord", kMaxTexcoords, 0)}};
}

void copy_emissive_texture(GltfReduction& r, const JsonFields& from, json& to) {
  if (!from.has("emissiveTexture")) return;
  const std::optional<json> use = texture_use(r, from.object("emissiveTexture"));
  if (use) to["emissiveTexture"] = *use;
}

/// uv' = T · R · S · uv, with R counter-clockwise in an image whose v runs downwards.
TexcoordMap texcoord_map(const JsonFields& transform) {
  const auto pair = [&](const char* key, float fallback) {
    const std::vector<float> v =
        transform.has(key) ? transform.numbers(key, 2) : std::vector<float>{fallback, fallback};
    return Vec2f{v[0], v[1]};
  };
  const Vec2f scale = pair("scale", 1);
  const float angle = transform.number("rotation", 0);
  const float c = std::cos(angle), s = std::sin(angle);
  return {Vec2f{c, -s} * scale.x, Vec2f{s, c} * scale.y, pair("offset", 0)};
}

/// The base colour texture; its transform goes to the notes, its own set of coordinates to `use`.
void copy_base_texture(GltfReduction& r, const JsonFields& from, const char* key, json& pbr,
                       GltfMaterial& notes) {
  if (!from.has(key)) return;
  const JsonFields texture = from.object(key);
  std::optional<json> use = texture_use(r, texture);
  if (!use) return;
  if (texture.has("extensions") && texture.object("extensions").has("KHR_texture_transform")) {
    const JsonFields extensions = texture.object("extensions");
    const JsonFields transform = extensions.object("KHR_texture_transform");
    notes.texcoords = texcoord_map(transform);
    if (transform.has("texCoord")) (*use)["texCoord"] = transform.index("texCoord", kMaxTexcoords);
  }
  pbr["baseColorTexture"] = std::move(*use);
}

json metallic_roughness(GltfReduction& r, const JsonFields& fields, GltfMaterial& notes) {
  json pbr = json::object();
  if (!fields.has("pbrMetallicRoughness")) return pbr;
  const JsonFields metallic = fields.object("pbrMetallicRoughness");
  if (metallic.has("baseColorFactor")) {
    pbr["baseColorFactor"] = metallic.numbers("baseColorFactor", 4);
  }
  copy_base_texture(r, metallic, "baseColorTexture", pbr, notes);
  return pbr;
}

void apply_emissive_strength(const JsonFields& extensions, std::vector<float>& emission) {
  if (!extensions.has("KHR_materials_emissive_strength")) return;
  const JsonFields strength = extensions.object("KHR_materials_emissive_strength");
  for (float& e : emission) e *= strength.number("emissiveStrength", 1);
  if (!std::ranges::all_of(emission, [](float e) { return std::isfinite(e); })) {
    strength.fail("emissiveStrength", "is too large");
  }
}

/// The diffuse part of a specular-glossiness material, where it has no metallic-roughness one.
void apply_specular_glossiness(GltfReduction& r, const JsonFields& extensions, json& pbr,
                               GltfMaterial& notes) {
  if (!extensions.has("KHR_materials_pbrSpecularGlossiness") || !pbr.empty()) return;
  const JsonFields diffuse = extensions.object("KHR_materials_pbrSpecularGlossiness");
  if (diffuse.has("diffuseFactor")) pbr["baseColorFactor"] = diffuse.numbers("diffuseFactor", 4);
  copy_base_texture(r, diffuse, "diffuseTexture", pbr, notes);
}

json material(GltfReduction& r, const JsonFields& fields, std::size_t i) {
  GltfMaterial notes{gltf_name(fields, "material " + std::to_string(i)), {}};
  json out = {{"name", std::to_string(i)}, {"doubleSided", fields.boolean("doubleSided", false)}};
  json pbr = metallic_roughness(r, fields, notes);
  std::vector<float> emission{0, 0, 0};
  if (fields.has("emissiveFactor")) emission = fields.numbers("emissiveFactor", 3);
  copy_emissive_texture(r, fields, out);
  bool transparent = fields.text("alphaMode", "OPAQUE") == "BLEND";
  if (fields.has("extensions")) {
    const JsonFields extensions = fields.object("extensions");
    apply_emissive_strength(extensions, emission);
    apply_specular_glossiness(r, extensions, pbr, notes);
    transparent = transparent || extensions.has("KHR_materials_transmission");
  }
  out["pbrMetallicRoughness"] = std::move(pbr);
  out["emissiveFactor"] = emission;
  if (transparent) r.warn("material '" + notes.name + "' is transparent; taken as opaque");
  r.materials.push_back(std::move(notes));
  return out;
}

}  // namespace

void reduce_gltf_materials(GltfReduction& r) {
  r.section("images", "image",
            [&](const JsonFields& fields, std::size_t) { return image(r, fields); });
  r.section("textures", "texture",
            [&](const JsonFields& fields, std::size_t) { return texture(r, fields); });
  r.section("materials", "material",
            [&](const JsonFields& fields, std::size_t i) { return material(r, fields, i); });
}

}  // namespace relumbre
