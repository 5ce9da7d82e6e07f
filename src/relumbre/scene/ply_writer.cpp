#include "relumbre/scene/ply_writer.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/srgb.h"

namespace relumbre {

namespace {

static_assert(std::endian::native == std::endian::little, "written as memory holds it");

void check(const PlyMesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  const auto check_size = [&](std::span<const Rgb> values, const char* what) {
    if (!values.empty() && values.size() != vertices)
      throw ShapeError("PLY: " + std::to_string(values.size()) + " " + what + " for " +
                       std::to_string(vertices) + " vertices");
  };
  check_size(mesh.colors, "colours");
  check_size(mesh.radiosity, "radiosities");
  if (vertices > std::size_t{std::numeric_limits<std::int32_t>::max()})
    throw ShapeError("PLY: " + std::to_string(vertices) + " vertices are more than an int counts");
  for (const Index3& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v >= vertices)
        throw ShapeError("PLY: vertex " + std::to_string(v) + " of " + std::to_string(vertices));
}

std::string header(const PlyMesh& mesh) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment Relumbre\nelement vertex " +
                     std::to_string(mesh.positions.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!mesh.colors.empty())
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!mesh.radiosity.empty())
    text +=
        "comment radiosity in W/m2\nproperty float radiosity_r\nproperty float radiosity_g\n"
        "property float radiosity_b\n";
  return text + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

template <class T>
void append(std::string& bytes, const T& value) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

}  // namespace

void write_ply(const std::filesystem::path& path, const PlyMesh& mesh) {
  check(mesh);
  std::string bytes = header(mesh);
  bytes.reserve(bytes.size() + mesh.positions.size() * 27 + mesh.triangles.size() * 13);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    append(bytes, mesh.positions[i]);
    if (!mesh.colors.empty())
      for (std::size_t c = 0; c < 3; ++c) append(bytes, to_byte(srgb_encode(mesh.colors[i][c])));
    if (!mesh.radiosity.empty()) append(bytes, mesh.radiosity[i]);
  }
  for (const Index3& triangle : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    append(bytes, triangle);
  }
  write_file(path, bytes);
}

}  // namespace relumbre
