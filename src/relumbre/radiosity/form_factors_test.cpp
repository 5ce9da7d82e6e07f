#include "relumbre/radiosity/form_factors.h"

#include <atomic>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

Tessellation tessellated(const TriangleMesh& mesh, std::size_t k, std::size_t n) {
  TessellationConfig config;
  config.patches = k, config.elements = n;
  return tessellate(mesh, config);
}

/// A closed room in which two blocks hover.
TriangleMesh room_mesh() {
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {5.5F, 5.5F, 5.6F}, true);
  shapes::add_box(mesh, {0.8F, 0.2F, 0.7F}, {2.4F, 1.65F, 2.3F}, false);
  shapes::add_box(mesh, {3.1F, 0.01F, 2.5F}, {4.7F, 3.3F, 4.1F}, false);
  return mesh;
}

/// It, cut into 40 patches and 331 elements: a prime.
struct Room {
  TriangleMesh mesh = room_mesh();
  Tessellation tessellation = tessellated(mesh, 40, 331);
  RayScene rays{mesh};
};

FormFactorConfig config_of(std::uint32_t rays, std::size_t row_block = 256) {
  FormFactorConfig config;
  config.rays = rays, config.row_block = row_block;
  return config;
}

void expect_equal(const SparseCounts& a, const SparseCounts& b) {
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.row_offsets, b.row_offsets);
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.count, b.count);
}

/// Appends the rows of a block, as a store would.
void gather(SparseCounts& to, const SparseCounts& block) {
  to.columns = block.columns, to.rays = block.rays;
  for (std::size_t row = 0; row < block.rows(); ++row) {
    to.row_offsets.push_back(to.row_offsets.back() + block.row_columns(row).size());
  }
  to.column.insert(to.column.end(), block.column.begin(), block.column.end());
  to.count.insert(to.count.end(), block.count.begin(), block.count.end());
}

double row_sum(const SparseCounts& counts, std::size_t row) {
  double sum = 0;
  for (const std::uint32_t count : counts.row_counts(row)) sum += count;
  return sum / counts.rays;
}

TEST(FormFactor, RowsSumToOneInClosedScene) {
  const Room room;
  const FormFactors factors =
      trace_form_factors(room.tessellation, room.rays, config_of(500), Binning::kPatches);
  EXPECT_NO_THROW(validate(factors.counts));
  ASSERT_EQ(factors.counts.rows(), 331U);
  EXPECT_EQ(factors.counts.columns, 40U);
  EXPECT_EQ(factors.tally.escaped, 0U);
  EXPECT_EQ(factors.tally.back_face, 0U);
  EXPECT_EQ(factors.tally.hits, 331U * 500U);
  for (std::size_t row = 0; row < 331; ++row) EXPECT_EQ(row_sum(factors.counts, row), 1);
}

TEST(FormFactor, NoRayEverLeavesAClosedCube) {
  TriangleMesh mesh;
  shapes::add_box(mesh, {-0.3F, 0.1F, -7.7F}, {12.9F, 3.3F, 0.7F}, true);
  const RayScene rays(mesh);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    FormFactorConfig config = config_of(4096);
    config.seed = seed;
    const FormFactors factors =
        trace_form_factors(tessellated(mesh, 12, 100), rays, config, Binning::kPatches);
    EXPECT_EQ(factors.tally.hits, 100U * 4096U);
  }
}

TEST(FormFactor, BitIdenticalForAnyThreadCount) {
  const Room room;
  const FormFactors expected =
      trace_form_factors(room.tessellation, room.rays, config_of(100), Binning::kElements);
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const ThreadLimit limit(threads);
    const FormFactors factors =
        trace_form_factors(room.tessellation, room.rays, config_of(100), Binning::kElements);
    expect_equal(factors.counts, expected.counts);
    EXPECT_EQ(factors.tally.hits, expected.tally.hits);
  }
}

TEST(FormFactor, BlocksOfAnySizeHoldTheSameRows) {
  const Room room;
  const FormFactors expected =
      trace_form_factors(room.tessellation, room.rays, config_of(64), Binning::kPatches);
  for (const std::size_t row_block : {1U, 3U, 4U, 7U, 64U, 330U, 331U, 1000U}) {
    SparseCounts all;
    RayTally tally;
    std::size_t next = 0;
    const auto sink = [&](std::size_t first, const SparseCounts& block, const RayTally& part) {
      EXPECT_EQ(first, next);
      EXPECT_EQ(block.rows(), std::min<std::size_t>(row_block, 331 - first));
      EXPECT_EQ(part.hits + part.back_face + part.escaped, block.rows() * 64);
      next += block.rows();
      gather(all, block);
      tally += part;
    };
    trace_form_factors(room.tessellation, room.rays, config_of(64, row_block), Binning::kPatches, 0,
                       sink);
    expect_equal(all, expected.counts);
    EXPECT_EQ(tally.hits, expected.tally.hits);
  }
}

TEST(FormFactor, ResumedRowsAreTheSuffix) {
  const Room room;
  const FormFactors whole =
      trace_form_factors(room.tessellation, room.rays, config_of(64), Binning::kPatches);
  for (const std::size_t first_row : {1U, 100U, 330U, 331U}) {
    SparseCounts rest;
    rest.columns = 40, rest.rays = 64;
    trace_form_factors(room.tessellation, room.rays, config_of(64, 50), Binning::kPatches,
                       first_row,
                       [&](std::size_t first, const SparseCounts& block, const RayTally&) {
                         EXPECT_EQ(first, first_row + rest.rows());
                         gather(rest, block);
                       });
    ASSERT_EQ(rest.rows(), 331 - first_row);
    for (std::size_t row = 0; row < rest.rows(); ++row) {
      EXPECT_TRUE(
          std::ranges::equal(rest.row_columns(row), whole.counts.row_columns(first_row + row)));
      EXPECT_TRUE(
          std::ranges::equal(rest.row_counts(row), whole.counts.row_counts(first_row + row)));
    }
  }
}

TEST(FormFactor, PatchCountsAreElementCountsSummed) {
  const Room room;
  const SparseCounts patches =
      trace_form_factors(room.tessellation, room.rays, config_of(200), Binning::kPatches).counts;
  const SparseCounts elements =
      trace_form_factors(room.tessellation, room.rays, config_of(200), Binning::kElements).counts;
  EXPECT_NO_THROW(validate(elements));
  const std::vector<std::uint32_t> patch = room.tessellation.patch_of_element();
  for (std::size_t row = 0; row < patches.rows(); ++row) {
    std::vector<std::uint32_t> summed(patches.columns), direct(patches.columns);
    for (std::size_t e = 0; e < elements.row_columns(row).size(); ++e) {
      summed[patch[elements.row_columns(row)[e]]] += elements.row_counts(row)[e];
    }
    for (std::size_t e = 0; e < patches.row_columns(row).size(); ++e) {
      direct[patches.row_columns(row)[e]] = patches.row_counts(row)[e];
    }
    EXPECT_EQ(summed, direct);
  }
}

TEST(FormFactor, ReciprocityHoldsWithinNoise) {
  const Room room;
  const std::uint32_t rays = 4096;
  const SparseCounts counts =
      trace_form_factors(room.tessellation, room.rays, config_of(rays), Binning::kPatches).counts;
  const std::size_t k = room.tessellation.patches();
  std::vector<double> flow(k * k);  // A_p F_pq
  std::vector<double> largest(k);
  for (std::size_t p = 0; p < k; ++p) {
    for (std::size_t i = room.tessellation.patch_offsets[p];
         i < room.tessellation.patch_offsets[p + 1]; ++i) {
      const double area = room.tessellation.area[i];
      largest[p] = std::max(largest[p], area);
      for (std::size_t e = 0; e < counts.row_columns(i).size(); ++e) {
        flow[p * k + counts.row_columns(i)[e]] += area * counts.row_counts(i)[e] / rays;
      }
    }
  }
  for (std::size_t p = 0; p < k; ++p) {
    for (std::size_t q = 0; q < p; ++q) {
      const double a = flow[p * k + q], b = flow[q * k + p];
      const double variance = std::max(largest[p], largest[q]) * (a + b) / rays;
      EXPECT_NEAR(a, b, 5 * std::sqrt(variance) + 20 * largest[p] / rays);
    }
  }
}

TEST(FormFactor, BacksOfOneSidedSurfacesAbsorb) {
  TriangleMesh mesh;  // the upper square turns its back
  shapes::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  shapes::add_quad(mesh, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  const FormFactors factors = trace_form_factors(tessellated(mesh, 4, 64), RayScene(mesh),
                                                 config_of(1024), Binning::kPatches);
  EXPECT_EQ(factors.tally.hits, 0U);
  EXPECT_EQ(factors.tally.hits + factors.tally.back_face + factors.tally.escaped, 64U * 1024U);
  // Only the lower square sees anything: half of the elements.
  EXPECT_NEAR(static_cast<double>(factors.tally.back_face), 64 * 1024 * 0.1998249 / 2, 150);
}

TEST(FormFactor, BothSidesOfTwoSidedSurfacesTakePart) {
  TriangleMesh mesh;
  shapes::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);
  shapes::add_quad(mesh, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, true);
  const Tessellation tessellation = tessellated(mesh, 8, 64);
  const FormFactors factors =
      trace_form_factors(tessellation, RayScene(mesh), config_of(1024), Binning::kElements);
  EXPECT_EQ(factors.tally.back_face, 0U);
  EXPECT_NEAR(static_cast<double>(factors.tally.hits), 64 * 1024 * 0.1998249 / 2, 150);
  for (std::size_t row = 0; row < 64; ++row) {
    const bool inner = (tessellation.centroid[row].z < 0.5F) == (tessellation.normal[row].z > 0);
    EXPECT_EQ(factors.counts.row_columns(row).empty(), !inner);
  }
}

/// Cancels after a number of finished rows.
class CancelAfter : public Progress {
 public:
  explicit CancelAfter(std::uint64_t rows) : left_(static_cast<std::int64_t>(rows)) {}
  void advance(std::uint64_t units) override { left_ -= static_cast<std::int64_t>(units); }
  [[nodiscard]] bool cancelled() const override { return left_ <= 0; }

 private:
  std::atomic<std::int64_t> left_;
};

TEST(FormFactor, CancellationKeepsWholeBlocks) {
  const TriangleMesh mesh = room_mesh();
  const Tessellation tessellation = tessellated(mesh, 40, 4000);
  const RayScene rays(mesh);
  const ThreadLimit limit(2);
  CancelAfter progress(300);
  std::size_t rows = 0;
  const auto sink = [&](std::size_t first, const SparseCounts& block, const RayTally&) {
    EXPECT_EQ(first, rows);
    EXPECT_EQ(block.rows(), 100U);
    rows += block.rows();
  };
  EXPECT_THROW(trace_form_factors(tessellation, rays, config_of(16, 100), Binning::kPatches, 0,
                                  sink, progress),
               Cancelled);
  EXPECT_GE(rows, 300U);
  EXPECT_LT(rows, 4000U);
}

TEST(FormFactor, WhatTheSinkThrowsIsPassedOn) {
  const Room room;
  const auto sink = [](std::size_t, const SparseCounts&, const RayTally&) {
    throw FileError("store.h5", "no space left");
  };
  EXPECT_THROW(trace_form_factors(room.tessellation, room.rays, config_of(16, 10),
                                  Binning::kPatches, 0, sink),
               FileError);
}

TEST(FormFactor, RefusesBadConfigurations) {
  const Room room;
  const auto trace = [&](const FormFactorConfig& config, std::size_t first_row) {
    trace_form_factors(room.tessellation, room.rays, config, Binning::kPatches, first_row,
                       [](std::size_t, const SparseCounts&, const RayTally&) {});
  };
  EXPECT_THROW(trace(config_of(0), 0), ValueError);
  EXPECT_THROW(trace(config_of(16, 0), 0), ValueError);
  EXPECT_THROW(trace(config_of(16), 332), ValueError);
}

}  // namespace
}  // namespace relumbre
