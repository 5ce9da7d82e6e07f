/// Form factors by quasi-random cosine-weighted rays from whole elements, as exact counts.
#pragma once

#include <cstdint>
#include <functional>

#include "relumbre/base/progress.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/radiosity/sparse_counts.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre {

struct FormFactorConfig {
  std::uint32_t rays = 512;  ///< per element; powers of two are stratified best
  std::uint64_t seed = 1;
  std::size_t row_block = 256;  ///< rows handed to the sink at a time
};

/// What became of all rays. The counts add up: hits + back_face + escaped = rays · n.
struct RayTally {
  std::uint64_t hits = 0;
  std::uint64_t back_face = 0;  ///< absorbed by the back of a one-sided surface
  std::uint64_t escaped = 0;    ///< left the scene
  RayTally& operator+=(const RayTally& o) {
    hits += o.hits, back_face += o.back_face, escaped += o.escaped;
    return *this;
  }
};

/// Columns of the counts: what a ray's landing facet is binned by.
enum class Binning { kPatches, kElements };

/// Rows [first, first + block.rows()) are complete. Called in ascending order of rows, from one
/// thread at a time.
using RowSink = std::function<void(std::size_t first, const SparseCounts& block, const RayTally&)>;

/// Shoots config.rays rays from each element in [first_row, n) and hands the counts to `sink` in
/// row blocks. Row i depends only on (seed, i): any number of threads, any block size and any
/// first_row give bit-identical counts, and the rays of kPatches and kElements are the same. The
/// sink runs while the next rows are traced. Memory: O(threads · max(row_block, 128) · min(rays,
/// columns)) for the rows on their way, 4 bytes a column and thread, 16 bytes a ray of one element,
/// and 8 bytes a triangle. A block is only ever handed over whole; cancellation throws Cancelled
/// between blocks, and what the sink throws is passed on. Throws ValueError for rays outside [1,
/// 2^26], row_block 0, a first_row above n, or an element without area.
void trace_form_factors(const Tessellation& tessellation, const RayScene& rays,
                        const FormFactorConfig& config, Binning binning, std::size_t first_row,
                        const RowSink& sink, Progress& progress = no_progress());

/// Another who does the same, such as a GPU: mesh, tessellation, figures, binning, first row, sink.
/// `mesh` is what the tessellation was made from.
using FormFactorTracer =
    std::function<void(const TriangleMesh&, const Tessellation&, const FormFactorConfig&, Binning,
                       std::size_t first_row, const RowSink&, Progress&)>;

/// The same, gathered in memory: little more than 8 bytes a non-zero.
struct FormFactors {
  SparseCounts counts;
  RayTally tally;
};
FormFactors trace_form_factors(const Tessellation& tessellation, const RayScene& rays,
                               const FormFactorConfig& config, Binning binning,
                               Progress& progress = no_progress());

}  // namespace relumbre
