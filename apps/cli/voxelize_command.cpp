#include <filesystem>

#include "cli/exposure.h"
#include "cli/octree_report.h"
#include "cli/opened_store.h"
#include "cli/scene_input.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/octree/rlo_file.h"
#include "relumbre/octree/voxel_export.h"
#include "relumbre/octree/voxelize.h"
#include "relumbre/render/lit_surface.h"

namespace relumbre::cli {

namespace {

struct Options {
  SceneOptions scene;
  StoreOptions store;
  std::string output;
  std::vector<std::string> exports;
  std::string exposure;
  unsigned depth = 8;
  int separating = 26;
  std::uint64_t memory = std::uint64_t{4} << 30;
  bool geometry_only = false;
};

/// What is voxelised: triangles, and what their surface looks like.
struct Subject {
  TriangleMesh mesh;
  SurfaceSampler surface;
};

/// A scene's materials, textures and normals.
Subject scene_subject(std::shared_ptr<const Scene> scene) {
  Subject subject{scene->mesh, {}};
  subject.surface = [scene](std::uint32_t t, float u, float v) {
    SurfaceSample sample{scene->reflectance(t, u, v), scene->mesh.scaled_normal(t)};
    if (scene->mesh.two_sided[t] != 0) sample.back = sample.color;
    return sample;
  };
  return subject;
}

/// A store's surface under the given lights, and what it refers to.
struct LitStore {
  LitStore(const StoreOptions& options, Session& session)
      : store(options, session),
        lit(store.relight(session)),
        display(conforming_mesh(store.baked.tessellation)),
        surface({store.baked.scene, store.baked.tessellation, display, store.rays,
                 store.baked.reflectance, store.lights, lit},
                LitSurface::Direct::kInterpolated, ViewConfig{}.smoothing_passes) {
    store.baked.counts = {};  // has answered
  }

  OpenedStore store;
  RelitResult lit;
  DisplayMesh display;
  LitSurface surface;
};

/// Its radiosity, in W/m².
Subject relit_subject(const StoreOptions& options, Session& session) {
  if (!options.emission.empty())
    throw ValueError("--emission: voxelize takes a store's light from --lights");
  const auto lit = std::make_shared<const LitStore>(options, session);
  Subject subject{lit->store.baked.scene.mesh, {}};
  subject.surface = [lit](std::uint32_t t, float u, float v) {
    const TriangleMesh& mesh = lit->store.baked.scene.mesh;
    SurfaceSample sample{lit->surface.at(t, false, u, v), mesh.scaled_normal(t)};
    if (mesh.two_sided[t] != 0) sample.back = lit->surface.at(t, true, u, v);
    return sample;
  };
  return subject;
}

Subject read_subject(const Options& options, Session& session) {
  if (!options.store.store.empty()) return relit_subject(options.store, session);
  return scene_subject(std::make_shared<const Scene>(import_and_report(options.scene, session)));
}

VoxelizeConfig config_of(const Options& options, Subject& subject) {
  VoxelizeConfig config{.depth = options.depth, .surface = {}};
  config.separating = options.separating == 6 ? Separating::k6 : Separating::k26;
  if (!options.geometry_only) config.surface = std::move(subject.surface);
  return config;
}

/// Refuses what the memory limit does not allow, before any work.
void plan_memory(const Options& options, const Subject& subject, const Cube& cube,
                 VoxelizeConfig& config, Session& session) {
  const VoxelizeEstimate estimate = estimate_voxelize(subject.mesh, cube, config);
  session.report.section("estimate", "Before it starts");
  session.report.figure("voxels", "voxels, about", estimate.voxels, grouped(estimate.voxels));
  session.report.figure("memory_bytes", "memory, about", estimate.memory_bytes,
                        bytes_text(estimate.memory_bytes));
  session.report.figure("disk_bytes", "disk, about", estimate.disk_bytes,
                        bytes_text(estimate.disk_bytes));
  if (estimate.memory_bytes > options.memory) {
    throw ValueError(
        fmt::format("depth {} needs about {} of memory beside the mesh and --memory allows {}",
                    options.depth, bytes_text(estimate.memory_bytes), bytes_text(options.memory)));
  }
  config.list_bytes = options.memory - estimate.memory_bytes + kLeastListBytes;
}

/// Builds the file and returns the passes it took.
std::uint64_t build(const Options& options, const Subject& subject, const Cube& cube,
                    const VoxelizeConfig& config, Session& session) {
  const Stopwatch watch;
  const auto content = options.store.store.empty() ? VoxelTree::Content::kReflectance
                                                   : VoxelTree::Content::kRadiosity;
  RloWriter writer(options.output, cube, config.depth, config.separating, content);
  const VoxelizeReport report = voxelize(
      subject.mesh, cube, config, [&](VoxelBlocks&& blocks) { writer.add(blocks); },
      session.progress);
  session.progress.clear();
  writer.finish(watch.seconds());
  return report.passes;
}

/// Of exported colours: materials as they are, unless told; light is exposed.
ToneConfig export_tone(const Options& options) {
  const bool is_lit = !options.store.store.empty();
  return parse_exposure(options.exposure.empty() ? (is_lit ? "auto" : "0") : options.exposure);
}

/// What exported colours are multiplied by. 12 bytes a voxel meanwhile if it depends on them.
float export_exposure(const VoxelTree& tree, const ToneConfig& tone) {
  const bool looks = tone.auto_exposure && tree.has_values();
  Image voxels = rgb_image(looks ? tree.values().size() : 1, 1);
  for (std::size_t i = 0; looks && i < voxels.pixels(); ++i) {
    const VoxelValue& v = tree.values()[i];
    voxels.set_rgb(i, (unpack_color(v.color) + back_color(v)) * 0.5F);
  }
  return exposure_scale(voxels, tone);
}

void check_outputs(const Options& options) {
  if (std::filesystem::path(options.output).extension() != ".rlo")
    throw FileError(options.output, "cannot be written: voxelize writes .rlo");
  for (const std::string& file : options.exports) check_export(file, options.depth);
  std::vector<std::string> files = options.exports;
  files.push_back(options.output);
  for (const std::string& file : files) {
    std::error_code error;
    if (std::filesystem::equivalent(file, options.scene.file, error))
      throw FileError(file, "is the scene itself");
    const AtomicFile writable(file);
  }
}

void run(const Options& options, Session& session) {
  if (options.scene.file.empty() == options.store.store.empty())
    throw ValueError("voxelize takes either a scene or --store STORE");
  check_outputs(options);
  const ToneConfig tone = export_tone(options);
  Subject subject = read_subject(options, session);
  const Cube cube = cube_around(bounds(subject.mesh.positions));
  VoxelizeConfig config = config_of(options, subject);
  plan_memory(options, subject, cube, config, session);
  const std::uint64_t passes = build(options, subject, cube, config, session);
  const RloFile file = read_rlo(options.output);
  session.report.section("octree", options.output);
  report_octree(file, session);
  session.report.figure("passes", "passes over the mesh", passes);
  if (options.exports.empty()) return;
  const float exposure = export_exposure(file.tree, tone);
  for (const std::string& name : options.exports) {
    export_voxels(name, file.tree, exposure);
    session.report.figure("export", "exported", name);
  }
}

}  // namespace

void add_voxelize_command(CLI::App& app) {
  add_command<Options>(
      app, "voxelize", "Turn a mesh, or a store's relit light, into a sparse voxel octree",
      "relumbre voxelize bunny.obj --depth 10 -o bunny.rlo --export bunny.ply",
      [](CLI::App& command, Options& o) {
        add_scene_options(command, o.scene);
        command.get_option("scene")->required(false);
        add_store_options(command, o.store, "--store");
        command.get_option("--store")->description(
            "Instead of a scene: its radiosity under --lights is the voxels' colour");
        command.add_option("-o,--output", o.output, "The octree to write (.rlo)")->required();
        command.add_option("--depth", o.depth, "2^depth voxels a side")
            ->check(CLI::Range(0U, kMaxVoxelDepth))
            ->capture_default_str();
        command
            .add_option("--separating", o.separating,
                        "26: every voxel that a triangle touches; 6: thin, without holes")
            ->check(CLI::IsMember({6, 26}))
            ->capture_default_str();
        command.add_flag("--geometry-only", o.geometry_only, "Leave out colours and normals");
        command.add_option("--memory", o.memory, "Memory to use beside the mesh, as 500M or 8G")
            ->transform(CLI::AsSizeValue(false))
            ->default_str("4G");
        command.add_option("--export", o.exports,
                           "Also write MagicaVoxel's .vox or points as .ply (repeatable)");
        command.add_option("--exposure", o.exposure,
                           "Of exported colours: auto (default for --store), or stops (else: 0)");
      },
      run);
}

}  // namespace relumbre::cli
