#include "relumbre/geometry/display.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/facet.h"
#include "relumbre/geometry/smoothing.h"
#include "relumbre/geometry/test_shapes.h"

namespace relumbre {
namespace {

std::vector<Rgb> random_values(std::size_t count) {
  RandomStream random(23);
  std::vector<Rgb> values(count);
  for (Rgb& v : values) v = {random.uniform(), random.uniform(), random.uniform()};
  return values;
}

struct Field {
  const Tessellation& t;
  DisplayMesh mesh;
  std::vector<std::uint32_t> element = t.element_of_facet();
  std::vector<Rgb> elements, vertices;

  Field(const Tessellation& t_, DisplayMesh mesh_, std::vector<Rgb> values)
      : t(t_),
        mesh(std::move(mesh_)),
        elements(std::move(values)),
        vertices(vertex_values(mesh, elements)) {}

  [[nodiscard]] Rgb at(std::uint32_t facet, float u, float v) const {
    const DisplaySample s = display_sample(mesh, facet, u, v);
    return vertices[s.vertex0] * s.weight0 + vertices[s.vertex1] * s.weight1 +
           elements[element[facet]] * s.center;
  }
};

/// A square of two triangles that are cut to very different depths.
Tessellation uneven_square(TriangleMesh& mesh) {
  mesh = {};
  shapes::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  shapes::add_quad(mesh, {1, 0, 0}, {0.1F, 0, 0}, {0, 1, 0});
  shapes::add_triangle(mesh, {0, 0, 0}, {1, -7, 0}, {1, 0, 0});
  return tessellate(mesh, {7, 157});
}

TEST(Display, ConstantFieldIsReproduced) {
  const TriangleMesh mesh = shapes::soup(97, 3);
  const Tessellation t = tessellate(mesh, {31, 509});
  const Field field(t, conforming_mesh(t), std::vector<Rgb>(509, Rgb{0.25F, 1, 3}));
  for (const Rgb& v : field.vertices) EXPECT_LT(length(v - Rgb{0.25F, 1, 3}), 1e-5F);
}

TEST(Display, HangingCornersAreOnTheLoop) {
  TriangleMesh mesh;
  const Tessellation t = uneven_square(mesh);
  const DisplayMesh display = conforming_mesh(t);
  EXPECT_GT(display.loop_vertices.size(), 3 * t.facets.size());
  for (std::size_t f = 0; f < t.facets.size(); ++f) {
    std::size_t edge = 3;
    for (std::uint32_t e = display.loop_offsets[f]; e < display.loop_offsets[f + 1]; ++e) {
      const float place = display.loop_places[e];
      edge = place == 0 ? (edge + 1) % 4 : edge;
      const auto& c = t.facets[f].corners;
      const Vec3f a = t.positions[c[edge]], b = t.positions[c[(edge + 1) % 3]];
      const Vec3f p = t.positions[display.vertex_positions[display.loop_vertices[e]]];
      EXPECT_LT(length(a + (b - a) * place - p), 1e-5F);
    }
    EXPECT_EQ(edge, 2U);
  }
}

/// For every edge between two loop vertices: the values along it, from all facets that have it.
void expect_continuous(const Field& field, std::size_t least_shared) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, std::array<Rgb, 5>> seen;
  std::size_t shared = 0;
  const DisplayMesh& m = field.mesh;
  for (std::uint32_t f = 0; f < m.facets(); ++f) {
    const std::uint32_t begin = m.loop_offsets[f], end = m.loop_offsets[f + 1];
    std::size_t corner = 0;
    for (std::uint32_t e = begin; e < end; ++e) {
      const std::uint32_t next = e + 1 == end ? begin : e + 1;
      if (e != begin && m.loop_places[e] == 0) ++corner;
      const float from = m.loop_places[e], to = m.loop_places[next] == 0 ? 1 : m.loop_places[next];
      const bool flip = m.loop_vertices[e] > m.loop_vertices[next];
      std::array<Rgb, 5> values;
      for (std::size_t s = 0; s < 5; ++s) {
        const float x = from + (to - from) * (static_cast<float>(s) + 0.5F) / 5;
        std::array<float, 3> b{};
        b[corner] = 1 - x, b[(corner + 1) % 3] = x;
        values[flip ? 4 - s : s] = field.at(f, b[1], b[2]);
      }
      const Edge key = std::minmax(m.loop_vertices[e], m.loop_vertices[next]);
      const auto [other, added] = seen.emplace(key, values);
      if (added) continue;
      ++shared;
      for (std::size_t s = 0; s < 5; ++s) EXPECT_LT(length(values[s] - other->second[s]), 1e-4F);
    }
  }
  EXPECT_GE(shared, least_shared);
}

TEST(Display, ValuesAgreeAlongSharedEdges) {
  TriangleMesh mesh;
  const Tessellation square = uneven_square(mesh);
  expect_continuous(Field(square, conforming_mesh(square), random_values(157)), 200);
  const TriangleMesh ball = shapes::sphere(7);
  const Tessellation round = tessellate(ball, {20, 701});
  expect_continuous(Field(round, conforming_mesh(round, 60), random_values(701)), 500);
}

TEST(Display, SmoothClosedSurfaceHasNoOpenEdges) {
  // Every directed loop edge of a crease-free sphere has its opposite.
  const TriangleMesh ball = shapes::sphere(8);
  const Tessellation t = tessellate(ball, {13, 997});
  const DisplayMesh m = conforming_mesh(t, 60);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& [a, b, center] : fan_triangles(m)) edges.emplace(a, b);
  for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a}));
}

TEST(Display, ValueAtACentroidIsTheElements) {
  TriangleMesh mesh;
  const Tessellation t = uneven_square(mesh);
  const Field field(t, conforming_mesh(t), random_values(157));
  for (std::uint32_t f = 0; f < t.facets.size(); ++f) {
    EXPECT_LT(length(field.at(f, 1.0F / 3, 1.0F / 3) - field.elements[field.element[f]]), 1e-5F);
  }
}

TEST(Display, SampleWeightsSumToOneEverywhere) {
  TriangleMesh mesh;
  const Tessellation t = uneven_square(mesh);
  const DisplayMesh display = conforming_mesh(t);
  RandomStream random(3);
  for (int i = 0; i < 20000; ++i) {
    const auto facet = static_cast<std::uint32_t>(random.bits() % t.facets.size());
    const Vec2f p = square_to_triangle(random.uniform(), random.uniform());
    const DisplaySample s = display_sample(display, facet, p.x * 1.0001F, p.y);
    EXPECT_NEAR(s.weight0 + s.weight1 + s.center, 1, 1e-5F);
    EXPECT_GE(std::min({s.weight0, s.weight1, s.center}), -1e-5F);
    EXPECT_LT(std::max(s.vertex0, s.vertex1), display.vertices());
  }
}

std::map<std::uint32_t, int> vertices_by_position(const DisplayMesh& mesh) {
  std::map<std::uint32_t, int> count;
  for (const std::uint32_t p : mesh.vertex_positions) ++count[p];
  return count;
}

TEST(Display, CreasesOfACubeAreSharp) {
  TriangleMesh cube;
  shapes::add_box(cube, {0, 0, 0}, {1, 1, 1}, false);
  const Tessellation t = tessellate(cube, {12, 12 * 16, PatchMethod::kHierarchy, {}});
  for (const auto& [position, count] : vertices_by_position(conforming_mesh(t))) {
    const Vec3f p = t.positions[position];
    int faces = 0;
    for (std::size_t i = 0; i < 3; ++i) faces += p[i] == 0 || p[i] == 1 ? 1 : 0;
    EXPECT_EQ(count, faces);
  }
  EXPECT_EQ(conforming_mesh(t, 100).vertices(), t.positions.size());
}

TEST(Display, SidesOfATriangleNeverMeet) {
  TriangleMesh mesh;
  shapes::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);
  // A needle whose normals point all around: fronts and backs are linked by a chain.
  for (int i = 0; i < 24; ++i) {
    const auto rim = [](int j) {
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / 24;
      return Vec3f{5 + 0.01F * std::cos(phi), 0.01F * std::sin(phi), 0};
    };
    shapes::add_triangle(mesh, rim(i), rim((i + 1) % 24), {5, 0, 3}, true);
  }
  const Tessellation t = tessellate(mesh, {60, 401});
  const DisplayMesh display = conforming_mesh(t);
  std::map<std::uint32_t, std::set<std::uint32_t>> sides;
  for (std::size_t f = 0; f < t.facets.size(); ++f) {
    for (std::uint32_t e = display.loop_offsets[f]; e < display.loop_offsets[f + 1]; ++e) {
      sides[display.loop_vertices[e]].insert(t.facets[f].back);
    }
  }
  for (const auto& [vertex, backs] : sides) EXPECT_EQ(backs.size(), 1U);
}

TEST(Display, LabelsAreNotSmoothedAcross) {
  TriangleMesh mesh;
  shapes::add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const Tessellation t = tessellate(mesh, {2, 32, PatchMethod::kHierarchy, {}});
  const std::vector<std::uint32_t> labels{3, 4};
  const DisplayMesh joined = conforming_mesh(t), apart = conforming_mesh(t, 30, labels);
  EXPECT_EQ(joined.vertices(), t.positions.size());
  EXPECT_EQ(apart.vertices(), t.positions.size() + 5);  // the diagonal's points, twice
  EXPECT_THROW(conforming_mesh(t, 30, std::span(labels).first(1)), ShapeError);
  EXPECT_THROW(vertex_values(joined, std::vector<Rgb>(3)), ShapeError);
}

TEST(SmoothGroups, ManyFacetsAroundATip) {
  std::vector<Incidence> cone;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / 5000;
    cone.push_back({normalized(Vec3f{std::cos(phi), std::sin(phi), 0.5F}), i, 0, 0});
  }
  for (std::uint32_t i = 0; i < 100; ++i) cone.push_back({{0, 0, -1}, 5000 + i, 0, 0});
  SmoothGroups groups(30);
  const auto result = groups.divide(cone);
  for (std::size_t i = 0; i < cone.size(); ++i) EXPECT_EQ(result[i], i < 5000 ? 0U : 1U);
}

TEST(SmoothGroups, AngleDecides) {
  const auto tilted = [](float degrees) {
    const float a = degrees * std::numbers::pi_v<float> / 180;
    return Vec3f{std::sin(a), 0, std::cos(a)};
  };
  const std::vector<Incidence> facets{{tilted(0), 0, 0, 0},
                                      {tilted(58), 1, 0, 0},
                                      {tilted(29), 2, 0, 0},
                                      {tilted(90), 3, 0, 0},
                                      {tilted(0), 4, 0, 1}};
  SmoothGroups groups(30);
  const auto result = groups.divide(facets);
  EXPECT_EQ(std::vector(result.begin(), result.end()), (std::vector<std::uint32_t>{0, 0, 0, 1, 2}));
}

}  // namespace
}  // namespace relumbre
