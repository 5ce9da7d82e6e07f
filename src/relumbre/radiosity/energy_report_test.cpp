#include "relumbre/radiosity/energy_report.h"

#include <array>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/tessellation.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

/// Two patches of two elements each; patch 0 twice as large.
///            to 0  to 1
///   element 0:  0    10        area 2
///   element 1:  0     6        area 2
///   element 2:  8     0        area 1
///   element 3: 10     0        area 1
struct Small {
  SparseCounts counts;
  std::array<float, 4> area = {2, 2, 1, 1};
  std::array<std::uint32_t, 3> patch_offsets = {0, 2, 4};
  RayTally tally{34, 2, 4};

  Small() {
    counts.columns = 2, counts.rays = 10;
    counts.row_offsets = {0, 1, 2, 3, 4};
    counts.column = {1, 1, 0, 0};
    counts.count = {10, 6, 8, 10};
  }
};

TEST(EnergyReport, IsWhatTheHandComputes) {
  const Small s;
  const EnergyReport report = energy_report(s.counts, s.area, s.patch_offsets, s.tally);
  EXPECT_EQ(report.elements, 4U);
  EXPECT_EQ(report.patches, 2U);
  EXPECT_EQ(report.rays, 40U);
  EXPECT_DOUBLE_EQ(report.row_sum_min, 0.6);
  EXPECT_DOUBLE_EQ(report.row_sum_max, 1);
  EXPECT_DOUBLE_EQ(report.row_sum_mean, (2 * 1 + 2 * 0.6 + 0.8 + 1) / 6);
  EXPECT_DOUBLE_EQ(report.open_rows, 0.5);
  // A_0 F_01 = 2 + 1.2, A_1 F_10 = 0.8 + 1.
  EXPECT_NEAR(report.reciprocity_error, 2 * (3.2 - 1.8) / (3.2 + 1.8), 1e-12);
  EXPECT_DOUBLE_EQ(report.back_face, 2.0 / 40);
  EXPECT_DOUBLE_EQ(report.escaped, 4.0 / 40);
}

TEST(EnergyReport, PairsSeenFromOneSideOnlyCountTwice) {
  Small s;
  s.counts.row_offsets = {0, 1, 2, 2, 2};
  s.counts.column = {1, 1};
  s.counts.count = {10, 6};
  EXPECT_NEAR(energy_report(s.counts, s.area, s.patch_offsets, s.tally).reciprocity_error, 2,
              1e-12);
}

TEST(EnergyReport, ReciprocityErrorOfASoundSceneIsItsNoise) {
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {5, 4, 6}, true);
  shapes::add_box(mesh, {1, 1, 1}, {2, 3, 4}, false);
  TessellationConfig config;
  config.patches = 60, config.elements = 600;
  const Tessellation tessellation = tessellate(mesh, config);
  FormFactorConfig rays;
  rays.rays = 256;
  const FormFactors factors =
      trace_form_factors(tessellation, RayScene(mesh), rays, Binning::kPatches);
  const EnergyReport report =
      energy_report(factors.counts, tessellation.area, tessellation.patch_offsets, factors.tally);
  EXPECT_EQ(report.row_sum_min, 1);
  EXPECT_EQ(report.open_rows, 0);
  EXPECT_GT(report.reciprocity_error, 0);
  EXPECT_LT(report.reciprocity_error, 1.2 * report.reciprocity_noise);
  EXPECT_LT(report.reciprocity_noise, 0.2);
}

/// The rows [first, last) of counts.
SparseCounts rows_of(const SparseCounts& counts, std::size_t first, std::size_t last) {
  SparseCounts rows;
  rows.columns = counts.columns, rows.rays = counts.rays;
  for (std::size_t i = first; i < last; ++i) {
    const auto columns = counts.row_columns(i), hits = counts.row_counts(i);
    rows.column.insert(rows.column.end(), columns.begin(), columns.end());
    rows.count.insert(rows.count.end(), hits.begin(), hits.end());
    rows.row_offsets.push_back(rows.column.size());
  }
  return rows;
}

TEST(EnergyReport, DoesNotDependOnTheBlocksItIsReadBy) {
  const Small s;
  const EnergyReport whole = energy_report(s.counts, s.area, s.patch_offsets, s.tally);
  for (std::size_t cut = 0; cut <= 4; ++cut) {
    EnergyAudit audit(s.area, s.patch_offsets);
    audit.add(rows_of(s.counts, 0, cut));
    audit.add(rows_of(s.counts, cut, 4));
    const EnergyReport report = audit.report(s.tally);
    EXPECT_EQ(report.row_sum_mean, whole.row_sum_mean);
    EXPECT_EQ(report.reciprocity_error, whole.reciprocity_error);
    EXPECT_EQ(report.reciprocity_noise, whole.reciprocity_noise);
  }
}

TEST(EnergyReport, RefusesMissingRowsAndRowsTooMany) {
  const Small s;
  EnergyAudit audit(s.area, s.patch_offsets);
  audit.add(rows_of(s.counts, 0, 3));
  EXPECT_THROW((void)audit.report(s.tally), ShapeError);
  EXPECT_THROW(audit.add(rows_of(s.counts, 0, 2)), ShapeError);
}

TEST(EnergyReport, EmptyBakeIsAllZeros) {
  const std::array<std::uint32_t, 1> no_patches = {0};
  const EnergyReport report = energy_report({}, {}, no_patches, {});
  EXPECT_EQ(report.row_sum_mean, 0);
  EXPECT_EQ(report.reciprocity_error, 0);
  EXPECT_EQ(report.escaped, 0);
}

TEST(EnergyReport, RefusesSizesThatDisagree) {
  const Small s;
  EXPECT_THROW(energy_report(s.counts, std::span(s.area).first(3), s.patch_offsets, s.tally),
               ShapeError);
  EXPECT_THROW(energy_report(s.counts, s.area, std::span(s.patch_offsets).first(2), s.tally),
               ShapeError);
}

}  // namespace
}  // namespace relumbre
