#include <algorithm>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/store/energy_fields.h"
#include "relumbre/store/hdf5_writer.h"
#include "relumbre/store/scene_json.h"
#include "relumbre/store/seal.h"
#include "relumbre/store/store.h"
#include "relumbre/store/store_checks.h"
#include "relumbre/store/store_names.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

template <class T>
void write(Hdf5Writer& out, const char* path, const std::vector<T>& rows) {
  out.write<T>(path, rows);
}

std::string_view method_name(PatchMethod method) {
  for (const auto& [value, name] : kPatchMethodNames) {
    if (value == method) return name;
  }
  throw ValueError("settings: unknown patch method");
}

void write_root(Hdf5Writer& out) {
  out.text_attribute("/", "format", kStoreFormat);
  out.attribute("/", "version", kStoreVersion);
  out.text_attribute("/", "producer", "relumbre");
}

void write_settings(Hdf5Writer& out, const BakeSettings& settings) {
  out.make_group("settings");
  out.text_attribute("settings", "scene", settings.scene);
  out.text_attribute("settings", "method", method_name(settings.method));
  out.attribute("settings", "patches", settings.patches);
  out.attribute("settings", "elements", settings.elements);
  out.attribute("settings", "rays", settings.rays);
  out.attribute("settings", "seed", settings.seed);
}

void write_scene(Hdf5Writer& out, const Scene& scene) {
  out.make_group("scene");
  write(out, "scene/positions", scene.mesh.positions);
  write(out, "scene/triangles", scene.mesh.triangles);
  write(out, "scene/material", scene.mesh.material);
  write(out, "scene/object", scene.mesh.object);
  write(out, "scene/two_sided", scene.mesh.two_sided);
  write(out, "scene/texcoords", scene.texcoords);
  write(out, "scene/colors", scene.colors);
  write(out, "scene/shading_normals", scene.shading_normals);
  out.write_text("scene/description", scene_to_json(scene));
  out.attribute("scene", "geometry_hash", scene.geometry_hash());
  out.make_group("textures");
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& texture = scene.textures[i];
    out.write_array(texture_path(i), Number::kU8, {texture.height, texture.width, 3},
                    texture.rgb.data());
  }
}

void write_elements(Hdf5Writer& out, const StoreContents& contents) {
  const Tessellation& tessellation = contents.tessellation;
  out.make_group("elements");
  write(out, "elements/positions", tessellation.positions);
  write(out, "elements/facets", tessellation.facets);
  write(out, "elements/facet_offsets", tessellation.facet_offsets);
  write(out, "elements/patch_offsets", tessellation.patch_offsets);
  write(out, "elements/patch", tessellation.patch_of_element());
  write(out, "elements/area", tessellation.area);
  write(out, "elements/centroid", tessellation.centroid);
  write(out, "elements/normal", tessellation.normal);
  out.write("elements/reflectance", contents.reflectance);
  out.write("elements/emission", contents.emission);
  write(out, "elements/locator_roots", tessellation.locator.roots);
  write(out, "elements/locator_nodes", tessellation.locator.nodes);
}

void require_block_of(const CountsStream& counts, const SparseCounts& block) {
  validate(block);
  if (block.columns == counts.columns && block.rays == counts.rays) return;
  throw ShapeError(fmt::format("a block of counts has {} columns and {} rays, expected {} and {}",
                               block.columns, block.rays, counts.columns, counts.rays));
}

/// Block by block, so that only the row offsets are in memory.
void write_counts(Hdf5Writer& out, const CountsStream& counts, Progress& progress) {
  const Number patch_type = counts.columns <= 65536 ? Number::kU16 : Number::kU32;
  const Number count_type = counts.largest_count <= 65535 ? Number::kU16 : Number::kU32;
  out.make_group("counts");
  Hdf5Writer::Column patch = out.column("counts/patch", patch_type, counts.nonzeros);
  Hdf5Writer::Column count = out.column("counts/count", count_type, counts.nonzeros);
  std::vector<std::uint64_t> row_offsets{0};
  row_offsets.reserve(counts.rows + 1);
  counts.for_each_block([&](const SparseCounts& block) {
    progress.check();
    require_block_of(counts, block);
    const std::uint64_t before = row_offsets.back();
    for (std::size_t i = 1; i < block.row_offsets.size(); ++i) {
      row_offsets.push_back(before + block.row_offsets[i]);
    }
    patch.append(block.column);
    count.append(block.count);
    progress.advance(block.rows());
  });
  if (row_offsets.size() != counts.rows + 1) {
    throw ShapeError(fmt::format("{} of {} rows of counts", row_offsets.size() - 1, counts.rows));
  }
  patch.finish();
  count.finish();
  write(out, "counts/row_offsets", row_offsets);
  out.attribute("counts", "rays", counts.rays);
  out.attribute("counts", "columns", counts.columns);
}

void write_energy(Hdf5Writer& out, const EnergyReport& energy) {
  out.make_group("energy");
  for_each_field(
      energy, [&](const char* name, const auto& value) { out.attribute("energy", name, value); });
}

void check_contents(const StoreContents& contents) {
  const Tessellation& tessellation = contents.tessellation;
  check_scene(contents.scene);
  check_tessellation(tessellation, contents.scene.mesh.triangles.size());
  check_element_materials(contents.reflectance, contents.emission, tessellation.elements());
  if (contents.counts.rows != tessellation.elements() ||
      contents.counts.columns != tessellation.patches()) {
    throw ShapeError(fmt::format("counts of {} x {} for {} elements and {} patches",
                                 contents.counts.rows, contents.counts.columns,
                                 tessellation.elements(), tessellation.patches()));
  }
}

std::uint32_t largest_count(const SparseCounts& counts) {
  return counts.count.empty() ? 0 : *std::max_element(counts.count.begin(), counts.count.end());
}

CountsStream whole(const SparseCounts& counts) {
  return {counts.rows(),         counts.columns,
          counts.rays,           counts.nonzeros(),
          largest_count(counts), [&counts](const auto& visit) { visit(counts); }};
}

}  // namespace

void write_store(const fs::path& file, const StoreContents& contents, Progress& progress) {
  check_contents(contents);
  progress.begin("write", contents.counts.rows);
  Hdf5Writer out(file, kSealBytes);
  write_root(out);
  write_settings(out, contents.settings);
  write_scene(out, contents.scene);
  write_elements(out, contents);
  write_counts(out, contents.counts, progress);
  write_energy(out, contents.energy);
  out.close();
  write_seal(out.descriptor(), file);
  out.commit();
}

void write_store(const fs::path& file, const BakedScene& baked, Progress& progress) {
  validate(baked);
  write_store(file,
              {baked.scene, baked.tessellation, baked.reflectance, baked.emission, baked.settings,
               baked.energy, whole(baked.counts)},
              progress);
}

}  // namespace relumbre
