#include "cli/octree_report.h"

namespace relumbre::cli {

void report_octree(const RloFile& file, Session& session) {
  const VoxelTree& tree = file.tree;
  Report& report = session.report;
  const Cube& cube = tree.cube();
  report.figure("depth", "depth", tree.depth(),
                fmt::format("{} ({} voxels a side)", tree.depth(),
                            grouped(std::uint64_t{1} << tree.depth())));
  report.figure("separating", "separating", tree.separating() == Separating::k6 ? 6 : 26);
  report.figure("cube", "cube",
                nlohmann::json{{"corner", {cube.corner.x, cube.corner.y, cube.corner.z}},
                               {"edge", cube.edge}},
                fmt::format("{:.6g} m wide, from {:.6g} {:.6g} {:.6g}", cube.edge, cube.corner.x,
                            cube.corner.y, cube.corner.z));
  const std::uint64_t voxels = tree.voxels();
  report.figure("voxels", "voxels", voxels, grouped(voxels));
  nlohmann::json nodes = nlohmann::json::array();
  std::string text;
  for (unsigned level = 0; level < tree.levels(); ++level) {
    nodes.push_back(tree.size(level));
    text += (level > 0 ? ", " : "") + grouped(tree.size(level));
  }
  report.figure("nodes", "nodes of 4 x 4 x 4, a level", nodes, text);
  const double bytes = static_cast<double>(tree.geometry_bytes()) / static_cast<double>(voxels);
  report.figure("bytes_per_voxel", "geometry", bytes, fmt::format("{:.3f} bytes a voxel", bytes));
  const bool is_lit = tree.content() == VoxelTree::Content::kRadiosity;
  const std::string colors = !tree.has_values() ? "none" : is_lit ? "radiosity" : "reflectance";
  report.figure("colors", "colours", colors);
  report.figure("build_s", "built in", file.build_seconds, seconds_text(file.build_seconds));
}

}  // namespace relumbre::cli
