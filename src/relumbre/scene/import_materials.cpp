#include "relumbre/scene/import_materials.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <assimp/material.h>
#include <assimp/scene.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/raster.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMaxTextureBytes = std::uintmax_t{1} << 30;

std::optional<Rgb> color(const aiMaterial& source, const char* key, unsigned type, unsigned index) {
  aiColor3D c;
  if (source.Get(key, type, index, c) != AI_SUCCESS) return std::nullopt;
  return Rgb(c.r, c.g, c.b);
}

std::string source_name(const aiMaterial& source) {
  aiString name;
  return source.Get(AI_MATKEY_NAME, name) == AI_SUCCESS ? name.C_Str() : "";
}

struct TextureUse {
  std::string path;
  unsigned texcoord_set = 0;
};

std::optional<TextureUse> texture_use(const aiMaterial& source, aiTextureType type) {
  aiString path;
  unsigned set = 0;
  if (source.GetTexture(type, 0, &path, nullptr, &set) != AI_SUCCESS || path.length == 0) {
    return std::nullopt;
  }
  return TextureUse{path.C_Str(), set};
}

std::optional<TextureUse> base_texture_use(const aiMaterial& source) {
  const std::optional<TextureUse> base = texture_use(source, aiTextureType_BASE_COLOR);
  return base ? base : texture_use(source, aiTextureType_DIFFUSE);
}

/// Component-wise clamp to [0, limit]; NaN becomes 0.
Rgb clamped(const Rgb& c, float limit) {
  const auto clamp = [limit](float v) { return v > 0 ? std::min(v, limit) : 0.0F; };
  return {clamp(c.x), clamp(c.y), clamp(c.z)};
}

Rgb mean(const Texture& texture) {
  Vec3d sum;
  for (std::uint32_t y = 0; y < texture.height; ++y) {
    for (std::uint32_t x = 0; x < texture.width; ++x) {
      const Vec2f center{(static_cast<float>(x) + 0.5F) / static_cast<float>(texture.width),
                         (static_cast<float>(y) + 0.5F) / static_cast<float>(texture.height)};
      sum += Vec3d(texture.sample(center));
    }
  }
  return Rgb(sum / (static_cast<double>(texture.width) * static_cast<double>(texture.height)));
}

}  // namespace

MaterialImporter::MaterialImporter(const aiScene& source, SceneKind kind, fs::path file,
                                   const ImportConfig& config, std::span<const GltfMaterial> gltf,
                                   Scene& scene, ImportReport& report)
    : source_(source),
      kind_(kind),
      file_(std::move(file)),
      config_(config),
      gltf_(gltf),
      scene_(scene),
      report_(report),
      used_(source.mNumMaterials, kNone) {}

std::uint32_t MaterialImporter::use(unsigned source_index, bool has_vertex_colors) {
  if (source_index >= used_.size()) throw FileError(file_.string(), "has a mesh without material");
  std::uint32_t& index = used_[source_index];
  if (index == kNone) {
    Material material = convert(*source_.mMaterials[source_index], has_vertex_colors);
    index = static_cast<std::uint32_t>(scene_.materials.size());
    scene_.materials.push_back(std::move(material));
  }
  return index;
}

unsigned MaterialImporter::texcoord_set(unsigned source_index) const {
  const std::optional<TextureUse> use = base_texture_use(*source_.mMaterials[source_index]);
  return use ? use->texcoord_set : 0;
}

TexcoordMap MaterialImporter::texcoord_map(unsigned source_index) const {
  const GltfMaterial* const notes = notes_on(*source_.mMaterials[source_index]);
  return notes != nullptr ? notes->texcoords : TexcoordMap{};
}

const GltfMaterial* MaterialImporter::notes_on(const aiMaterial& source) const {
  std::size_t index = gltf_.size();
  const std::string name = source_name(source);
  std::from_chars(name.data(), name.data() + name.size(), index);
  return index < gltf_.size() ? &gltf_[index] : nullptr;
}

std::string MaterialImporter::name_of(const aiMaterial& source) const {
  const GltfMaterial* const notes = notes_on(source);
  return notes != nullptr ? notes->name : source_name(source);
}

bool MaterialImporter::has_own_colour(const aiMaterial& source) const {
  if (kind_ == SceneKind::kObj) return name_of(source) != AI_DEFAULT_MATERIAL_NAME;
  return kind_ == SceneKind::kGltf;
}

Material MaterialImporter::convert(const aiMaterial& source, bool has_vertex_colors) {
  Material material;
  set_sides(source, material);
  if (!has_own_colour(source)) {
    material.name = "default";
    const float grey = has_vertex_colors ? kMaxReflectance : config_.default_reflectance;
    material.reflectance = clamped(Rgb(grey), kMaxReflectance);
    return material;
  }
  material.name = name_of(source);
  if (material.name.empty()) material.name = "material " + std::to_string(scene_.materials.size());
  set_reflectance(source, material);
  set_emission(source, material);
  warn_if_transparent(source, material);
  return material;
}

void MaterialImporter::set_sides(const aiMaterial& source, Material& material) const {
  int two_sided = kind_ == SceneKind::kGltf ? 0 : 1;
  if (kind_ == SceneKind::kGltf) source.Get(AI_MATKEY_TWOSIDED, two_sided);
  if (config_.sides != Sides::kAuto) two_sided = config_.sides == Sides::kTwo ? 1 : 0;
  material.two_sided = two_sided != 0;
}

void MaterialImporter::set_reflectance(const aiMaterial& source, Material& material) {
  std::optional<Rgb> factor = color(source, AI_MATKEY_BASE_COLOR);
  if (!factor) factor = color(source, AI_MATKEY_COLOR_DIFFUSE);
  if (!factor) factor = Rgb(config_.default_reflectance);
  material.texture = base_texture(source, material);
  const bool textured = material.texture != kNone;
  // Exporters write Kd 0 beside a map when they mean the map alone.
  if (textured && kind_ == SceneKind::kObj && *factor == Rgb{}) factor = Rgb(1.0F);

  material.reflectance = clamped(*factor, kMaxReflectance);
  // A factor of one is how a textured material says that the texture holds the colour.
  if (clamped(*factor, textured ? 1.0F : kMaxReflectance) != *factor) {
    report_.warnings.push_back("material '" + material.name +
                               "' has a reflectance outside [0, 0.99]; clamped");
  }
}

void MaterialImporter::set_emission(const aiMaterial& source, Material& material) {
  constexpr float brightest = 1e12F;
  const Rgb emission = color(source, AI_MATKEY_COLOR_EMISSIVE).value_or(Rgb{});
  material.emission = clamped(emission, brightest);
  if (material.emission != emission) {
    report_.warnings.push_back("material '" + material.name +
                               "' has an emission outside [0, 1e12]; clamped");
  }
  if (!material.emissive()) return;
  const std::optional<TextureUse> use = texture_use(source, aiTextureType_EMISSIVE);
  if (!use) return;
  const std::uint32_t texture = load_texture(use->path, material);
  if (texture == kNone) return;
  material.emission *= mean(scene_.textures[texture]);
  report_.warnings.push_back("material '" + material.name +
                             "' has an emissive texture; its mean is used");
}

void MaterialImporter::warn_if_transparent(const aiMaterial& source, const Material& material) {
  float opacity = 1;
  if (kind_ != SceneKind::kObj || source.Get(AI_MATKEY_OPACITY, opacity) != AI_SUCCESS) return;
  if (opacity < 1) {
    report_.warnings.push_back("material '" + material.name + "' is transparent; taken as opaque");
  }
}

std::uint32_t MaterialImporter::base_texture(const aiMaterial& source, const Material& material) {
  const std::optional<TextureUse> use = base_texture_use(source);
  return use ? load_texture(use->path, material) : kNone;
}

std::uint32_t MaterialImporter::load_texture(const std::string& path, const Material& material) {
  const auto [entry, added] = textures_.emplace(path, kNone);
  if (!added) return entry->second;
  try {
    scene_.textures.push_back(decode_texture(path));
    entry->second = static_cast<std::uint32_t>(scene_.textures.size() - 1);
  } catch (const FileError& error) {
    report_.warnings.push_back("material '" + material.name +
                               "' goes without its texture: " + error.what());
  }
  return entry->second;
}

Texture MaterialImporter::decode_texture(const std::string& path) const {
  const aiTexture* const embedded = source_.GetEmbeddedTexture(path.c_str());
  std::string from_file;
  std::string_view bytes;
  std::string name = path;
  if (embedded != nullptr) {
    name = file_.string() + " texture " + path;
    // Height 0 says that the texture is still a compressed file of mWidth bytes.
    if (embedded->mHeight != 0) throw FileError(name, "is not a PNG or JPEG");
    bytes = {reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth};
  } else {
    const fs::path file = find_texture(path);
    name = file.string();
    from_file = read_file(file, kMaxTextureBytes);
    bytes = from_file;
  }
  Raster raster = decode_image(bytes, name);
  return {path, raster.width, raster.height, std::move(raster.rgb)};
}

fs::path MaterialImporter::find_texture(const std::string& path) const {
  std::string portable = path;
  std::ranges::replace(portable, '\\', '/');
  const fs::path folder = file_.parent_path();
  const fs::path relative = fs::path(portable).lexically_normal();
  const bool inside = relative.is_relative() && !relative.empty() && *relative.begin() != "..";
  std::error_code error;
  if (inside && fs::is_regular_file(folder / relative, error)) return folder / relative;
  return folder / relative.filename();
}

}  // namespace relumbre
