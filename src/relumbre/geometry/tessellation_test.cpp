#include "relumbre/geometry/tessellation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/facet.h"
#include "relumbre/geometry/label_locator.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

Tessellation cluster(const TriangleMesh& mesh, std::size_t k, std::size_t n,
                     std::span<const std::uint32_t> separate = {}) {
  return tessellate(mesh, {k, n, PatchMethod::kCluster, separate});
}

Tessellation hierarchy(const TriangleMesh& mesh, std::size_t k, std::size_t n) {
  return tessellate(mesh, {k, n, PatchMethod::kHierarchy, {}});
}

double reflecting_area(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double sides = !mesh.two_sided.empty() && mesh.two_sided[t] != 0 ? 2 : 1;
    sum += sides * double{length(mesh.scaled_normal(t))} / 2;
  }
  return sum;
}

Vec3f facet_vector(const Tessellation& t, const Facet& f) {
  const Vec3f a = t.positions[f.corners[0]];
  return cross(t.positions[f.corners[1]] - a, t.positions[f.corners[2]] - a) * 0.5F;
}

Vec3f facet_center(const Tessellation& t, const Facet& f) {
  return (t.positions[f.corners[0]] + t.positions[f.corners[1]] + t.positions[f.corners[2]]) / 3;
}

/// Everything that must hold for any tessellation.
void expect_sound(const TriangleMesh& mesh, const Tessellation& t, std::size_t k, std::size_t n) {
  ASSERT_EQ(t.elements(), n);
  ASSERT_EQ(t.patches(), k);
  ASSERT_EQ(t.facet_offsets.size(), n + 1);
  EXPECT_EQ(t.facet_offsets.front(), 0U);
  EXPECT_EQ(t.facet_offsets.back(), t.facets.size());
  EXPECT_EQ(t.patch_offsets.front(), 0U);
  EXPECT_EQ(t.patch_offsets.back(), n);
  // Strictly ascending: no element and no patch is empty.
  EXPECT_EQ(std::ranges::adjacent_find(t.facet_offsets, std::greater_equal{}),
            t.facet_offsets.end());
  EXPECT_EQ(std::ranges::adjacent_find(t.patch_offsets, std::greater_equal{}),
            t.patch_offsets.end());

  double sum = 0;
  for (const float area : t.area) sum += double{area};
  const double expected = reflecting_area(mesh);
  EXPECT_NEAR(sum, expected, 1e-5 * expected);
  for (std::size_t e = 0; e < n; ++e) {
    double area = 0;
    for (const Facet& f : t.facets_of(e)) area += double{length(facet_vector(t, f))};
    EXPECT_NEAR(double{t.area[e]}, area, 2e-3 * area);
    EXPECT_NEAR(length(t.normal[e]), 1, 1e-5F);
  }
}

TEST(Tessellation, HierarchyReachesTheNineCasesOfThePaper) {
  const TriangleMesh mesh = shapes::blocks_in_room();
  ASSERT_EQ(mesh.triangles.size(), 36U);
  for (const std::size_t n : {3456U, 13824U, 55296U, 221184U}) {
    for (const std::size_t k : {216U, 864U, 3456U}) {
      expect_sound(mesh, hierarchy(mesh, k, n), k, n);
    }
  }
}

TEST(Tessellation, HierarchyPatchesHoldEqualElements) {
  const TriangleMesh mesh = shapes::blocks_in_room();
  const Tessellation t = hierarchy(mesh, 216, 13824);
  for (std::size_t p = 0; p < 216; ++p) {
    ASSERT_EQ(t.patch_offsets[p + 1] - t.patch_offsets[p], 64U);
    const std::uint32_t first = t.patch_offsets[p];
    for (std::uint32_t e = first; e < t.patch_offsets[p + 1]; ++e) {
      EXPECT_EQ(t.area[e], t.area[first]);
      ASSERT_EQ(t.facets_of(e).size(), 1U);
      EXPECT_EQ(t.facets_of(e)[0].triangle, t.facets_of(first)[0].triangle);
    }
  }
}

TEST(Tessellation, HierarchyCutsTheLargestFirst) {
  const TriangleMesh mesh = shapes::blocks_in_room();
  const Tessellation t = hierarchy(mesh, 216, 216);
  // Whatever was cut was at least as large as every patch that is left.
  std::map<std::uint32_t, std::vector<float>> areas;
  for (std::size_t e = 0; e < t.elements(); ++e)
    areas[t.facets_of(e)[0].triangle].push_back(t.area[e]);
  float smallest_cut = 1e9F;
  for (const auto& [triangle, list] : areas) {
    if (list.size() > 1) smallest_cut = std::min(smallest_cut, 4 * *std::ranges::min_element(list));
  }
  EXPECT_LE(*std::ranges::max_element(t.area), smallest_cut * 1.0001F);
}

TEST(Tessellation, HierarchyErrorNamesTheNearestFigures) {
  const TriangleMesh mesh = shapes::blocks_in_room();
  const auto message = [&](std::size_t k, std::size_t n) -> std::string {
    try {
      hierarchy(mesh, k, n);
    } catch (const ValueError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_NE(message(217, 868).find("nearest is 216"), std::string::npos) << message(217, 868);
  EXPECT_NE(message(20, 80).find("nearest is 36"), std::string::npos) << message(20, 80);
  EXPECT_NE(message(216, 3000).find("nearest is 3456"), std::string::npos) << message(216, 3000);
}

TEST(Tessellation, ClustersReachAnyNumbers) {
  const TriangleMesh room = shapes::blocks_in_room(), ball = shapes::sphere(11),
                     soup = shapes::soup(499, 3);
  for (const TriangleMesh* mesh : {&room, &ball, &soup}) {
    for (const auto& [k, n] : std::vector<std::pair<std::size_t, std::size_t>>{
             {1, 1}, {1, 2}, {2, 3}, {7, 7}, {13, 101}, {53, 1009}, {211, 2003}, {997, 997}}) {
      expect_sound(*mesh, cluster(*mesh, k, n), k, n);
    }
  }
}

TEST(Tessellation, OneTriangleCanBeCutIntoAnything) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (const std::size_t n : {1U, 2U, 3U, 4U, 5U, 17U, 331U}) {
    expect_sound(mesh, cluster(mesh, 1, n), 1, n);
    expect_sound(mesh, cluster(mesh, n, n), n, n);
  }
}

TEST(Tessellation, EqualTrianglesCanStillBeSplit) {
  TriangleMesh mesh;
  for (int i = 0; i < 31; ++i) shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  expect_sound(mesh, cluster(mesh, 5, 29), 5, 29);
}

TEST(Tessellation, IsDeterministic) {
  const TriangleMesh mesh = shapes::soup(701, 5);
  const Tessellation a = cluster(mesh, 101, 1511), b = cluster(mesh, 101, 1511);
  EXPECT_EQ(a.facet_offsets, b.facet_offsets);
  EXPECT_EQ(a.patch_offsets, b.patch_offsets);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.locator.nodes, b.locator.nodes);
}

TEST(Tessellation, EqualPointsShareAnIndex) {
  const TriangleMesh room = shapes::blocks_in_room();
  const Tessellation t = cluster(room, 100, 5003);
  std::set<std::array<float, 3>> distinct;
  for (const Vec3f& p : t.positions) distinct.insert({p.x, p.y, p.z});
  EXPECT_EQ(distinct.size(), t.positions.size());
}

TEST(Tessellation, LabelsAreNeverMixedInAPatch) {
  const TriangleMesh mesh = shapes::soup(307, 9);
  std::vector<std::uint32_t> label(mesh.triangles.size(), 0);
  for (std::size_t i = 0; i < label.size(); i += 10) label[i] = static_cast<std::uint32_t>(i % 7);
  const std::size_t labels = std::set<std::uint32_t>(label.begin(), label.end()).size();
  for (const std::size_t k : {labels, labels + 1, std::size_t{61}}) {
    const Tessellation t = cluster(mesh, k, 401, label);
    expect_sound(mesh, t, k, 401);
    for (std::size_t p = 0; p < k; ++p) {
      std::set<std::uint32_t> seen;
      for (std::uint32_t e = t.patch_offsets[p]; e < t.patch_offsets[p + 1]; ++e) {
        for (const Facet& f : t.facets_of(e)) seen.insert(label[f.triangle]);
      }
      EXPECT_EQ(seen.size(), 1U);
    }
  }
  EXPECT_THROW(cluster(mesh, labels - 1, 401, label), ValueError);
}

/// The smallest cosine between an element's mean normal and its facets' normals.
float worst_cosine(const Tessellation& t) {
  float worst = 1;
  for (std::size_t e = 0; e < t.elements(); ++e) {
    for (const Facet& f : t.facets_of(e)) {
      worst = std::min(worst, dot(normalized(facet_vector(t, f)), t.normal[e]));
    }
  }
  return worst;
}

TEST(Tessellation, SidesOfAThinPlateNeverShareAnElement) {
  for (const float length : {1.0F, 40.0F}) {
    TriangleMesh plate;
    const float step = length / 40;  // a strip, too: position varies far more than size
    for (int i = 0; i < 40; ++i) {
      shapes::add_quad(plate, {step * static_cast<float>(i), 0, 0}, {step, 0, 0}, {0, 1, 0}, true);
    }
    for (const std::size_t n : {2U, 3U, 50U, 200U}) {
      EXPECT_GT(worst_cosine(cluster(plate, 1, n)), 0.99F) << length << ' ' << n;
      EXPECT_GT(worst_cosine(cluster(plate, 2, n)), 0.99F) << length << ' ' << n;
    }
  }
}

TEST(Tessellation, FacesOfABoxSeparateBeforeTheyAreCut) {
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {1, 1, 1}, false);
  EXPECT_GT(worst_cosine(cluster(mesh, 6, 6)), 0.999F);
}

TEST(Tessellation, SmallBoxesAreDividedIntoFacesBeforeWallsAreCutFinely) {
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {5, 5, 5}, true);
  shapes::add_box(mesh, {2, 0, 2}, {2.2F, 0.2F, 2.2F}, false);
  EXPECT_GT(worst_cosine(cluster(mesh, 100, 1500)), 0.999F);
}

TEST(Tessellation, ElementsOfAWallAreCompact) {
  TriangleMesh wall;
  shapes::add_quad(wall, {0, 0, 0}, {4, 0, 0}, {0, 3, 0});
  const std::size_t n = 1000;
  const Tessellation t = cluster(wall, 100, n);
  for (std::size_t e = 0; e < n; ++e) {
    EXPECT_LT(t.area[e], 3 * 12.0F / n);
    for (const Facet& f : t.facets_of(e)) {
      EXPECT_LT(length(facet_center(t, f) - t.centroid[e]), 2 * std::sqrt(12.0F / n));
    }
  }
}

TEST(Tessellation, RoundingDoesNotTearAWallApart) {
  // The worst case: a wall at 45 degrees to two axes, of many triangles.
  TriangleMesh wall;
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 30; ++j) {
      const float x = 0.1F * static_cast<float>(i), y = 0.1F * static_cast<float>(j);
      shapes::add_quad(wall, {x, y, -x}, {0.1F, 0, -0.1F}, {0, 0.1F, 0});
    }
  }
  const Tessellation t = cluster(wall, 4, 4);
  for (std::size_t e = 0; e < 4; ++e) {
    for (const Facet& f : t.facets_of(e)) {
      EXPECT_LT(length(facet_center(t, f) - t.centroid[e]), 2.2F);
    }
  }
}

TEST(Tessellation, BadInputIsNamed) {
  const TriangleMesh room = shapes::blocks_in_room();
  EXPECT_THROW(cluster(room, 10, 9), ValueError);
  EXPECT_THROW(cluster(room, 0, 9), ValueError);
  EXPECT_THROW(cluster(room, 1, (std::size_t{1} << 27) + 1), ValueError);
  EXPECT_THROW(cluster({}, 1, 1), ValueError);
  const std::vector<std::uint32_t> labels(3);
  EXPECT_THROW(cluster(room, 10, 20, labels), ShapeError);

  TriangleMesh flat;
  shapes::add_triangle(flat, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  EXPECT_THROW(cluster(flat, 1, 1), ValueError);
  TriangleMesh nan = room;
  nan.positions[5].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(cluster(nan, 1, 1), ValueError);
  TriangleMesh wild = room;
  wild.triangles[7][2] = 4711;
  EXPECT_THROW(cluster(wild, 1, 1), ValueError);
  TriangleMesh sides = room;
  sides.two_sided.pop_back();
  EXPECT_THROW(cluster(sides, 1, 1), ShapeError);
}

TEST(Tessellation, CuttingStopsWhereFloatDoes) {
  TriangleMesh tiny;  // 16 units in the last place wide
  const float ulp = 0x1p-20F;
  shapes::add_triangle(tiny, {10, 10, 0}, {10 + 16 * ulp, 10, 0}, {10, 10 + 16 * ulp, 0});
  EXPECT_EQ(cluster(tiny, 1, 64).elements(), 64U);
  EXPECT_THROW(cluster(tiny, 1, 4000), ValueError);
  EXPECT_THROW(hierarchy(tiny, 4, 4096), ValueError);
}

/// Barycentrics of p in the triangle of `corners`.
Vec2f barycentrics(const std::array<Vec2f, 3>& c, Vec2f p) {
  const double ux = double{c[1].x} - double{c[0].x}, uy = double{c[1].y} - double{c[0].y};
  const double vx = double{c[2].x} - double{c[0].x}, vy = double{c[2].y} - double{c[0].y};
  const double px = double{p.x} - double{c[0].x}, py = double{p.y} - double{c[0].y};
  const double det = ux * vy - uy * vx;
  return {static_cast<float>((px * vy - py * vx) / det),
          static_cast<float>((ux * py - uy * px) / det)};
}

bool contains(const std::array<Vec2f, 3>& corners, Vec2f p) {
  const Vec2f b = barycentrics(corners, p);
  return b.x >= -1e-4F && b.y >= -1e-4F && b.x + b.y <= 1 + 1e-4F;
}

struct Probe {
  std::uint32_t triangle;
  bool back;
  Vec2f at;
};

std::vector<Probe> random_probes(const TriangleMesh& mesh, std::size_t count) {
  RandomStream random(17);
  std::vector<Probe> probes;
  for (std::size_t i = 0; i < count; ++i) {
    const auto triangle = static_cast<std::uint32_t>(random.bits() % mesh.triangles.size());
    const bool back = mesh.two_sided[triangle] != 0 && random.uniform() < 0.5F;
    Vec2f at = square_to_triangle(random.uniform(), random.uniform());
    // Some exactly on cuts and corners.
    if (i % 5 == 0) at = {std::round(at.x * 8) / 8, std::round(at.y * 8) / 8};
    if (at.x + at.y <= 1) probes.push_back({triangle, back, at});
  }
  return probes;
}

TEST(Locator, AgreesWithContainment) {
  const TriangleMesh mesh = shapes::soup(31, 2);
  const Tessellation t = cluster(mesh, 60, 3001);
  for (const auto& [triangle, back, at] : random_probes(mesh, 20000)) {
    const std::uint32_t facet = t.locate(triangle, back, at.x, at.y);
    ASSERT_LT(facet, t.facets.size());
    EXPECT_EQ(t.facets[facet].triangle, triangle);
    EXPECT_EQ(t.facets[facet].back, back ? 1U : 0U);
    EXPECT_TRUE(contains(facet_barycentrics(mesh, t.facets[facet], t), at));
  }
}

TEST(Locator, FindsEveryFacetByItsCentroid) {
  const TriangleMesh mesh = shapes::soup(31, 4);
  const Tessellation t = cluster(mesh, 60, 3001);
  for (std::size_t f = 0; f < t.facets.size(); ++f) {
    const auto c = facet_barycentrics(mesh, t.facets[f], t);
    const Vec2f center = (c[0] + c[1] + c[2]) * (1.0F / 3);
    EXPECT_EQ(t.locate(t.facets[f].triangle, t.facets[f].back != 0, center.x, center.y), f);
  }
}

TEST(Locator, KnowsWhichSidesReflect) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, false);
  shapes::add_triangle(mesh, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, true);
  const Tessellation t = cluster(mesh, 3, 30);
  const LabelLocator pruned = prune(t.locator, t.element_of_facet());
  EXPECT_NE(t.locate(0, false, 0.2F, 0.2F), kNone);
  EXPECT_EQ(t.locate(0, true, 0.2F, 0.2F), kNone);
  EXPECT_EQ(pruned.find(0, true, 0.2F, 0.2F), kNone);
  EXPECT_EQ(locate_point(t.locator, 0, true, 0.2F, 0.2F).facet, kNone);
  EXPECT_NE(t.locate(1, true, 0.2F, 0.2F), kNone);
}

TEST(Locator, AlwaysAnswers) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);
  const Tessellation t = cluster(mesh, 3, 300);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float u : {-1.0F, -1e-7F, 0.0F, 0.5F, 1.0F, 1.0000001F, 7.0F, 1e30F, nan}) {
    for (const float v : {-1.0F, -1e-7F, 0.0F, 0.5F, 1.0F, 1.0000001F, 7.0F, 1e30F, nan}) {
      EXPECT_LT(t.locate(0, false, u, v), t.facets.size());
      EXPECT_LT(t.locate(0, true, u, v), t.facets.size());
    }
  }
}

TEST(Locator, PointInFacetIsThePointInTheTriangle) {
  const TriangleMesh mesh = shapes::soup(31, 8);
  const Tessellation t = cluster(mesh, 60, 3001);
  for (const auto& [triangle, back, at] : random_probes(mesh, 5000)) {
    const auto [facet, u, v] = locate_point(t.locator, triangle, back, at.x, at.y);
    EXPECT_EQ(facet, t.locate(triangle, back, at.x, at.y));
    const auto c = facet_barycentrics(mesh, t.facets[facet], t);
    const Vec2f again = c[0] * (1 - u - v) + c[1] * u + c[2] * v;
    EXPECT_NEAR(again.x, at.x, 1e-5F);
    EXPECT_NEAR(again.y, at.y, 1e-5F);
  }
}

TEST(Locator, PrunedAgreesWithTheTable) {
  const TriangleMesh mesh = shapes::soup(101, 6);
  const Tessellation t = cluster(mesh, 37, 2003);
  const std::vector<std::uint32_t> element = t.element_of_facet(), patch = t.patch_of_element();
  std::vector<std::uint32_t> patch_of_facet;
  for (const std::uint32_t e : element) patch_of_facet.push_back(patch[e]);
  const LabelLocator to_element = prune(t.locator, element);
  const LabelLocator to_patch = prune(t.locator, patch_of_facet);
  EXPECT_LT(to_patch.nodes.size(), to_element.nodes.size());
  EXPECT_LE(to_element.nodes.size(), t.locator.nodes.size());
  for (const auto& [triangle, back, at] : random_probes(mesh, 20000)) {
    const std::uint32_t facet = t.locate(triangle, back, at.x, at.y);
    EXPECT_EQ(to_element.find(triangle, back, at.x, at.y), element[facet]);
    EXPECT_EQ(to_patch.find(triangle, back, at.x, at.y), patch_of_facet[facet]);
  }
}

TEST(Locator, OneLabelPrunesToRoots) {
  const TriangleMesh mesh = shapes::blocks_in_room();
  const Tessellation t = cluster(mesh, 100, 1000);
  const std::vector<std::uint32_t> same(t.facets.size(), 5);
  const LabelLocator pruned = prune(t.locator, same);
  EXPECT_TRUE(pruned.nodes.empty());
  EXPECT_EQ(pruned.find(3, false, 0.3F, 0.3F), 5U);
  EXPECT_THROW(prune(t.locator, std::span(same).first(10)), ShapeError);
}

TEST(Facet, BarycentricsGiveItsCorners) {
  const TriangleMesh mesh = shapes::soup(53, 12);
  const Tessellation t = cluster(mesh, 60, 2003);
  for (const Facet& facet : t.facets) {
    const auto c = facet_barycentrics(mesh, facet, t);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3f p = mesh.corner(facet.triangle, 0) * (1 - c[i].x - c[i].y) +
                      mesh.corner(facet.triangle, 1) * c[i].x +
                      mesh.corner(facet.triangle, 2) * c[i].y;
      EXPECT_LT(length(p - t.positions[facet.corners[i]]), 1e-6F);
    }
  }
}

TEST(Facet, FacesWhereItsSideReflects) {
  TriangleMesh mesh;
  shapes::add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);
  const Tessellation t = cluster(mesh, 2, 101);
  for (const Facet& facet : t.facets) {
    EXPECT_GT(facet_vector(t, facet).z * (facet.back != 0 ? -1.0F : 1.0F), 0);
  }
}

}  // namespace
}  // namespace relumbre
