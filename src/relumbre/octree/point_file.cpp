#include "relumbre/octree/point_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "relumbre/base/atomic_stream.h"
#include "relumbre/base/error.h"
#include "relumbre/octree/display_color.h"
#include "relumbre/octree/morton.h"

namespace relumbre {

namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they are");

template <class T>
void append(std::string& bytes, const T& value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

std::string header(const VoxelTree& tree) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment centres of voxels\n";
  text += "element vertex " + std::to_string(tree.voxels()) + "\n";
  for (const char* name : {"x", "y", "z"}) text += std::string("property float ") + name + "\n";
  if (tree.has_values()) {
    for (const char* name : {"red", "green", "blue"})
      text += std::string("property uchar ") + name + "\n";
    for (const char* name : {"nx", "ny", "nz"})
      text += std::string("property float ") + name + "\n";
  }
  return text + "end_header\n";
}

void append_point(std::string& bytes, const VoxelTree& tree, std::uint64_t code,
                  std::uint64_t index, float exposure) {
  const Cell cell = morton_decode(code);
  const double width = std::ldexp(tree.cube().edge, -static_cast<int>(tree.depth()));
  const Vec3d center = Vec3d(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5) * width;
  append(bytes, Vec3f(tree.cube().corner + center));
  if (!tree.has_values()) return;
  append(bytes, display_color(tree.values()[index], exposure));
  append(bytes, unpack_normal(tree.values()[index].normal));
}

}  // namespace

void write_points(const std::filesystem::path& file, const VoxelTree& tree, float exposure) {
  constexpr std::size_t kBuffer = std::size_t{1} << 20;
  AtomicStream out(file);
  std::string bytes = header(tree);
  const auto flush = [&] {
    out.write(bytes);
    bytes.clear();
  };
  for_each_voxel(tree, [&](std::uint64_t code, std::uint64_t index) {
    append_point(bytes, tree, code, index, exposure);
    if (bytes.size() > kBuffer) flush();
  });
  flush();
  out.commit();
}

}  // namespace relumbre
