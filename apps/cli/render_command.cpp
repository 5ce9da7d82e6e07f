#include "cli/lens_options.h"
#include "cli/opened_store.h"
#include "cli/view_options.h"
#include "relumbre/base/error.h"
#include "relumbre/render/lens_view.h"

namespace relumbre::cli {

namespace {

struct Options {
  StoreOptions store;
  ViewOptions picture;
  std::string mode = "per-pixel";
  std::string radiosity;
  float crease_deg = 30;
  ViewConfig view;
  bool through_lens = false;
  std::uint32_t lens_samples = 256;
  LensOptions lens;
};

/// "auto", the name of one of the scene's cameras, or a cam.json.
Camera choose_camera(const std::string& choice, const Scene& scene) {
  if (choice == "auto") return auto_camera(scene);
  for (const Camera& camera : scene.cameras) {
    if (camera.name == choice) return camera;
  }
  if (std::filesystem::path(choice).extension() == ".json") return read_camera(choice);
  throw ValueError("--camera " + choice +
                   ": no camera of the scene has that name, nor is it a .json file");
}

/// B given by the user instead of computed, for looking at `solve`'s result.
RelitResult given_radiosity(const OpenedStore& store, const std::string& file) {
  const std::size_t n = store.baked.tessellation.elements();
  const FloatArray array = read_npy(file);
  if (array.shape != std::vector<std::size_t>{n, 3}) {
    throw FileError(file, fmt::format("must have shape ({},3)", n));
  }
  RelitResult lit{std::vector<Rgb>(n), std::vector<Rgb>(n), std::vector<Rgb>(n)};
  std::copy(array.data.begin(), array.data.end(), flat(lit.radiosity).begin());
  if (!store.has_emission()) {
    lit.emission = scaled_emission(store.baked.scene, store.baked.tessellation,
                                   store.baked.emission, store.lights);
  }
  return lit;
}

/// B of --emission.
RelitResult relit_emission(const OpenedStore& store, Session& session) {
  const std::size_t n = store.baked.tessellation.elements();
  const FloatArray emission = store.read_emission();
  if (emission.data.size() != 3 * n)
    throw ShapeError("render takes one source vector in --emission");
  RelitResult lit{std::vector<Rgb>(n), std::vector<Rgb>(n), std::vector<Rgb>(n)};
  std::copy(emission.data.begin(), emission.data.end(), flat(lit.emission).begin());
  store.make_operator(session)->apply(emission.data, flat(lit.radiosity));
  return lit;
}

RelitResult light_up(const Options& options, const OpenedStore& store, Session& session) {
  if (!options.radiosity.empty()) return given_radiosity(store, options.radiosity);
  if (store.has_emission()) return relit_emission(store, session);
  return store.relight(session);
}

/// Bad combinations are found before long work.
void check(const Options& options) {
  check_pictures(options.picture, "render");
  if (!options.through_lens) return;
  if (options.view.layers > 1) {
    throw CLI::ValidationError("--layers", "a second layer is of the view without --lens");
  }
  options.lens.aperture.check();
  if (!options.lens.needs_depth()) (void)options.lens.focused({}, 0, 0);
}

Image render_through_lens(const Options& options, const LitScene& lit_scene, const Camera& camera,
                          Session& session) {
  LensViewConfig config{options.view, {}, options.lens.aperture};
  config.view.samples = options.lens_samples;
  std::vector<float> depth;
  if (options.lens.needs_depth()) {
    depth = pinhole_depth(lit_scene.scene, lit_scene.rays, camera, options.view.width,
                          options.view.height);
  }
  config.lens = options.lens.focused(depth, options.view.width, options.view.height);
  const double infinite = config.lens.coc_at_infinity_pixels(options.view.width);
  session.report.figure("focus_distance_m", "in focus", config.lens.focus_distance_m,
                        fmt::format("{:.4g} m", config.lens.focus_distance_m));
  session.report.figure("coc_at_infinity_pixels", "blur at infinity", infinite,
                        fmt::format("{:.1f} pixels", infinite));
  return render_lens_view(lit_scene, camera, config, session.progress);
}

void run(Options options, Session& session) {
  parse_size(options.picture.size, options.view.width, options.view.height);
  const ToneConfig tone = parse_tone(options.picture);
  check(options);
  const OpenedStore store(options.store, session);
  const Camera camera = choose_camera(options.picture.camera, store.baked.scene);
  const RelitResult lit = light_up(options, store, session);
  const bool own_light = store.has_emission() || !options.radiosity.empty();
  options.view.mode =
      options.mode == "gouraud" || own_light ? ViewMode::kGouraud : ViewMode::kDirectPerPixel;

  const Stopwatch watch;
  const DisplayMesh display = conforming_mesh(store.baked.tessellation, options.crease_deg);
  const LitScene lit_scene{store.baked.scene,
                           store.baked.tessellation,
                           display,
                           store.rays,
                           store.baked.reflectance,
                           store.lights,
                           lit};
  const Image image = options.through_lens
                          ? render_through_lens(options, lit_scene, camera, session)
                          : render_view(lit_scene, camera, options.view, session.progress);
  session.progress.clear();
  session.report.figure("render_s", "rendered in", watch.seconds(), seconds_text(watch.seconds()));
  save_pictures(options.picture, image, tone, session);
}

void define(CLI::App& command, Options& o) {
  add_store_options(command, o.store);
  add_device_option(command, o.store.device);
  add_view_options(command, o.picture, "auto, a camera of the scene by name, or cam.json");
  command
      .add_option("--mode", o.mode,
                  "per-pixel: direct light by shadow rays at each pixel; gouraud: interpolated")
      ->check(CLI::IsMember({"per-pixel", "gouraud"}))
      ->capture_default_str();
  command.add_option("--samples", o.view.samples, "Rays per pixel")->capture_default_str();
  command
      .add_option("--shadow-samples", o.view.light_samples,
                  "Shadow rays per pixel and light with a surface")
      ->capture_default_str();
  command
      .add_option("--smoothing", o.view.smoothing_passes,
                  "Passes over coplanar elements against noise")
      ->capture_default_str();
  command.add_option("--crease", o.crease_deg, "Edges sharper than this stay sharp, degrees")
      ->capture_default_str();
  command.add_option("--radiosity", o.radiosity,
                     "Show this B.npy, for example of `relumbre solve`");
  command
      .add_option("--layers", o.view.layers,
                  "2: also what lies behind the first surface, as layer1.* of the .exr")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command
      .add_option("--layer-separation", o.view.layer_separation,
                  "How much deeper that must lie, as a fraction of the first depth")
      ->capture_default_str();
  command.add_flag("--lens", o.through_lens, "Through a lens: depth of field")->group("Lens");
  command.add_option("--lens-samples", o.lens_samples, "Rays per pixel with --lens")
      ->capture_default_str()
      ->group("Lens");
  add_lens_options(command, o.lens);
}

}  // namespace

void add_render_command(CLI::App& app) {
  add_command<Options>(
      app, "render", "A picture of a store under given lights",
      "relumbre render room.h5 --lights evening.json --camera main --size 1280x720 -o evening.png "
      "-o evening.exr",
      define, run);
}

}  // namespace relumbre::cli
