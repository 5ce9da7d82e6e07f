/// Light responses are computed once: dimming, colouring and switching cost no rays.
#pragma once

#include <filesystem>
#include <unordered_map>

#include "relumbre/render/direct_light.h"

namespace relumbre {

/// Responses of lights in one scene, by what they depend on: the light's geometry and profile (not
/// its color, intensity or whether it is on), an emitter's materials, the scene's geometry, the
/// tessellation and the config. In memory, and in a folder if one is given: `<key>.npy`, float32
/// (n, 3), written atomically. An entry that cannot be read or has another shape is computed again;
/// a folder that cannot be written to is as good as none. Not thread-safe.
class ResponseCache {
 public:
  struct Counters {
    std::uint64_t rays = 0;      ///< cast so far
    std::uint64_t computed = 0;  ///< responses that cost rays
    std::uint64_t from_disk = 0;
    std::uint64_t from_memory = 0;
  };

  /// The scene, tessellation and rays must outlive the cache. Hashes them once, O(n + triangles).
  ResponseCache(const Scene& scene, const Tessellation& tessellation, const RayScene& rays,
                const DirectLightConfig& config = {}, std::filesystem::path folder = {});

  /// Never null. Throws what light_response throws.
  LightResponse response(const Light& light, Progress& progress = no_progress());
  /// One for each light. A light that is off and not in the cache gets zeros, for no rays.
  std::vector<LightResponse> responses(std::span<const Light> lights,
                                       Progress& progress = no_progress());
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// The key of a light's response.
  [[nodiscard]] std::uint64_t key(const Light& light);

 private:
  [[nodiscard]] std::filesystem::path file_of(std::uint64_t key) const;
  [[nodiscard]] LightResponse load(std::uint64_t key) const;
  void save(std::uint64_t key, const std::vector<Rgb>& response) const;

  const Scene& scene_;
  const Tessellation& tessellation_;
  const RayScene& rays_;
  DirectLightConfig config_;
  std::filesystem::path folder_;
  std::uint64_t base_key_;
  std::unordered_map<std::uint64_t, LightResponse> memory_;
  /// Hashes of sky images. Each image is kept alive, so that its address stays its own.
  std::unordered_map<std::shared_ptr<const Image>, std::uint64_t> sky_hashes_;
  std::vector<std::uint64_t> emission_hashes_;  ///< per object
  LightResponse zeros_;
  Counters counters_;
};

}  // namespace relumbre
