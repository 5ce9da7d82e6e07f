#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/cuda/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/form_factors_cuda.h"
#include "relumbre/radiosity/hit_labels.h"
#include "relumbre/radiosity/ray_maps.h"
#include "relumbre/radiosity/ray_pattern.h"
#include "relumbre/visibility/bvh_tracer.h"

namespace relumbre::cuda {
namespace {

Tessellation tessellated(const TriangleMesh& mesh, std::size_t k, std::size_t n) {
  TessellationConfig config;
  config.patches = k, config.elements = n;
  return tessellate(mesh, config);
}

/// A room that is open at the top, with a block and a two-sided sheet in it: rays escape, land on
/// backs, and on both sides of the sheet.
TriangleMesh open_room() {
  TriangleMesh mesh;
  shapes::add_quad(mesh, {0, 0, 0}, {0, 0, 3}, {3, 0, 0});
  shapes::add_quad(mesh, {0, 0, 0}, {3, 0, 0}, {0, 2, 0});
  shapes::add_quad(mesh, {0, 0, 0}, {0, 2, 0}, {0, 0, 3});
  shapes::add_quad(mesh, {3, 0, 0}, {0, 2, 0}, {0, 0, 3});  // turned outwards: a back inside
  shapes::add_box(mesh, {0.5F, 0.01F, 0.5F}, {1.2F, 0.9F, 1.1F}, false);
  shapes::add_quad(mesh, {1.7F, 0.1F, 0.4F}, {0.2F, 0, 1.5F}, {0, 1.1F, 0.1F}, true);
  return mesh;
}

FormFactorConfig config_of(std::uint32_t rays, std::size_t row_block = 256) {
  FormFactorConfig config;
  config.rays = rays, config.row_block = row_block, config.seed = 5;
  return config;
}

/// A block of rows as a sink gets it.
struct Block {
  std::size_t first;
  SparseCounts counts;
  RayTally tally;
};

std::vector<Block> traced(const TriangleMesh& mesh, const Tessellation& tessellation,
                          const FormFactorConfig& config, Binning binning,
                          std::size_t first_row = 0) {
  std::vector<Block> blocks;
  trace_form_factors(mesh, tessellation, config, binning, first_row,
                     [&](std::size_t first, const SparseCounts& counts, const RayTally& tally) {
                       blocks.push_back({first, counts, tally});
                     });
  return blocks;
}

FormFactors joined(const std::vector<Block>& blocks) {
  FormFactors all;
  for (const Block& block : blocks) {
    all.counts.columns = block.counts.columns, all.counts.rays = block.counts.rays;
    append(all.counts, block.counts);
    all.tally += block.tally;
  }
  return all;
}

/// The column that a ray lands on.
std::uint32_t land(const EmittingSurface& surface, const std::array<float, 4>& at,
                   const BvhTracer& scene, const LabelLocator& locator) {
  ray_maps::Point point{at[0], at[1], at[2], at[3]};
  const std::uint32_t facet = ray_maps::choose_facet(
      surface.cumulative(), static_cast<std::uint32_t>(surface.size()), point.x);
  alignas(16) const EmittingSurface::Record record = surface.records()[facet];
  const ElementRay ray = element_ray(record.data(), point);
  const Hit hit = scene.closest({{ray.origin_x, ray.origin_y, ray.origin_z},
                                 0,
                                 {ray.direction_x, ray.direction_y, ray.direction_z}});
  if (!hit) return kEscaped;
  const std::uint32_t label = locator.find(hit.triangle, hit.back, hit.u, hit.v);
  return label == kNone ? kAbsorbed : label;
}

/// One ray after the other, on the CPU.
FormFactors plainly_traced(const TriangleMesh& mesh, const Tessellation& tessellation,
                           const FormFactorConfig& config, Binning binning) {
  const BvhTracer scene(mesh);
  const LabelLocator locator = label_locator(tessellation, binning);
  const RayPattern pattern(config.rays);
  FormFactors all;
  all.counts.columns = columns_of(tessellation, binning), all.counts.rays = config.rays;
  for (std::size_t element = 0; element < tessellation.elements(); ++element) {
    EmittingSurface surface;
    load_element(tessellation, element, ray_epsilon(mesh), surface);
    const DigitalShift shift = digital_shift(config.seed, element);
    std::map<std::uint32_t, std::uint32_t> row;
    for (std::size_t r = 0; r < config.rays; ++r) {
      std::array<float, 4> at{};
      for (std::size_t d = 0; d < 4; ++d)
        at[d] = ray_maps::to_cell(pattern.coordinate(d)[r] ^ shift[d]);
      const std::uint32_t column = land(surface, at, scene, locator);
      if (column < kAbsorbed) ++row[column];
      all.tally.hits += column < kAbsorbed ? 1 : 0;
      all.tally.back_face += column == kAbsorbed ? 1 : 0;
      all.tally.escaped += column == kEscaped ? 1 : 0;
    }
    for (const auto& [column, count] : row) {
      all.counts.column.push_back(column);
      all.counts.count.push_back(count);
    }
    all.counts.row_offsets.push_back(all.counts.column.size());
  }
  return all;
}

void expect_equal(const FormFactors& a, const FormFactors& b) {
  EXPECT_EQ(a.counts.columns, b.counts.columns);
  EXPECT_EQ(a.counts.rays, b.counts.rays);
  EXPECT_TRUE(a.counts.row_offsets == b.counts.row_offsets);
  EXPECT_TRUE(a.counts.column == b.counts.column);
  EXPECT_TRUE(a.counts.count == b.counts.count);
  EXPECT_EQ(a.tally.hits, b.tally.hits);
  EXPECT_EQ(a.tally.back_face, b.tally.back_face);
  EXPECT_EQ(a.tally.escaped, b.tally.escaped);
}

TEST(FormFactorsCuda, MatchOneRayAfterTheOther) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  for (const std::uint32_t rays : {1U, 17U, 31U, 32U, 33U, 200U}) {
    for (const Binning binning : {Binning::kPatches, Binning::kElements}) {
      const FormFactors expected = plainly_traced(mesh, tessellation, config_of(rays), binning);
      const FormFactors found = joined(traced(mesh, tessellation, config_of(rays), binning));
      expect_equal(found, expected);
      EXPECT_NO_THROW(validate(found.counts));
    }
  }
}

TEST(FormFactorsCuda, RaysEscapeAndLandOnBacks) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  const RayTally tally = joined(traced(mesh, tessellation, config_of(50), Binning::kPatches)).tally;
  EXPECT_GT(tally.back_face, 100U);
  EXPECT_GT(tally.escaped, 100U);
  EXPECT_EQ(tally.hits + tally.back_face + tally.escaped, 50U * 53);
}

TEST(FormFactorsCuda, MatchWithElementsOfManyFacets) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = shapes::sphere(9);  // 288 facets in 7 elements
  TriangleMesh inside = mesh;
  for (Index3& t : inside.triangles) std::swap(t[1], t[2]);
  const Tessellation tessellation = tessellated(inside, 1, 7);
  expect_equal(joined(traced(inside, tessellation, config_of(65), Binning::kElements)),
               plainly_traced(inside, tessellation, config_of(65), Binning::kElements));
}

TEST(FormFactorsCuda, MatchOnOneTriangle) {
  RELUMBRE_NEEDS_DEVICE();
  TriangleMesh mesh;
  shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Tessellation tessellation = tessellated(mesh, 1, 1);
  const FormFactors found = joined(traced(mesh, tessellation, config_of(40), Binning::kPatches));
  EXPECT_EQ(found.counts.rows(), 1U);
  EXPECT_EQ(found.counts.nonzeros(), 0U);
  EXPECT_EQ(found.tally.escaped, 40U);
}

/// More columns than are counted in shared memory.
TEST(FormFactorsCuda, MatchWhereRowsAreCountedInTheDevicesMemory) {
  RELUMBRE_NEEDS_DEVICE();
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {1, 1, 1}, true);
  const Tessellation tessellation = tessellated(mesh, 20, 7001);
  const FormFactorConfig config = config_of(3);
  expect_equal(joined(traced(mesh, tessellation, config, Binning::kElements)),
               plainly_traced(mesh, tessellation, config, Binning::kElements));
}

TEST(FormFactorsCuda, BlocksComeInOrderFromAnyRow) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  const FormFactors whole = joined(traced(mesh, tessellation, config_of(9), Binning::kPatches));
  for (const std::size_t first : {0U, 1U, 50U, 53U}) {
    const auto blocks = traced(mesh, tessellation, config_of(9, 10), Binning::kPatches, first);
    std::size_t row = first;
    for (const Block& block : blocks) {
      EXPECT_EQ(block.first, row);
      EXPECT_EQ(block.counts.rows(), std::min<std::size_t>(10, 53 - row));
      for (std::size_t i = 0; i < block.counts.rows(); ++i, ++row) {
        const auto found = block.counts.row_counts(i), expected = whole.counts.row_counts(row);
        EXPECT_TRUE(std::equal(found.begin(), found.end(), expected.begin(), expected.end()));
      }
    }
    EXPECT_EQ(row, 53U);
  }
}

/// Is cancelled once a block has been handed over.
class CancelAfterABlock : public Progress {
 public:
  void advance(std::uint64_t) override { cancelled_ = true; }
  [[nodiscard]] bool cancelled() const override { return cancelled_; }

 private:
  bool cancelled_ = false;
};

/// 2^23 counts are a batch: here, eight rows.
TEST(FormFactorsCuda, StopsBetweenBatchesAndPassesOnWhatTheSinkThrows) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  CancelAfterABlock progress;
  progress.advance(1);
  const auto ignore = [](std::size_t, const SparseCounts&, const RayTally&) {};
  EXPECT_THROW(
      trace_form_factors(mesh, tessellation, config_of(4), Binning::kPatches, 0, ignore, progress),
      Cancelled);
  const auto full_disk = [](std::size_t, const SparseCounts&, const RayTally&) {
    throw FileError("disk", "full");
  };
  EXPECT_THROW(
      trace_form_factors(mesh, tessellation, config_of(4), Binning::kPatches, 0, full_disk),
      FileError);
}

TEST(FormFactorsCuda, RefusesWhatTheCpuRefuses) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  Tessellation tessellation = tessellated(mesh, 26, 53);
  const auto trace = [&](const FormFactorConfig& config, std::size_t first_row) {
    traced(mesh, tessellation, config, Binning::kPatches, first_row);
  };
  EXPECT_THROW(trace(config_of(0), 0), ValueError);
  EXPECT_THROW(trace(config_of((1U << 26) + 1), 0), ValueError);
  EXPECT_THROW(trace(config_of(8, 0), 0), ValueError);
  EXPECT_THROW(trace(config_of(8), 54), ValueError);
  for (Vec3f& p : tessellation.positions) p = {};
  EXPECT_THROW(trace(config_of(8), 0), ValueError);
}

}  // namespace
}  // namespace relumbre::cuda
