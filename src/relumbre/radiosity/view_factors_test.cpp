#include "relumbre/radiosity/view_factors.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

/// Gives all triangles that have none yet to the object.
void name_rest(TriangleMesh& mesh, std::size_t first_triangle, std::uint32_t object) {
  for (std::size_t t = first_triangle; t < mesh.object.size(); ++t) mesh.object[t] = object;
}

void add_square(TriangleMesh& mesh, std::uint32_t object, const Vec3f& corner, const Vec3f& e1,
                const Vec3f& e2, bool two_sided = false) {
  const std::size_t first = mesh.triangles.size();
  shapes::add_quad(mesh, corner, e1, e2, two_sided);
  name_rest(mesh, first, object);
}

void expect_closed_form(const ViewFactorResult& result, std::size_t from, std::size_t to,
                        double exact) {
  const double error = std::abs(result.from_to(from, to) - exact);
  EXPECT_LE(error, 1e-3);
  EXPECT_LE(error, 4 * result.error_from_to(from, to))
      << result.from_to(from, to) << " ± " << result.error_from_to(from, to);
}

ViewFactorResult million_rays(const TriangleMesh& mesh, std::size_t objects) {
  return view_factors(mesh, objects, RayScene(mesh), ViewFactorConfig{});
}

TEST(ViewFactors, ParallelSquares) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(mesh, 1, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  const ViewFactorResult result = million_rays(mesh, 2);
  expect_closed_form(result, 0, 1, 0.199824895698);
  expect_closed_form(result, 1, 0, 0.199824895698);
  EXPECT_EQ(result.from_to(0, 0), 0);
  EXPECT_NEAR(result.area[0], 1, 1e-6);
  EXPECT_NEAR(result.escaped[0] + result.from_to(0, 1), 1, 1e-12);
  EXPECT_EQ(result.back_face[0], 0);
}

TEST(ViewFactors, PerpendicularSquares) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(mesh, 1, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
  expect_closed_form(million_rays(mesh, 2), 0, 1, 0.200043776075);
}

TEST(ViewFactors, PerpendicularRectangleTwiceAsHigh) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(mesh, 1, {0, 0, 0}, {0, 1, 0}, {0, 0, 2});
  expect_closed_form(million_rays(mesh, 2), 0, 1, 0.232852602795);
}

TEST(ViewFactors, HalfHiddenSquares) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(mesh, 1, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  add_square(mesh, 2, {0, 0, 0.5F}, {0.5F, 0, 0}, {0, 0.5F, 0}, true);
  expect_closed_form(million_rays(mesh, 3), 0, 1, 0.149868671774);
}

/// A regular polygon of the area of the unit disc.
void add_disc(TriangleMesh& mesh, std::uint32_t object, float z, bool up) {
  const std::uint32_t corners = 1024;
  const double angle = 2 * std::numbers::pi / corners;
  const double radius = std::sqrt(angle / std::sin(angle));
  const auto at = [&](std::uint32_t i) {
    return Vec3f{static_cast<float>(radius * std::cos(angle * i)),
                 static_cast<float>(radius * std::sin(angle * i)), z};
  };
  const std::size_t first = mesh.triangles.size();
  for (std::uint32_t i = 0; i < corners; ++i) {
    const Vec3f a = at(i), b = at((i + 1) % corners);
    up ? shapes::add_triangle(mesh, {0, 0, z}, a, b) : shapes::add_triangle(mesh, {0, 0, z}, b, a);
  }
  name_rest(mesh, first, object);
}

TEST(ViewFactors, CoaxialDiscs) {
  TriangleMesh mesh;
  add_disc(mesh, 0, 0, true);
  add_disc(mesh, 1, 1, false);
  expect_closed_form(million_rays(mesh, 2), 0, 1, 0.381966011250);
}

TEST(ViewFactors, InsideASphereOnlyTheAreaCounts) {
  TriangleMesh mesh = shapes::sphere(64);
  for (Index3& t : mesh.triangles) std::swap(t[1], t[2]);  // face in
  double area = 0, cap_area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    mesh.object[t] = mesh.corner(t, 0).y > 0.5F ? 1 : 0;
    const double a = 0.5 * static_cast<double>(length(mesh.scaled_normal(t)));
    area += a, cap_area += mesh.object[t] == 1 ? a : 0;
  }
  const ViewFactorResult result = million_rays(mesh, 2);
  EXPECT_NEAR(result.area[1], cap_area, 1e-4);
  EXPECT_NEAR(result.from_to(0, 1), cap_area / area, 1e-3);
  EXPECT_NEAR(result.from_to(1, 1), cap_area / area, 1e-3);
  EXPECT_EQ(result.escaped[0] + result.escaped[1], 0);
}

TEST(ViewFactors, BothSidesOfATwoSidedSquareEmit) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);
  add_square(mesh, 1, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  const ViewFactorResult result = view_factors(mesh, 2, RayScene(mesh), {100'000, 1, 16});
  EXPECT_NEAR(result.area[0], 2, 1e-6);
  EXPECT_NEAR(result.from_to(0, 1), 0.199824895698 / 2, 1e-3);
  EXPECT_NEAR(result.from_to(1, 0), 0.199824895698, 1e-3);
}

TEST(ViewFactors, BacksAbsorbAndEmptyObjectsDoNothing) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(mesh, 2, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  const ViewFactorResult result = view_factors(mesh, 3, RayScene(mesh), {50'000, 1, 8});
  EXPECT_EQ(result.rays, 50'000U);
  EXPECT_NEAR(result.back_face[0], 0.1998, 2e-3);
  EXPECT_EQ(result.from_to(0, 2), 0);
  EXPECT_EQ(result.escaped[2], 1);
  EXPECT_EQ(result.area[1], 0);
  EXPECT_EQ(result.escaped[1] + result.back_face[1] + result.from_to(1, 0), 0);
}

TEST(ViewFactors, StandardErrorsAreHonest) {
  TriangleMesh mesh;
  add_square(mesh, 0, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_square(mesh, 1, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
  const RayScene rays(mesh);
  double squares = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const ViewFactorResult result = view_factors(mesh, 2, rays, {8192, seed, 32});
    const double deviation = (result.from_to(0, 1) - 0.199824895698) / result.error_from_to(0, 1);
    squares += deviation * deviation / 100;
  }
  EXPECT_GT(squares, 0.6);
  EXPECT_LT(squares, 1.6);
}

TEST(ViewFactors, SameOnAnyNumberOfThreads) {
  const TriangleMesh mesh = shapes::blocks_in_room();
  const RayScene rays(mesh);
  const ViewFactorResult expected = view_factors(mesh, 1, rays, {10'000, 5, 7});
  for (const std::size_t threads : {1U, 3U}) {
    const ThreadLimit limit(threads);
    const ViewFactorResult result = view_factors(mesh, 1, rays, {10'000, 5, 7});
    EXPECT_EQ(result.factor, expected.factor);
    EXPECT_EQ(result.standard_error, expected.standard_error);
  }
}

TEST(ViewFactors, RefusesBadInput) {
  TriangleMesh mesh;
  add_square(mesh, 1, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const RayScene rays(mesh);
  EXPECT_THROW(view_factors(mesh, 1, rays, {}), ValueError);
  EXPECT_THROW(view_factors(mesh, 2, rays, {0, 1, 32}), ValueError);
  EXPECT_THROW(view_factors(mesh, 2, rays, {1000, 1, 1}), ValueError);
  EXPECT_THROW(view_factors(mesh, 2, rays, {std::uint64_t{1} << 40, 1, 32}), ValueError);
  mesh.two_sided.pop_back();
  EXPECT_THROW(view_factors(mesh, 2, rays, {}), ShapeError);
}

}  // namespace
}  // namespace relumbre
