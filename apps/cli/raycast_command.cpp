#include "cli/octree_report.h"
#include "cli/processor.h"
#include "cli/traversal_options.h"
#include "cli/view_options.h"
#include "relumbre/base/error.h"
#include "relumbre/render/traversal_view.h"
#include "relumbre/render/voxel_view.h"

namespace relumbre::cli {

namespace {

struct Options {
  std::string octree;
  ViewOptions picture;
  VoxelViewConfig view;
  std::string shading = "auto", show = "picture", device;
  TraversalOptions traversal;
  const CLI::App* command = nullptr;

  [[nodiscard]] bool is_given(const std::string& name) const { return command->count(name) > 0; }
};

VoxelShading shading_of(const std::string& name, const VoxelTree& tree) {
  if (name == "color") return VoxelShading::kColor;
  if (name == "normal") return VoxelShading::kNormal;
  const bool is_light = tree.content() == VoxelTree::Content::kRadiosity;
  return name == "auto" && is_light ? VoxelShading::kColor : VoxelShading::kLit;
}

Camera camera_of(const std::string& choice, const VoxelTree& tree) {
  return choice == "auto" ? voxel_camera(tree.cube()) : read_camera(choice);
}

/// A lit surface and a normal have their brightness, unless told otherwise; light is exposed.
ToneConfig tone_of(const Options& options, const VoxelViewConfig& view) {
  ViewOptions picture = options.picture;
  if (view.shading != VoxelShading::kColor || options.show != "picture") {
    if (!options.is_given("--exposure")) picture.exposure = "0";
    if (!options.is_given("--curve")) picture.curve = "srgb";
  }
  return parse_tone(picture);
}

/// What has no say in a heat map.
void check_heat_map(const Options& options) {
  if (options.show == "picture") return;
  for (const char* name : {"--samples", "--shading", "--smooth", "--detail"})
    if (options.is_given(name))
      throw CLI::ValidationError(name, "is of pictures, not of --show " + options.show);
}

/// The thesis's traversals, which heat maps are of, are the CPU's.
void check_device(const Options& options) {
  if (options.device == "cpu" || (options.show == "picture" && !options.view.traversal)) return;
  throw CLI::ValidationError("--device", "only casts pictures by the fast traversal on a GPU");
}

/// None: the fast one, which has no heat maps.
std::optional<Traversal> traversal_of(const Options& options) {
  const bool is_picture = options.show == "picture";
  std::string name = options.traversal.name;
  if (name.empty()) name = is_picture ? "fast" : "full-stack";
  if (name == "fast" && !is_picture)
    throw CLI::ValidationError("--traversal", "fast has no heat maps");
  return published_traversal(name, options.traversal.stack_nodes);
}

Image make_picture(const Options& options, const VoxelViewConfig& view, const VoxelTree& tree,
                   Session& session) {
  const Camera camera = camera_of(options.picture.camera, tree);
  if (options.show == "picture") return render_voxels(tree, camera, view, session.progress);
  return traversal_heat_map(tree, camera, view.width, view.height, *view.traversal, options.show,
                            session.progress);
}

void report_traversal(const Image& image, Session& session) {
  for (const char* name : {"visits", "reads", "level"}) {
    const auto values = image.channel(name);
    double sum = 0;
    for (const float v : values) sum += static_cast<double>(v);
    const double mean = sum / static_cast<double>(values.size());
    const float most = *std::ranges::max_element(values);
    session.report.figure(name, name, nlohmann::json{{"mean", mean}, {"largest", most}},
                          fmt::format("{:.2f} a ray, at most {:.0f}", mean, most));
  }
}

void run(Options options, Session& session) {
  parse_size(options.picture.size, options.view.width, options.view.height);
  check_heat_map(options);
  check_traversal_options(*options.command, options.traversal);
  options.view.traversal = traversal_of(options);
  check_device(options);
  check_pictures(options.picture, "raycast");
  const auto processor = make_processor(options.device, session);
  const RloFile file = read_rlo(options.octree);
  options.view.shading = shading_of(options.shading, file.tree);
  const ToneConfig tone = tone_of(options, options.view);

  options.view.caster = processor->tree_caster(file.tree);
  const Stopwatch watch;
  const Image image = make_picture(options, options.view, file.tree, session);
  session.progress.clear();
  const auto rays = static_cast<double>(options.view.width * options.view.height) *
                    (options.show == "picture" ? 1 + options.view.samples : 1);
  session.report.figure("render_s", "rendered in", watch.seconds(),
                        fmt::format("{} ({:.1f} Mray/s)", seconds_text(watch.seconds()),
                                    rays / watch.seconds() / 1e6));
  if (options.show != "picture") report_traversal(image, session);
  save_pictures(options.picture, image, tone, session);
}

void define(CLI::App& command, Options& o) {
  o.command = &command;
  command.add_option("octree", o.octree, "An octree written by `relumbre voxelize` (.rlo)")
      ->required();
  add_device_option(command, o.device);
  add_view_options(command, o.picture, "auto (all of the cube), or cam.json");
  command.add_option("--samples", o.view.samples, "Rays per pixel")->capture_default_str();
  command
      .add_option(
          "--shading", o.shading,
          "lit: a lamp at the eye; color: as stored; normal; auto: color for relit octrees, "
          "else lit")
      ->check(CLI::IsMember({"auto", "lit", "color", "normal"}))
      ->capture_default_str();
  command.add_flag("--smooth", o.view.smooth,
                   "Interpolate colours and normals between neighbouring voxels");
  command
      .add_option("--detail", o.view.detail,
                  "Level of detail: show nodes of up to so many pixels by their means; 0: voxels "
                  "alone")
      ->check(CLI::Range(0.0, 1e3))
      ->capture_default_str();
  command
      .add_option("--show", o.show,
                  "picture, or a heat map of what a traversal does: visits, reads or level")
      ->check(CLI::IsMember({"picture", "visits", "reads", "level"}))
      ->capture_default_str();
  add_traversal_options(
      command, o.traversal, "fast",
      "fast, restart, backtrack, full-stack or short-stack (default: fast; of heat maps "
      "full-stack)");
}

}  // namespace

void add_raycast_command(CLI::App& app) {
  add_command<Options>(app, "raycast", "A picture of a sparse voxel octree",
                       "relumbre raycast bunny.rlo --size 1280x720 --smooth -o bunny.png", define,
                       run);
}

}  // namespace relumbre::cli
