#include "relumbre/render/response_cache.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/npy.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

/// Changes when the way responses are computed does, so that old files are not taken for new ones.
constexpr std::uint64_t kMethodVersion = 1;

/// A running hash of values.
class Hasher {
 public:
  void add(std::uint64_t bits) { state_ = hash64(state_, bits); }
  void add(float v) { add(std::uint64_t{std::bit_cast<std::uint32_t>(v)}); }
  void add(const Vec3f& v) { add(v.x), add(v.y), add(v.z); }
  void add(std::span<const float> values) {
    add(std::uint64_t{values.size()});
    for (const float v : values) add(v);
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

std::uint64_t hash_of(const Scene& scene, const Tessellation& tessellation,
                      const DirectLightConfig& config) {
  Hasher hash;
  hash.add(kMethodVersion);
  hash.add(scene.geometry_hash());
  hash.add(std::uint64_t{config.points_per_element});
  hash.add(std::uint64_t{config.light_samples});
  hash.add(std::uint64_t{config.sky_samples});
  hash.add(config.seed);
  hash.add(std::uint64_t{tessellation.facets.size()});
  hash.add(tessellation.area);
  for (const Vec3f& c : tessellation.centroid) hash.add(c);
  for (const Vec3f& n : tessellation.normal) hash.add(n);
  return hash.value();
}

std::uint64_t hash_of(const Image& image) {
  Hasher hash;
  hash.add(std::uint64_t{image.width()});
  for (const char* name : {"R", "G", "B"}) hash.add(image.channel(name));
  return hash.value();
}

void add_profile(Hasher& hash, const IesProfile& profile) {
  hash.add(profile.peak());
  hash.add(profile.vertical_deg);
  hash.add(profile.horizontal_deg);
  hash.add(profile.candela);
}

/// For each object the exitance of its emissive triangles; where they lie is in the geometry's
/// hash.
std::vector<std::uint64_t> emission_hashes(const Scene& scene) {
  std::vector<Hasher> objects(scene.objects.size());
  for (std::uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
    const Material& material = scene.material_of(t);
    if (!material.emissive() || scene.mesh.object[t] >= objects.size()) continue;
    objects[scene.mesh.object[t]].add(std::uint64_t{t});
    objects[scene.mesh.object[t]].add(material.emission);
  }
  std::vector<std::uint64_t> hashes;
  hashes.reserve(objects.size());
  for (const Hasher& h : objects) hashes.push_back(h.value());
  return hashes;
}

}  // namespace

ResponseCache::ResponseCache(const Scene& scene, const Tessellation& tessellation,
                             const RayScene& rays, const DirectLightConfig& config, fs::path folder)
    : scene_(scene),
      tessellation_(tessellation),
      rays_(rays),
      config_(config),
      folder_(std::move(folder)),
      base_key_(hash_of(scene, tessellation, config)),
      emission_hashes_(emission_hashes(scene)),
      zeros_(std::make_shared<const std::vector<Rgb>>(tessellation.elements())) {}

std::uint64_t ResponseCache::key(const Light& light) {
  Hasher hash;
  hash.add(base_key_);
  hash.add(static_cast<std::uint64_t>(light.type));
  for (const Vec3f& v : {light.position, light.direction, light.edge1, light.edge2}) hash.add(v);
  for (const float v : {light.inner_deg, light.outer_deg, light.rotation_deg}) hash.add(v);
  if (light.ies) add_profile(hash, *light.ies);
  if (light.type == LightType::kEmitter) {
    hash.add(std::uint64_t{light.object});
    if (light.object < emission_hashes_.size()) hash.add(emission_hashes_[light.object]);
  }
  if (light.sky) {
    const auto [known, is_new] = sky_hashes_.try_emplace(light.sky, 0);
    if (is_new) known->second = hash_of(*light.sky);
    hash.add(known->second);
  }
  return hash.value();
}

LightResponse ResponseCache::response(const Light& light, Progress& progress) {
  const std::uint64_t light_key = key(light);
  if (const auto known = memory_.find(light_key); known != memory_.end()) {
    ++counters_.from_memory;
    return known->second;
  }
  LightResponse response = load(light_key);
  if (response) {
    ++counters_.from_disk;
  } else {
    response = std::make_shared<const std::vector<Rgb>>(
        light_response(scene_, tessellation_, rays_, light, config_, progress, &counters_.rays));
    ++counters_.computed;
    save(light_key, *response);
  }
  return memory_.emplace(light_key, std::move(response)).first->second;
}

std::vector<LightResponse> ResponseCache::responses(std::span<const Light> lights,
                                                    Progress& progress) {
  std::vector<LightResponse> all;
  all.reserve(lights.size());
  for (const Light& light : lights) {
    const bool dark = light.power() == Rgb{} && !memory_.contains(key(light));
    all.push_back(dark ? zeros_ : response(light, progress));
  }
  return all;
}

fs::path ResponseCache::file_of(std::uint64_t light_key) const {
  return folder_ / fmt::format("{:016x}.npy", light_key);
}

LightResponse ResponseCache::load(std::uint64_t light_key) const {
  if (folder_.empty()) return nullptr;
  try {
    const FloatArray array = read_npy(file_of(light_key));
    const std::size_t n = tessellation_.elements();
    if (array.shape != std::vector<std::size_t>{n, 3}) return nullptr;
    std::vector<Rgb> response(n);
    for (std::size_t i = 0; i < n; ++i) {
      response[i] = {array.data[3 * i], array.data[3 * i + 1], array.data[3 * i + 2]};
      // Irradiance is finite and not negative: anything else is a damaged file.
      if (!is_finite(response[i]) || min(response[i], Rgb{}) != Rgb{}) return nullptr;
    }
    return std::make_shared<const std::vector<Rgb>>(std::move(response));
  } catch (const Error&) {
    return nullptr;  // a missing or damaged entry costs its rays again, no more
  }
}

void ResponseCache::save(std::uint64_t light_key, const std::vector<Rgb>& response) const {
  if (folder_.empty()) return;
  std::vector<float> values;
  values.reserve(response.size() * 3);
  for (const Rgb& c : response) values.insert(values.end(), {c.x, c.y, c.z});
  std::error_code ignored;
  fs::create_directories(folder_, ignored);
  try {
    write_npy(file_of(light_key), std::array{response.size(), std::size_t{3}}, values);
  } catch (const Error&) {
    return;  // a folder that cannot be written to is as good as none
  }
}

}  // namespace relumbre
