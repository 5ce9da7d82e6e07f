#include "relumbre/render/shading.h"

#include <limits>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/colored_mesh.h"
#include "relumbre/render/test_support.h"

namespace relumbre {
namespace {

using test::Cut;

/// A floor and a wall that meet at a crease: objects 0 (z = 0) and 1 (x = 0).
struct Corner {
  Cut cut;
  DisplayMesh display;

  explicit Corner(std::size_t elements) : cut(scene(), 4, elements) {
    display = conforming_mesh(cut.tessellation);
  }
  static Scene scene() {
    Scene s;
    const std::uint32_t m = test::add_material(s, Rgb(0.5F));
    test::add_quad(s, m, {}, {1, 0, 0}, {0, 1, 0});
    test::add_quad(s, m, {}, {0, 1, 0}, {0, 0, 1});
    return s;
  }
  [[nodiscard]] DisplayField field(std::span<const Rgb> values) const {
    return {cut.tessellation, display, values};
  }
};

std::vector<Rgb> random_values(std::size_t n) {
  RandomStream random(7);
  std::vector<Rgb> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(Rgb(random.uniform()));
  return values;
}

/// The field under a point of the floor.
Rgb on_floor(const Corner& corner, const DisplayField& field, float x, float y) {
  const Hit hit = corner.cut.rays.closest({.origin = {x, y, 0.5F}, .direction = {0, 0, -1}});
  return field.at(hit.triangle, hit.back, hit.u, hit.v);
}

TEST(DisplayField, ConstantIsConstant) {
  for (const std::size_t n : {4U, 37U, 200U}) {
    const Corner corner(n);
    const std::vector<Rgb> values(n, Rgb{1, 2, 3});
    const DisplayField field = corner.field(values);
    RandomStream random(1);
    for (int i = 0; i < 1000; ++i) {
      const Rgb c = on_floor(corner, field, random.uniform(), random.uniform());
      EXPECT_NEAR(c.x, 1, 1e-5F);
      EXPECT_NEAR(c.z, 3, 1e-5F);
    }
  }
}

TEST(DisplayField, IsContinuousOverCoplanarFacets) {
  const Corner corner(67);
  const std::vector<Rgb> values = random_values(67);
  const DisplayField field = corner.field(values);
  for (const float y : {0.1F, 0.333F, 0.71F}) {
    Rgb before = on_floor(corner, field, 1e-4F, y);
    for (int i = 1; i < 20000; ++i) {
      const Rgb now = on_floor(corner, field, 1e-4F + static_cast<float>(i) * 4.99e-5F, y);
      ASSERT_LT(std::abs(now.x - before.x), 5e-3F) << "at " << i;
      before = now;
    }
  }
}

TEST(DisplayField, DoesNotCrossCreases) {
  const Corner corner(64);
  std::vector<Rgb> values(64);
  for (const std::size_t i : corner.cut.elements_of(1)) values[i] = Rgb(1.0F);
  const DisplayField field = corner.field(values);
  EXPECT_EQ(on_floor(corner, field, 1e-3F, 0.5F), Rgb{});
}

TEST(DisplayField, IsZeroWhereNothingReflects) {
  const Corner corner(8);
  const std::vector<Rgb> values(8, Rgb(1.0F));
  EXPECT_EQ(corner.field(values).at(0, true, 0.2F, 0.2F), Rgb{});
}

TEST(DisplayField, StaysWithinItsValues) {
  const Corner corner(129);
  const std::vector<Rgb> values = random_values(129);
  const DisplayField field = corner.field(values);
  RandomStream random(3);
  for (int i = 0; i < 2000; ++i) {
    const Rgb c = on_floor(corner, field, random.uniform(), random.uniform());
    EXPECT_GE(c.x, 0);
    EXPECT_LE(c.x, 1.00001F);
  }
}

TEST(FillUnknown, TakesNeighboursValuesAndKeepsWhatIsKnown) {
  const Corner corner(64);
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<Rgb> values(64, Rgb{2, 3, 4});
  const std::size_t hole = corner.cut.elements_of(0)[5];
  values[hole] = {2, unknown, 4};
  const auto filled = fill_unknown(corner.cut.tessellation, corner.display, values);
  EXPECT_NEAR(filled[hole].y, 3, 1e-5F);
  EXPECT_EQ(filled[hole].x, 2);
}

TEST(FillUnknown, IsZeroWhereNothingIsKnown) {
  const Corner corner(32);
  std::vector<Rgb> values(32, Rgb(std::numeric_limits<float>::quiet_NaN()));
  for (const Rgb& v : fill_unknown(corner.cut.tessellation, corner.display, values)) {
    EXPECT_EQ(v, Rgb{});
  }
}

TEST(Smoothed, KeepsConstantsAndReducesNoise) {
  const Corner corner(256);
  const std::vector<Rgb> flat(256, Rgb(2.0F));
  for (const Rgb& v : smoothed(corner.cut.tessellation, corner.display, flat, 3)) {
    EXPECT_NEAR(v.x, 2, 1e-5F);
  }
  const auto variance = [](std::span<const Rgb> values) {
    float sum = 0, squares = 0;
    for (const Rgb& v : values) sum += v.x, squares += v.x * v.x;
    const auto n = static_cast<float>(values.size());
    return squares / n - sum * sum / n / n;
  };
  const auto noisy = random_values(256);
  const auto calm = smoothed(corner.cut.tessellation, corner.display, noisy, 1);
  EXPECT_LT(variance(calm), 0.4F * variance(noisy));
  EXPECT_EQ(smoothed(corner.cut.tessellation, corner.display, noisy, 0), noisy);
}

TEST(ColoredMesh, CoversTheSceneAndCarriesTheField) {
  const Corner corner(50);
  const auto values = random_values(50);
  const ColoredMesh mesh = colored_mesh(corner.cut.tessellation, corner.display, values);
  ASSERT_EQ(mesh.positions.size(), mesh.colors.size());
  double area = 0;
  for (const Index3& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]];
    area +=
        static_cast<double>(length(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) / 2);
  }
  EXPECT_NEAR(area, 2, 1e-5);
  const DisplayField field = corner.field(values);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f p = mesh.positions[i];
    const bool inner = p.x > 0.01F && p.x < 0.99F && p.y > 0.01F && p.y < 0.99F;
    if (p.z != 0 || !inner) continue;
    EXPECT_NEAR(on_floor(corner, field, p.x, p.y).x, mesh.colors[i].x, 2e-4F);
  }
}

TEST(Shading, RefusesWrongShapes) {
  const Corner corner(8);
  const std::vector<Rgb> values(7);
  EXPECT_THROW(corner.field(values), ShapeError);
  EXPECT_THROW(smoothed(corner.cut.tessellation, corner.display, values, 1), ShapeError);
  EXPECT_THROW(fill_unknown(corner.cut.tessellation, corner.display, values), ShapeError);
}

}  // namespace
}  // namespace relumbre
