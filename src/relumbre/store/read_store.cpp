#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/store/descriptor.h"
#include "relumbre/store/energy_fields.h"
#include "relumbre/store/hdf5_reader.h"
#include "relumbre/store/scene_json.h"
#include "relumbre/store/seal.h"
#include "relumbre/store/store.h"
#include "relumbre/store/store_names.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxTextureSide = 1U << 16;

void check_root(const Hdf5Reader& in) {
  if (in.text_attribute("/", "format") != kStoreFormat ||
      in.attribute<std::uint32_t>("/", "version") != kStoreVersion) {
    throw ValueError("its seal and its contents disagree");
  }
}

PatchMethod method_of(const std::string& name) {
  for (const auto& [value, known] : kPatchMethodNames) {
    if (known == name) return value;
  }
  throw ValueError("settings: unknown patch method '" + name + "'");
}

BakeSettings read_settings(const Hdf5Reader& in) {
  return {.scene = in.text_attribute("settings", "scene"),
          .method = method_of(in.text_attribute("settings", "method")),
          .patches = in.attribute<std::uint64_t>("settings", "patches"),
          .elements = in.attribute<std::uint64_t>("settings", "elements"),
          .rays = in.attribute<std::uint32_t>("settings", "rays"),
          .seed = in.attribute<std::uint64_t>("settings", "seed")};
}

/// As many rows as there are.
template <class T>
std::vector<T> read_all(const Hdf5Reader& in, const std::string& path) {
  return in.read<T>(path, in.rows<T>(path));
}

void read_texture(const Hdf5Reader& in, std::size_t index, Texture& texture) {
  const std::string path = texture_path(index);
  const Extent extent = in.extent(path);
  if (extent.size() != 3 || extent[2] != 3 || std::max(extent[0], extent[1]) > kMaxTextureSide) {
    throw ValueError(path + " is not an image");
  }
  texture.height = static_cast<std::uint32_t>(extent[0]);
  texture.width = static_cast<std::uint32_t>(extent[1]);
  texture.rgb.resize(extent[0] * extent[1] * 3);
  in.read_array(path, Number::kU8, texture.rgb.data());
}

Scene read_scene(const Hdf5Reader& in, const fs::path& file) {
  Scene scene;
  scene_from_json(in.text("scene/description"), file.string(), scene);
  const std::uint64_t triangles = in.rows<Index3>("scene/triangles");
  scene.mesh.positions = read_all<Vec3f>(in, "scene/positions");
  scene.mesh.triangles = in.read<Index3>("scene/triangles", triangles);
  scene.mesh.material = in.read<std::uint32_t>("scene/material", triangles);
  scene.mesh.object = in.read<std::uint32_t>("scene/object", triangles);
  scene.mesh.two_sided = in.read<std::uint8_t>("scene/two_sided", triangles);
  scene.texcoords = read_all<Vec2f>(in, "scene/texcoords");
  scene.shading_normals = read_all<Vec3f>(in, "scene/shading_normals");
  if (in.has("scene/colors")) scene.colors = read_all<Rgb>(in, "scene/colors");
  for (std::size_t i = 0; i < scene.textures.size(); ++i) read_texture(in, i, scene.textures[i]);
  return scene;
}

void read_elements(const Hdf5Reader& in, BakedScene& baked) {
  const std::uint64_t n = in.rows<float>("elements/area");
  Tessellation& t = baked.tessellation;
  t.positions = read_all<Vec3f>(in, "elements/positions");
  t.facets = read_all<Facet>(in, "elements/facets");
  t.facet_offsets = in.read<std::uint32_t>("elements/facet_offsets", n + 1);
  t.patch_offsets = read_all<std::uint32_t>(in, "elements/patch_offsets");
  t.area = in.read<float>("elements/area", n);
  t.centroid = in.read<Vec3f>("elements/centroid", n);
  t.normal = in.read<Vec3f>("elements/normal", n);
  baked.reflectance = in.read<Rgb>("elements/reflectance", n);
  baked.emission = in.read<Rgb>("elements/emission", n);
  t.locator.roots =
      in.read<std::int32_t>("elements/locator_roots", 2 * baked.scene.mesh.triangles.size());
  t.locator.nodes = read_all<std::int32_t>(in, "elements/locator_nodes");
}

SparseCounts read_counts(const Hdf5Reader& in, std::uint64_t elements) {
  SparseCounts counts;
  counts.rays = in.attribute<std::uint32_t>("counts", "rays");
  counts.columns = in.attribute<std::uint64_t>("counts", "columns");
  counts.row_offsets = in.read<std::uint64_t>("counts/row_offsets", elements + 1);
  const std::uint64_t nonzeros = in.rows<std::uint32_t>("counts/patch");
  counts.column = in.read<std::uint32_t>("counts/patch", nonzeros);
  counts.count = in.read<std::uint32_t>("counts/count", nonzeros);
  return counts;
}

EnergyReport read_energy(const Hdf5Reader& in) {
  EnergyReport energy;
  for_each_field(energy, [&]<class T>(const char* name, T& value) {
    value = in.attribute<T>("energy", name);
  });
  return energy;
}

BakedScene read_contents(const Hdf5Reader& in, const fs::path& file) {
  check_root(in);
  BakedScene baked;
  baked.settings = read_settings(in);
  baked.scene = read_scene(in, file);
  read_elements(in, baked);
  baked.counts = read_counts(in, baked.tessellation.elements());
  baked.energy = read_energy(in);
  validate(baked);
  return baked;
}

StoreSummary read_summary(const Hdf5Reader& in, const fs::path& file) {
  check_root(in);
  StoreSummary summary;
  summary.settings = read_settings(in);
  summary.energy = read_energy(in);
  summary.triangles = in.rows<Index3>("scene/triangles");
  summary.vertices = in.rows<Vec3f>("scene/positions");
  summary.facets = in.rows<Facet>("elements/facets");
  summary.nonzeros = in.rows<std::uint32_t>("counts/patch");
  summary.geometry_hash = in.attribute<std::uint64_t>("scene", "geometry_hash");
  scene_from_json(in.text("scene/description"), file.string(), summary.description);
  return summary;
}

/// Opens a sealed store, reads, and gives every error the file's name.
template <class Read>
auto read_sealed(const fs::path& file, Read&& read) {
  try {
    const Hdf5Reader in(file);
    return read(in);
  } catch (const FileError&) {
    throw;
  } catch (const Error& error) {
    throw FileError(file.string(), error.what());
  } catch (const std::bad_alloc&) {
    throw FileError(file.string(), "needs more memory than there is");
  }
}

}  // namespace

BakedScene read_store(const fs::path& file) {
  verify_seal(file);
  return read_sealed(file, [&](const Hdf5Reader& in) { return read_contents(in, file); });
}

StoreSummary read_store_summary(const fs::path& file) {
  const std::uint64_t hash = verify_seal(file);
  StoreSummary summary =
      read_sealed(file, [&](const Hdf5Reader& in) { return read_summary(in, file); });
  summary.content_hash = hash;
  summary.file_bytes = file_length(open_for_reading(file).get(), file);
  return summary;
}

}  // namespace relumbre
