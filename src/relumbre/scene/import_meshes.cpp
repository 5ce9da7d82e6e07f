#include "relumbre/scene/import_meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <assimp/mesh.h>
#include <assimp/scene.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/image/srgb.h"
#include "relumbre/scene/affine.h"
#include "relumbre/scene/import_materials.h"
#include "relumbre/scene/triangulate.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxTriangles = std::uint64_t{1} << 30;
constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 31;
constexpr std::size_t kGrain = std::size_t{1} << 14;

Vec3f to_vec(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::span<const aiFace> faces_of(const aiMesh& mesh) {
  return {mesh.mFaces, mesh.HasFaces() ? mesh.mNumFaces : 0};
}

std::span<const unsigned> corners_of(const aiFace& face) {
  return {face.mIndices, face.mIndices != nullptr ? face.mNumIndices : 0};
}

Affine to_affine(const aiMatrix4x4& m) {
  return {Vec3d(Vec3f(m.a1, m.b1, m.c1)), Vec3d(Vec3f(m.a2, m.b2, m.c2)),
          Vec3d(Vec3f(m.a3, m.b3, m.c3)), Vec3d(Vec3f(m.a4, m.b4, m.c4))};
}

/// A node that shows meshes, and where it stands.
struct Placement {
  const aiNode* node;
  Affine world;
};

/// Every node with meshes, parents before children, in the file's order.
std::vector<Placement> placements(const aiNode& root, const Affine& to_metres) {
  std::vector<Placement> found;
  std::vector<Placement> open{{&root, to_metres}};
  while (!open.empty()) {
    const Placement parent = open.back();
    open.pop_back();
    const Placement here{parent.node, parent.world * to_affine(parent.node->mTransformation)};
    if (here.node->mNumMeshes > 0) found.push_back(here);
    for (unsigned i = here.node->mNumChildren; i-- > 0;) {
      open.push_back({here.node->mChildren[i], here.world});
    }
  }
  return found;
}

class MeshAppender {
 public:
  MeshAppender(std::unique_ptr<aiScene> source, SceneKind kind, const fs::path& file,
               const ImportConfig& config, std::span<const GltfMaterial> gltf_materials,
               ImportResult& result)
      : source_(std::move(source)),
        file_name_(file.string()),
        scene_(result.scene),
        report_(result.report),
        materials_(*source_, kind, file, config, gltf_materials, result.scene, result.report),
        // An STL's normals are its triangles' own, and often wrong.
        use_normals_(kind != SceneKind::kStl),
        linear_colors_(kind == SceneKind::kGltf),
        scale_(static_cast<double>(config.scale)) {}

  void run() {
    const Affine to_metres{{scale_, 0, 0}, {0, scale_, 0}, {0, 0, scale_}, {}};
    const std::vector<Placement> nodes = placements(*source_->mRootNode, to_metres);
    plan(nodes);
    for (const Placement& placement : nodes) append_node(placement);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw FileError(file_name_, reason); }

  /// Counts what comes, takes the materials into use, and reserves.
  void plan(const std::vector<Placement>& nodes) {
    uses_.assign(source_->mNumMeshes, 0);
    std::vector<std::uint64_t> triangles(source_->mNumMeshes, 0);
    for (const Placement& placement : nodes) {
      for (unsigned i = 0; i < placement.node->mNumMeshes; ++i) {
        const unsigned index = placement.node->mMeshes[i];
        if (index >= source_->mNumMeshes) fail("has a node with a mesh that is not there");
        if (uses_[index]++ == 0) triangles[index] = inspect(*source_->mMeshes[index]);
      }
    }
    std::uint64_t total_triangles = 0, total_vertices = 0;
    for (unsigned m = 0; m < source_->mNumMeshes; ++m) {
      if (triangles[m] == 0) continue;
      total_triangles += uses_[m] * triangles[m];
      total_vertices += uses_[m] * vertices_of(*source_->mMeshes[m], triangles[m]);
      if (total_triangles > kMaxTriangles || total_vertices > kMaxVertices) {
        fail("has too many triangles: more than 2^30 of them or 2^31 vertices");
      }
    }
    reserve(total_triangles, total_vertices);
  }

  /// Triangles in a mesh; checks their indices and notes what the mesh brings.
  std::uint64_t inspect(const aiMesh& mesh) {
    std::uint64_t triangles = 0;
    const unsigned vertices = mesh.HasPositions() ? mesh.mNumVertices : 0;
    for (const aiFace& face : faces_of(mesh)) {
      for (const unsigned vertex : corners_of(face)) {
        if (vertex >= vertices) fail("has a face with a vertex that is not there");
      }
      const std::size_t corners = corners_of(face).size();
      report_.points_and_lines += corners < 3 ? 1 : 0;
      triangles += corners < 3 ? 0 : corners - 2;
    }
    if (triangles == 0) return 0;
    const std::uint32_t material = materials_.use(mesh.mMaterialIndex, mesh.HasVertexColors(0));
    const bool textured = scene_.materials[material].texture != kNone;
    any_texcoords_ = any_texcoords_ || (textured && texcoords_of(mesh) != nullptr);
    any_normals_ = any_normals_ || has_normals(mesh);
    any_colors_ = any_colors_ || mesh.HasVertexColors(0);
    return triangles;
  }

  void reserve(std::uint64_t triangles, std::uint64_t vertices) {
    TriangleMesh& mesh = scene_.mesh;
    mesh.positions.reserve(vertices);
    if (any_normals_) scene_.shading_normals.reserve(vertices);
    if (any_texcoords_) scene_.texcoords.reserve(vertices);
    if (any_colors_) scene_.colors.reserve(vertices);
    mesh.triangles.reserve(triangles);
    mesh.material.reserve(triangles);
    mesh.object.reserve(triangles);
    mesh.two_sided.reserve(triangles);
  }

  [[nodiscard]] bool has_normals(const aiMesh& mesh) const {
    return use_normals_ && mesh.HasNormals();
  }
  /// Without normals, beside meshes that have some, every triangle gets vertices of its own.
  [[nodiscard]] bool is_flat(const aiMesh& mesh) const {
    return any_normals_ && !has_normals(mesh);
  }

  [[nodiscard]] std::uint64_t vertices_of(const aiMesh& mesh, std::uint64_t triangles) const {
    return is_flat(mesh) ? 3 * triangles : mesh.mNumVertices;
  }

  [[nodiscard]] const aiVector3D* texcoords_of(const aiMesh& mesh) const {
    const unsigned set = materials_.texcoord_set(mesh.mMaterialIndex);
    return set < AI_MAX_NUMBER_OF_TEXTURECOORDS ? mesh.mTextureCoords[set] : nullptr;
  }

  void append_node(const Placement& placement) {
    const std::size_t before = scene_.mesh.triangles.size();
    for (unsigned i = 0; i < placement.node->mNumMeshes; ++i) {
      const unsigned index = placement.node->mMeshes[i];
      append_mesh(*source_->mMeshes[index], placement.world);
      if (--uses_[index] > 0) continue;
      delete source_->mMeshes[index];
      source_->mMeshes[index] = nullptr;
    }
    if (scene_.mesh.triangles.size() > before) {
      scene_.objects.push_back({placement.node->mName.C_Str()});
    }
  }

  void append_mesh(const aiMesh& source, const Affine& world) {
    const std::size_t first_vertex = scene_.mesh.positions.size();
    const std::size_t first_triangle = scene_.mesh.triangles.size();
    append_triangles(source, first_vertex, world.determinant() < 0);
    if (scene_.mesh.triangles.size() == first_triangle) return;
    if (is_flat(source)) {
      append_flat_vertices(source, world, first_vertex, first_triangle);
    } else {
      append_vertices(source, world, first_vertex);
    }
    if (any_normals_) repair_normals(first_triangle);
  }

  void append_triangles(const aiMesh& source, std::size_t first_vertex, bool mirrored) {
    TriangleMesh& mesh = scene_.mesh;
    const auto base = static_cast<std::uint32_t>(first_vertex);
    const unsigned second = mirrored ? 2 : 1, third = mirrored ? 1 : 2;
    std::vector<Index3> pieces;
    for (const aiFace& face : faces_of(source)) {
      const std::span<const unsigned> corners = corners_of(face);
      cut(source, corners, pieces);
      for (const Index3& piece : pieces) {
        mesh.triangles.push_back({base + corners[piece[0]], base + corners[piece[second]],
                                  base + corners[piece[third]]});
      }
    }
    const std::size_t count = mesh.triangles.size();
    if (count == mesh.material.size()) return;
    const std::uint32_t material = materials_.use(source.mMaterialIndex, source.HasVertexColors(0));
    mesh.material.resize(count, material);
    mesh.object.resize(count, static_cast<std::uint32_t>(scene_.objects.size()));
    mesh.two_sided.resize(count, scene_.materials[material].two_sided ? 1 : 0);
  }

  /// The face as triangles of its corners; none for points and lines.
  static void cut(const aiMesh& source, std::span<const unsigned> corners,
                  std::vector<Index3>& pieces) {
    pieces.clear();
    if (corners.size() == 3) {
      pieces.push_back({0, 1, 2});
      return;
    }
    std::vector<Vec3f> points;
    for (const unsigned corner : corners) points.push_back(to_vec(source.mVertices[corner]));
    triangulate_polygon(points, pieces);
  }

  void append_vertices(const aiMesh& source, const Affine& world, std::size_t first) {
    const std::size_t count = source.mNumVertices;
    scene_.mesh.positions.resize(first + count);
    if (any_normals_) scene_.shading_normals.resize(first + count);
    if (any_texcoords_) scene_.texcoords.resize(first + count);
    if (any_colors_) scene_.colors.resize(first + count, Rgb(1));
    const aiVector3D* const uv = any_texcoords_ ? texcoords_of(source) : nullptr;
    const TexcoordMap map = materials_.texcoord_map(source.mMaterialIndex);
    parallel_for(0, count, kGrain, [&](std::size_t i) {
      scene_.mesh.positions[first + i] = Vec3f(world.point(Vec3d(to_vec(source.mVertices[i]))));
      if (any_normals_) {
        const Vec3d n = world.normal(Vec3d(to_vec(source.mNormals[i])));
        scene_.shading_normals[first + i] = Vec3f(normalized(n));
      }
      if (uv != nullptr) scene_.texcoords[first + i] = to_texcoord(uv[i], map);
      if (any_colors_) scene_.colors[first + i] = color_of(source, i);
    });
  }

  /// Assimp has v upwards in every format, glTF and Texture downwards.
  static Vec2f to_texcoord(const aiVector3D& uv, const TexcoordMap& map) {
    const Vec2f at = map({uv.x, 1 - uv.y});
    return std::isfinite(at.x) && std::isfinite(at.y) ? at : Vec2f{};
  }

  /// glTF's are linear, the others' 8-bit sRGB. White for meshes without.
  [[nodiscard]] Rgb color_of(const aiMesh& mesh, std::size_t vertex) const {
    if (!mesh.HasVertexColors(0)) return Rgb(1);
    const aiColor4D& c = mesh.mColors[0][vertex];
    const auto factor = [this](float v) {
      const float in_range = v > 0 ? std::min(v, 1.0F) : 0.0F;
      return linear_colors_ ? in_range : srgb_decode(in_range);
    };
    return {factor(c.r), factor(c.g), factor(c.b)};
  }

  void append_flat_vertices(const aiMesh& source, const Affine& world, std::size_t first_vertex,
                            std::size_t first_triangle) {
    const auto base = static_cast<std::uint32_t>(first_vertex);
    const aiVector3D* const uv = any_texcoords_ ? texcoords_of(source) : nullptr;
    const TexcoordMap map = materials_.texcoord_map(source.mMaterialIndex);
    for (std::size_t t = first_triangle; t < scene_.mesh.triangles.size(); ++t) {
      for (std::uint32_t& corner : scene_.mesh.triangles[t]) {
        const std::uint32_t vertex = corner - base;
        corner = static_cast<std::uint32_t>(scene_.mesh.positions.size());
        const Vec3d position(to_vec(source.mVertices[vertex]));
        scene_.mesh.positions.push_back(Vec3f(world.point(position)));
        scene_.shading_normals.emplace_back();
        if (any_texcoords_) {
          scene_.texcoords.push_back(uv != nullptr ? to_texcoord(uv[vertex], map) : Vec2f{});
        }
        if (any_colors_) scene_.colors.push_back(color_of(source, vertex));
      }
    }
  }

  /// A normal that is missing, zero or not a number becomes that of a triangle that uses it.
  void repair_normals(std::size_t first_triangle) {
    for (std::size_t t = first_triangle; t < scene_.mesh.triangles.size(); ++t) {
      for (const std::uint32_t vertex : scene_.mesh.triangles[t]) {
        Vec3f& normal = scene_.shading_normals[vertex];
        if (std::abs(length(normal) - 1) < 1e-3F) continue;
        normal = Vec3f(normalized(geometric_normal(t)));
        if (!(length(normal) > 0.5F)) normal = {0, 1, 0};
      }
    }
  }

  [[nodiscard]] Vec3d geometric_normal(std::size_t triangle) const {
    const Vec3d a(scene_.mesh.corner(triangle, 0));
    return cross(Vec3d(scene_.mesh.corner(triangle, 1)) - a,
                 Vec3d(scene_.mesh.corner(triangle, 2)) - a);
  }

  std::unique_ptr<aiScene> source_;
  std::string file_name_;
  Scene& scene_;
  ImportReport& report_;
  MaterialImporter materials_;
  bool use_normals_, linear_colors_;
  double scale_;
  std::vector<std::uint64_t> uses_;  ///< by source mesh: nodes that still need it
  bool any_normals_ = false, any_texcoords_ = false, any_colors_ = false;
};

}  // namespace

void import_meshes(std::unique_ptr<aiScene> source, SceneKind kind, const fs::path& file,
                   const ImportConfig& config, std::span<const GltfMaterial> gltf_materials,
                   ImportResult& result) {
  MeshAppender(std::move(source), kind, file, config, gltf_materials, result).run();
}

}  // namespace relumbre
