#include "relumbre/octree/vox_file.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/octree/display_color.h"
#include "relumbre/octree/morton.h"
#include "relumbre/octree/palette.h"

namespace relumbre {

namespace {

constexpr unsigned kModelDepth = 8;  // 256 voxels a side
constexpr Srgb8 kGrey{180, 180, 180};

void append(std::string& bytes, std::uint32_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(value >> shift & 0xFF);
}
std::string number(std::uint32_t value) {
  std::string bytes;
  append(bytes, value);
  return bytes;
}
/// A string or, for a dictionary, each of its keys and values.
std::string text(const std::string& value) {
  return number(static_cast<std::uint32_t>(value.size())) + value;
}

std::string chunk(const char* id, const std::string& content, const std::string& children = {}) {
  return id + number(static_cast<std::uint32_t>(content.size())) +
         number(static_cast<std::uint32_t>(children.size())) + content + children;
}

/// One model: the voxels of a node that is 2^kModelDepth wide (or of the whole grid, if smaller).
struct Model {
  std::uint64_t code;  // the node's Morton code
  std::string voxels;  // four bytes each
};

class VoxFile {
 public:
  VoxFile(const VoxelTree& tree, float exposure)
      : tree_(tree), exposure_(exposure), depth_(std::min(tree.depth(), kModelDepth)) {
    choose_colors();
    collect_models();
  }

  [[nodiscard]] std::string bytes() const {
    std::string children;
    for (const Model& model : models_) {
      const std::uint32_t side = std::uint32_t{1} << depth_;
      children += chunk("SIZE", number(side) + number(side) + number(side));
      const auto count = static_cast<std::uint32_t>(model.voxels.size() / 4);
      children += chunk("XYZI", number(count) + model.voxels);
    }
    children += scene_graph() + palette_chunk();
    return "VOX " + number(200) + chunk("MAIN", {}, children);
  }

 private:
  [[nodiscard]] Srgb8 color(std::uint64_t index) const {
    return tree_.has_values() ? display_color(tree_.values()[index], exposure_) : kGrey;
  }
  void choose_colors() {
    for (std::uint64_t i = 0; i < tree_.voxels(); ++i) palette_.count(color(i));
    palette_.choose(255);
  }
  void collect_models() {
    const unsigned shift = 3 * depth_;
    for_each_voxel(tree_, [&](std::uint64_t code, std::uint64_t index) {
      if (models_.empty() || models_.back().code != code >> shift)
        models_.push_back({code >> shift, {}});
      const Cell cell = morton_decode(code & ((std::uint64_t{1} << shift) - 1));
      const std::uint32_t last = (std::uint32_t{1} << depth_) - 1;
      // y is up here, z there: a quarter turn about x.
      for (const std::uint32_t c : {cell.x, last - cell.z, cell.y})
        models_.back().voxels += static_cast<char>(c);
      models_.back().voxels += static_cast<char>(1 + palette_.index(color(index)));
    });
  }

  /// A root transform, a group, and a transform and a shape for every model.
  [[nodiscard]] std::string scene_graph() const {
    std::string members, nodes;
    for (std::uint32_t m = 0; m < models_.size(); ++m) {
      const std::uint32_t transform = 2 + 2 * m, shape = transform + 1;
      append(members, transform);
      nodes += transform_node(transform, shape, translation(models_[m].code));
      nodes += chunk("nSHP", number(shape) + number(0) + number(1) + number(m) + number(0));
    }
    const std::string group =
        number(1) + number(0) + number(static_cast<std::uint32_t>(models_.size())) + members;
    return transform_node(0, 1, {}) + chunk("nGRP", group) + nodes;
  }
  static std::string transform_node(std::uint32_t id, std::uint32_t child,
                                    const std::string& translation) {
    const std::string frame =
        translation.empty() ? number(0) : number(1) + text("_t") + text(translation);
    constexpr std::uint32_t none = 0xFFFFFFFF;
    return chunk("nTRN", number(id) + number(0) + number(child) + number(none) + number(none) +
                             number(1) + frame);
  }
  /// Of a model's centre; the whole grid stands on the ground, centred.
  [[nodiscard]] std::string translation(std::uint64_t code) const {
    const Cell cell = morton_decode(code);
    const int side = 1 << depth_, half = (1 << tree_.depth()) / 2;
    const auto center = [&](std::uint32_t c) { return static_cast<int>(c) * side + side / 2; };
    return std::to_string(center(cell.x) - half) + " " + std::to_string(half - center(cell.z)) +
           " " + std::to_string(center(cell.y));
  }
  [[nodiscard]] std::string palette_chunk() const {
    std::string content(256 * 4, '\0');
    for (std::size_t i = 0; i < palette_.colors().size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c)
        content[4 * i + c] = static_cast<char>(palette_.colors()[i][c]);
      content[4 * i + 3] = '\xFF';
    }
    return chunk("RGBA", content);
  }

  const VoxelTree& tree_;
  float exposure_;
  unsigned depth_;  // of a model
  Palette palette_;
  std::vector<Model> models_;
};

}  // namespace

void write_vox(const std::filesystem::path& file, const VoxelTree& tree, float exposure) {
  // Sizes of chunks are 32-bit numbers.
  if (tree.voxels() > std::numeric_limits<std::uint32_t>::max() / 8)
    throw FileError(file.string(), "cannot be written: " + std::to_string(tree.voxels()) +
                                       " voxels are more than the format has room for");
  write_file(file, VoxFile(tree, exposure).bytes());
}

}  // namespace relumbre
