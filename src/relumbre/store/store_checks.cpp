#include "relumbre/store/store_checks.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

[[noreturn]] void fail(std::string_view what, std::size_t index, std::string_view rule) {
  throw ValueError(fmt::format("{} {} {}", what, index, rule));
}

void require_length(std::string_view what, std::size_t length, std::size_t expected) {
  if (length == expected) return;
  throw ValueError(fmt::format("{} has {} entries, expected {}", what, length, expected));
}

/// Every value obeys the rule, which `rule` says in words.
template <class Values, class Predicate>
void require_all(std::string_view what, const Values& values, std::string_view rule,
                 Predicate&& holds) {
  const auto bad = std::find_if_not(std::begin(values), std::end(values), holds);
  if (bad != std::end(values)) fail(what, static_cast<std::size_t>(bad - std::begin(values)), rule);
}

void require_below(std::string_view what, std::span<const std::uint32_t> values,
                   std::size_t limit) {
  require_all(what, values, "is out of range", [limit](std::uint32_t v) { return v < limit; });
}

void require_finite(std::string_view what, std::span<const Vec3f> values) {
  require_all(what, values, "is not finite", is_finite<float>);
}

bool in_range(const Rgb& v, float upper) {
  return std::min({v.x, v.y, v.z}) >= 0 && max_component(v) <= upper;
}

bool is_reflectance(const Rgb& v) { return is_finite(v) && in_range(v, kMaxReflectance); }

bool is_emission(const Rgb& v) {
  return is_finite(v) && in_range(v, std::numeric_limits<float>::max());
}

bool indices_below(const Index3& corners, std::size_t limit) {
  return corners[0] < limit && corners[1] < limit && corners[2] < limit;
}

void check_mesh(const Scene& scene) {
  const TriangleMesh& mesh = scene.mesh;
  const std::size_t triangles = mesh.triangles.size(), vertices = mesh.positions.size();
  require_length("scene/material", mesh.material.size(), triangles);
  require_length("scene/object", mesh.object.size(), triangles);
  require_length("scene/two_sided", mesh.two_sided.size(), triangles);
  require_finite("scene/positions", mesh.positions);
  require_all("scene/triangles", mesh.triangles, "refers to a vertex that is not there",
              [&](const Index3& corners) { return indices_below(corners, vertices); });
  require_below("scene/material", mesh.material, scene.materials.size());
  require_below("scene/object", mesh.object, scene.objects.size());
  require_all("scene/two_sided", mesh.two_sided, "is neither 0 nor 1",
              [](std::uint8_t v) { return v <= 1; });
  if (!scene.texcoords.empty()) {
    require_length("scene/texcoords", scene.texcoords.size(), vertices);
    require_all("scene/texcoords", scene.texcoords, "is not finite",
                [](Vec2f uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); });
  }
  if (!scene.colors.empty()) {
    require_length("scene/colors", scene.colors.size(), vertices);
    require_all("scene/colors", scene.colors, "is not in [0, 1]",
                [](const Rgb& c) { return min(max(c, Rgb(0)), Rgb(1)) == c; });
  }
  if (!scene.shading_normals.empty()) {
    require_length("scene/shading_normals", scene.shading_normals.size(), vertices);
    require_finite("scene/shading_normals", scene.shading_normals);
  }
}

bool is_sound(const Light& light) {
  return is_finite(light.position) && is_finite(light.direction) && is_finite(light.edge1) &&
         is_finite(light.edge2) && is_emission(light.color) && std::isfinite(light.intensity) &&
         light.intensity >= 0 && std::isfinite(light.inner_deg) && std::isfinite(light.outer_deg) &&
         std::isfinite(light.rotation_deg);
}

bool is_sound(const Camera& camera) {
  return is_finite(camera.eye) && is_finite(camera.target) && is_finite(camera.up) &&
         camera.vfov_deg > 0 && camera.vfov_deg < 180;
}

void check_offsets(std::string_view what, std::span<const std::uint32_t> offsets,
                   std::size_t groups, std::size_t items) {
  require_length(what, offsets.size(), groups + 1);
  if (offsets.front() != 0) fail(what, 0, "is not 0");
  if (offsets.back() != items) fail(what, groups, "is not the number of entries it cuts");
  const auto flat = std::adjacent_find(offsets.begin(), offsets.end(), std::greater_equal<>());
  if (flat == offsets.end()) return;
  fail(what, static_cast<std::size_t>(flat - offsets.begin()), "does not rise");
}

/// Walks every tree of a locator and meets each node at most once.
class ForestWalk {
 public:
  ForestWalk(const FacetLocator& locator, std::size_t facets)
      : locator_(locator), facets_(facets), met_(locator.nodes.size() / 4) {}

  void from(std::int32_t root) {
    push(root, 0);
    while (!open_.empty()) {
      const auto [node, depth] = open_.back();
      open_.pop_back();
      for (std::size_t child = 0; child < 4; ++child) push(locator_.nodes[4 * node + child], depth);
    }
  }

 private:
  struct Open {
    std::size_t node;
    int depth;
  };

  void push(std::int32_t link, int depth) {
    if (link < 0) {
      const auto facet = static_cast<std::size_t>(~link);
      if (facet >= facets_) fail("elements/locator_nodes: facet", facet, "is not there");
      return;
    }
    const auto node = static_cast<std::size_t>(link);
    if (node >= met_.size()) fail("elements/locator_nodes: node", node, "is not there");
    if (met_[node] != 0) fail("elements/locator_nodes: node", node, "has two parents");
    if (depth == kMaxDepth) fail("elements/locator_nodes: node", node, "lies too deep");
    met_[node] = 1;
    open_.push_back({node, depth + 1});
  }

  static constexpr int kMaxDepth = 64;
  const FacetLocator& locator_;
  std::size_t facets_;
  std::vector<std::uint8_t> met_;
  std::vector<Open> open_;
};

void check_locator(const FacetLocator& locator, std::size_t triangles, std::size_t facets) {
  require_length("elements/locator_roots", locator.roots.size(), 2 * triangles);
  require_length("elements/locator_nodes", locator.nodes.size(), locator.nodes.size() / 4 * 4);
  ForestWalk walk(locator, facets);
  for (const std::int32_t root : locator.roots) {
    if (root != FacetLocator::kMissing) walk.from(root);
  }
}

}  // namespace

void check_scene(const Scene& scene) {
  check_mesh(scene);
  const std::size_t textures = scene.textures.size();
  require_all("material", scene.materials, "is out of range", [&](const Material& m) {
    return is_reflectance(m.reflectance) && is_emission(m.emission) &&
           (m.texture == kNone || m.texture < textures);
  });
  require_all("texture", scene.textures, "has another size than it says", [](const Texture& t) {
    return t.width > 0 && t.height > 0 && t.rgb.size() == 3 * std::uint64_t{t.width} * t.height;
  });
  require_all("light", scene.lights, "is out of range", [&](const Light& light) {
    return is_sound(light) &&
           (light.type != LightType::kEmitter || light.object < scene.objects.size());
  });
  require_all("camera", scene.cameras, "is out of range",
              [](const Camera& camera) { return is_sound(camera); });
}

void check_tessellation(const Tessellation& t, std::size_t source_triangles) {
  const std::size_t n = t.area.size();
  if (n == 0 || t.patch_offsets.size() < 2) throw ValueError("there are no elements");
  check_offsets("elements/facet_offsets", t.facet_offsets, n, t.facets.size());
  check_offsets("elements/patch_offsets", t.patch_offsets, t.patch_offsets.size() - 1, n);
  require_finite("elements/positions", t.positions);
  require_all("elements/facets", t.facets, "refers to what is not there", [&](const Facet& f) {
    return indices_below(f.corners, t.positions.size()) && f.triangle < source_triangles &&
           f.back <= 1;
  });
  require_all("elements/area", t.area, "is not positive",
              [](float area) { return std::isfinite(area) && area > 0; });
  require_length("elements/centroid", t.centroid.size(), n);
  require_length("elements/normal", t.normal.size(), n);
  require_finite("elements/centroid", t.centroid);
  require_finite("elements/normal", t.normal);
  check_locator(t.locator, source_triangles, t.facets.size());
}

void check_element_materials(std::span<const Rgb> reflectance, std::span<const Rgb> emission,
                             std::size_t elements) {
  require_length("elements/reflectance", reflectance.size(), elements);
  require_length("elements/emission", emission.size(), elements);
  require_all("elements/reflectance", reflectance, "is out of range", is_reflectance);
  require_all("elements/emission", emission, "is out of range", is_emission);
}

}  // namespace relumbre
