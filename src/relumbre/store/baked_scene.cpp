#include "relumbre/store/baked_scene.h"

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/store/store_checks.h"

namespace relumbre {

namespace {

void require_equal(std::string_view what, std::uint64_t found, std::uint64_t expected) {
  if (found == expected) return;
  throw ValueError(fmt::format("{} {}, expected {}", what, found, expected));
}

}  // namespace

void validate(const BakedScene& baked) {
  const std::size_t n = baked.tessellation.elements(), k = baked.tessellation.patches();
  check_scene(baked.scene);
  check_tessellation(baked.tessellation, baked.scene.mesh.triangles.size());
  check_element_materials(baked.reflectance, baked.emission, n);
  require_equal("settings: elements", baked.settings.elements, n);
  require_equal("settings: patches", baked.settings.patches, k);
  require_equal("counts: rows", baked.counts.rows(), n);
  require_equal("counts: columns", baked.counts.columns, k);
  require_equal("counts: rays", baked.counts.rays, baked.settings.rays);
  validate(baked.counts);
}

}  // namespace relumbre
