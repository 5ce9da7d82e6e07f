/// A scene whose light transport has been computed: all that relighting needs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/radiosity/energy_report.h"
#include "relumbre/radiosity/sparse_counts.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

/// What a bake was asked for.
struct BakeSettings {
  std::string scene;  ///< name or file, for reports
  PatchMethod method = PatchMethod::kCluster;
  std::uint64_t patches = 0;   ///< k
  std::uint64_t elements = 0;  ///< n
  std::uint32_t rays = 0;      ///< per element
  std::uint64_t seed = 0;
  friend bool operator==(const BakeSettings&, const BakeSettings&) = default;
};

struct BakedScene {
  Scene scene;
  Tessellation tessellation;     ///< of scene.mesh
  std::vector<Rgb> reflectance;  ///< n, in [0, kMaxReflectance]
  std::vector<Rgb> emission;     ///< n, W/m²
  SparseCounts counts;           ///< n × k
  BakeSettings settings;
  EnergyReport energy;
};

/// Throws ValueError unless every array has the right length and every index, offset and number is
/// in range: after this, nothing that computes with the scene can leave its arrays.
void validate(const BakedScene& baked);

}  // namespace relumbre
