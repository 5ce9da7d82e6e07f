#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/cuda/device.h"
#include "relumbre/cuda/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/form_factors_cuda.h"
#include "relumbre/radiosity/scalar_form_factors.h"

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

/// One ray after the other, on the CPU.
FormFactors plainly_traced(const TriangleMesh& mesh, const Tessellation& tessellation,
                           const FormFactorConfig& config, Binning binning) {
  std::vector<std::uint32_t> all(tessellation.elements());
  std::iota(all.begin(), all.end(), 0U);
  return scalar_form_factors(BvhTracer(mesh), ray_epsilon(mesh), tessellation, config, binning,
                             all);
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

TEST(FormFactorsCuda, BatchesOfAnySizeGiveTheSameRows) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  const FormFactors whole = joined(traced(mesh, tessellation, config_of(20), Binning::kPatches));
  // 1, 1, 5 and 16 rows of up to 20 counts, and all of them.
  for (const std::size_t counts :
       {std::size_t{0}, std::size_t{1}, std::size_t{100}, std::size_t{333}, ~std::size_t{0}}) {
    std::vector<Block> blocks;
    const auto sink = [&](std::size_t first, const SparseCounts& rows, const RayTally& tally) {
      blocks.push_back({first, rows, tally});
    };
    trace_form_factors(mesh, tessellation, config_of(20, 7), Binning::kPatches, 0, sink,
                       no_progress(), {counts});
    expect_equal(joined(blocks), whole);
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

TEST(FormFactorsCuda, StopsBetweenBatchesAndPassesOnWhatTheSinkThrows) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  CancelAfterABlock progress;
  std::size_t rows = 0;
  const auto count_rows = [&](std::size_t first, const SparseCounts& block, const RayTally&) {
    EXPECT_EQ(first, rows);
    EXPECT_EQ(block.rows(), 3U);
    rows += block.rows();
  };
  EXPECT_THROW(trace_form_factors(mesh, tessellation, config_of(4, 3), Binning::kPatches, 0,
                                  count_rows, progress, {16}),
               Cancelled);
  EXPECT_GE(rows, 3U);
  EXPECT_LT(rows, 53U);
  const auto full_disk = [](std::size_t, const SparseCounts&, const RayTally&) {
    throw FileError("disk", "full");
  };
  EXPECT_THROW(trace_form_factors(mesh, tessellation, config_of(4), Binning::kPatches, 0, full_disk,
                                  no_progress(), {16}),
               FileError);
}

TEST(FormFactorsCuda, MoreThanIsFreeIsRefusedWithFigures) {
  RELUMBRE_NEEDS_DEVICE();
  const TriangleMesh mesh = open_room();
  const Tessellation tessellation = tessellated(mesh, 26, 53);
  const std::size_t all = current_device().memory_bytes;
  if (!pretend_memory(std::size_t{1} << 20)) GTEST_SKIP() << "the device has its own memory";
  try {
    traced(mesh, tessellation, config_of(1U << 16), Binning::kPatches);
    ADD_FAILURE() << "traced";
  } catch (const OutOfDeviceMemory& error) {
    EXPECT_EQ(std::string(error.what()).find("form factors: needs "), 0U) << error.what();
  }
  pretend_memory(all);
}

/// Little memory makes rows that are counted in it fewer at a time.
TEST(FormFactorsCuda, MatchWhereLittleMemoryIsFree) {
  RELUMBRE_NEEDS_DEVICE();
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {1, 1, 1}, true);
  const Tessellation tessellation = tessellated(mesh, 20, 7001);
  const FormFactorConfig config = config_of(2);
  const auto trace = [&] {
    return joined(traced(mesh, tessellation, config, Binning::kElements, 6500));
  };
  const FormFactors expected = trace();
  const std::size_t all = current_device().memory_bytes;
  if (!pretend_memory(std::size_t{400} << 10)) GTEST_SKIP() << "the device has its own memory";
  const FormFactors found = trace();
  pretend_memory(all);
  expect_equal(found, expected);
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
  EXPECT_TRUE(traced(mesh, Tessellation{}, config_of(8), Binning::kPatches).empty());
  for (Vec3f& p : tessellation.positions) p = {};
  EXPECT_THROW(trace(config_of(8), 0), ValueError);
}

}  // namespace
}  // namespace relumbre::cuda
