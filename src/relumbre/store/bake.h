/// From a scene to its store: the whole of a bake.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/scene/scene.h"
#include "relumbre/store/baked_scene.h"

namespace relumbre {

struct BakeConfig {
  std::size_t patches = 864;     ///< k
  std::size_t elements = 13824;  ///< n ≥ k
  PatchMethod method = PatchMethod::kCluster;
  std::uint32_t rays = 512;  ///< per element; powers of two are stratified best
  std::uint64_t seed = 1;
  std::size_t row_block = 256;  ///< rows a journal entry; does not change the result
  /// Continue the journal of an interrupted bake, if there is one. Without it, a journal that is
  /// there is overwritten: a new bake was asked for.
  bool resume = false;
  std::string scene_name = {};  ///< for reports
  /// Who traces the form factors; empty: the CPU.
  FormFactorTracer tracer = {};
};

struct BakeResult {
  BakeSettings settings;
  EnergyReport energy;
  std::uint64_t nonzeros = 0;
  std::uint64_t resumed_rows = 0;  ///< taken from the journal instead of traced
  double trace_seconds = 0;        ///< of the form factors alone
  std::uint64_t file_bytes = 0;
};

/// Triangles with an emissive material get patches of their own, an object at a time: label 1 +
/// object index, 0 for all others. What TessellationConfig::separate wants.
std::vector<std::uint32_t> emissive_labels(const Scene& scene);

/// Computes form factors of `scene` and writes the store. Finished rows go to the journal
/// "<store>.partial"; after a cancellation, a kill or a full disk they are kept, and a bake with
/// `resume` ends with the same store, bit by bit. The journal is deleted once the store is there.
/// Memory: see estimate_bake(). The counts are on disk, and pass through memory a block at a time.
/// Throws ValueError (patches and elements that cannot be reached), FileError (the store cannot be
/// written; the journal is of another scene or other settings, is damaged, or is in use),
/// Cancelled.
BakeResult bake(const Scene& scene, const BakeConfig& config, const std::filesystem::path& store,
                Progress& progress = no_progress());

/// What a bake will need, known beforehand. Bytes in memory; the stages follow each other.
struct BakeEstimate {
  std::uint64_t program_bytes = 0;       ///< code, libraries and their buffers, however small
  std::uint64_t scene_bytes = 0;         ///< the scene, throughout
  std::uint64_t tessellation_bytes = 0;  ///< the elements, from the second stage on
  std::uint64_t tessellate_bytes = 0;    ///< stage 1: cutting and clustering, elements included
  std::uint64_t trace_bytes = 0;         ///< stage 2: acceleration structure, rows on their way
  std::uint64_t report_bytes = 0;        ///< stage 3: the exchange between patches
  std::uint64_t counts_bytes = 0;        ///< at most: the counts as relighting reads them
  std::uint64_t disk_bytes = 0;          ///< at most: journal and store together
  /// An upper estimate of what is in use at any time.
  [[nodiscard]] std::uint64_t peak_bytes() const {
    return program_bytes + scene_bytes +
           std::max(tessellate_bytes, tessellation_bytes + std::max(trace_bytes, report_bytes));
  }
};

/// From the sizes alone: touches no array but `two_sided`. O(triangles).
BakeEstimate estimate_bake(const Scene& scene, const BakeConfig& config);

}  // namespace relumbre
