#include "relumbre/store/bake.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/radiosity/energy_report.h"
#include "relumbre/scene/element_materials.h"
#include "relumbre/store/bake_journal.h"
#include "relumbre/store/store.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

Tessellation tessellate_scene(const Scene& scene, const BakeConfig& config) {
  const std::vector<std::uint32_t> labels = emissive_labels(scene);
  return tessellate(scene.mesh, {.patches = config.patches,
                                 .elements = config.elements,
                                 .method = config.method,
                                 .separate = labels});
}

/// Everything that the counts depend on, so that no journal of other counts is ever continued.
JournalKey key_of(const Scene& scene, const Tessellation& tessellation, const BakeConfig& config) {
  ContentHash hash;
  hash.add_value(scene.geometry_hash());
  hash.add_value(config.rays);
  hash.add_value(config.seed);
  const auto add = [&hash]<class T>(const std::vector<T>& values) {
    hash.add_values(std::span<const T>(values));
  };
  add(tessellation.positions);
  add(tessellation.facets);
  add(tessellation.facet_offsets);
  add(tessellation.patch_offsets);
  return {.hash = hash.digest(),
          .rows = tessellation.elements(),
          .columns = tessellation.patches(),
          .rays = config.rays};
}

/// Traces the rows that the journal does not have yet. The acceleration structure lives only here.
void trace_missing_rows(const Scene& scene, const Tessellation& tessellation,
                        const BakeConfig& config, BakeJournal& journal, Progress& progress) {
  if (journal.next_row() == tessellation.elements()) return;
  const FormFactorConfig form_factors{
      .rays = config.rays, .seed = config.seed, .row_block = config.row_block};
  const auto keep = [&journal](std::size_t first, const SparseCounts& block,
                               const RayTally& tally) { journal.append(first, block, tally); };
  if (config.tracer) {
    return config.tracer(scene.mesh, tessellation, form_factors, Binning::kPatches,
                         journal.next_row(), keep, progress);
  }
  const RayScene rays(scene.mesh);
  trace_form_factors(tessellation, rays, form_factors, Binning::kPatches, journal.next_row(), keep,
                     progress);
}

CountsStream counts_in(const BakeJournal& journal, const JournalKey& key) {
  return {key.rows,
          key.columns,
          key.rays,
          journal.nonzeros(),
          journal.largest_count(),
          [&journal](const auto& visit) { journal.for_each_block(visit); }};
}

/// Reads the journal once.
EnergyReport audit(const BakeJournal& journal, const Tessellation& tessellation) {
  EnergyAudit audit(tessellation.area, tessellation.patch_offsets);
  journal.for_each_block([&audit](const SparseCounts& block) { audit.add(block); });
  return audit.report(journal.tally());
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Hours of work should not end at a name that cannot be written to.
void check_target(const fs::path& store) {
  std::error_code ignored;
  if (fs::is_directory(store, ignored)) throw FileError(store.string(), "is a folder");
  const fs::path folder = store.has_parent_path() ? store.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw FileError(store.string(), "the folder does not exist");
  }
}

/// Before there is a journal that would have to be cleaned up.
void check_rays(std::uint32_t rays) {
  if (rays == 0) throw ValueError("rays per element: 0 asked, at least 1 is needed");
}

}  // namespace

std::vector<std::uint32_t> emissive_labels(const Scene& scene) {
  std::vector<std::uint32_t> labels(scene.mesh.triangles.size());
  for (std::uint32_t t = 0; t < labels.size(); ++t) {
    if (scene.material_of(t).emissive()) labels[t] = 1 + scene.mesh.object[t];
  }
  return labels;
}

BakeResult bake(const Scene& scene, const BakeConfig& config, const fs::path& store,
                Progress& progress) {
  check_target(store);
  check_rays(config.rays);

  // Triangles to facets, elements and patches.
  progress.begin("patches", 1);
  const Tessellation tessellation = tessellate_scene(scene, config);
  const ElementMaterials materials = element_materials(scene, tessellation);
  progress.check();

  // Form factors: rays from every element, counted by the patch they arrive at.
  const JournalKey key = key_of(scene, tessellation, config);
  BakeJournal journal(BakeJournal::path_for(store), key, config.resume);
  BakeResult result;
  result.resumed_rows = journal.next_row();
  const auto start = std::chrono::steady_clock::now();
  trace_missing_rows(scene, tessellation, config, journal, progress);
  result.trace_seconds = seconds_since(start);

  // Does energy balance? Then the store, and the journal has done its work.
  result.settings = {config.scene_name,       config.method, tessellation.patches(),
                     tessellation.elements(), config.rays,   config.seed};
  result.energy = audit(journal, tessellation);
  result.nonzeros = journal.nonzeros();
  write_store(store,
              {scene, tessellation, materials.reflectance, materials.emission, result.settings,
               result.energy, counts_in(journal, key)},
              progress);
  journal.remove();
  result.file_bytes = fs::file_size(store);
  return result;
}

}  // namespace relumbre
