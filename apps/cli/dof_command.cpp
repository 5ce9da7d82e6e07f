#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "cli/picture_options.h"
#include "cli/processor.h"
#include "relumbre/base/error.h"
#include "relumbre/dof/depth_of_field.h"
#include "relumbre/dof/focus.h"
#include "relumbre/image/image_io.h"

namespace relumbre::cli {

namespace {

struct Options {
  std::string input, overlay, method = "spread", shape = "disc", device;
  PictureOptions picture;
  std::optional<double> focus_distance, vertical_fov;
  std::vector<std::size_t> focus_pixel;  // empty, or x and y
  DepthPictureConfig channels;
  DofConfig dof;
  std::size_t layers = 0;  // 0: as many as suit the method
};

double pixels_per_tangent(const Options& options, std::size_t width, std::size_t height) {
  if (options.vertical_fov) {
    const double half = *options.vertical_fov * std::numbers::pi / 360;
    return static_cast<double>(height) / 2 / std::tan(half);
  }
  const ThinLens& lens = options.dof.lens;
  return static_cast<double>(width) * lens.focal_length_mm / lens.sensor_width_mm;
}

DepthPicture load(const Options& options) {
  const Image image = load_image(options.input);
  DepthPictureConfig config = options.channels;
  config.pixels_per_tangent = pixels_per_tangent(options, image.width(), image.height());
  try {
    return depth_picture(image, config);
  } catch (const ValueError& error) {
    throw FileError(options.input, error.what());
  }
}

double focus(const Options& options, const DepthPicture& picture) {
  if (options.focus_distance) return *options.focus_distance;
  try {
    if (options.focus_pixel.empty()) return automatic_focus(picture);
    return focus_on_pixel(picture.front.depth, picture.width, picture.height,
                          options.focus_pixel[0], options.focus_pixel[1]);
  } catch (const ValueError& error) {
    throw FileError(options.input, error.what());
  }
}

DofConfig dof_config(const Options& options, const DepthPicture& picture) {
  DofConfig config = options.dof;
  config.lens.focus_distance_m = focus(options, picture);
  config.lens.check();
  config.method = options.method == "gather"    ? DofMethod::kGather
                  : options.method == "layered" ? DofMethod::kLayered
                                                : DofMethod::kSpread;
  config.spread.shape = options.shape == "box" ? BlurShape::kBox : BlurShape::kAperture;
  if (options.shape == "hexagon") config.spread.aperture.blades = 6;
  if (options.shape == "octagon") config.spread.aperture.blades = 8;
  if (options.layers != 0) config.spread.layers = config.layered_steps = options.layers;
  return config;
}

void report(const DepthPicture& picture, const DofConfig& config, double seconds,
            Session& session) {
  const std::vector<float> circles = circles_of_confusion(
      picture.front.depth, config.lens, picture.width, config.spread.largest_diameter);
  const auto [near, far] = std::ranges::minmax(circles);
  Report& report = session.report;
  report.figure("focus_m", "focus", config.lens.focus_distance_m,
                fmt::format("{:.4g} m", config.lens.focus_distance_m));
  report.figure("coc_before_px", "largest blur before it", std::max(0.0F, -near),
                fmt::format("{:.1f} pixels", std::max(0.0F, -near)));
  report.figure("coc_behind_px", "largest blur behind it", std::max(0.0F, far),
                fmt::format("{:.1f} pixels", std::max(0.0F, far)));
  report.figure("second_layer", "what lies behind",
                config.method == DofMethod::kGather ? "not used"
                : picture.has_behind()              ? "read"
                : config.infill                     ? "guessed"
                                                    : "unknown");
  report.figure("seconds", "computed in", seconds, seconds_text(seconds));
}

/// Bad combinations, and files that cannot be written, are found before long work.
void check(const Options& options) {
  check_pictures(options.picture, "dof");
  if (!options.overlay.empty()) check_pictures({.outputs = {options.overlay}}, "dof");
  if (options.dof.spread.aperture.blades != 0 && options.shape != "disc") {
    throw CLI::ValidationError("--blades", "and --shape " + options.shape + " exclude each other");
  }
  options.dof.spread.aperture.check();
  if (!std::isfinite(options.dof.spread.largest_diameter)) {
    throw CLI::ValidationError("--max-blur", "must be a number of pixels");
  }
  ThinLens lens = options.dof.lens;
  // A distance that the picture is yet to tell is taken for a thousand focal lengths.
  lens.focus_distance_m = options.focus_distance.value_or(lens.focal_length_mm);
  lens.check();
}

void save(const Options& options, const DepthPicture& picture, const std::vector<Rgba>& result,
          const DofConfig& config, const ToneConfig& tone, Session& session) {
  save_pictures(options.picture, image_of(result, picture.width, picture.height), tone, session);
  if (options.overlay.empty()) return;
  save_image(options.overlay, focus_overlay(picture, config.lens), tone);
  session.report.figure("overlay", "wrote", options.overlay);
}

void run(const Options& options, Session& session) {
  const ToneConfig tone = parse_tone(options.picture);
  check(options);
  const auto processor = make_processor(options.device, session);
  const DepthPicture picture = load(options);
  const DofConfig config = dof_config(options, picture);
  const Stopwatch watch;
  const std::vector<Rgba> result = processor->depth_of_field(picture, config, session.progress);
  session.progress.clear();
  report(picture, config, watch.seconds(), session);
  save(options, picture, result, config, tone, session);
}

void define_input(CLI::App& command, Options& o) {
  command.add_option("input", o.input, "EXR with colour and depth")->required();
  command.add_option("--color", o.channels.color,
                     "Prefix of the colour channels, for example ViewLayer.Combined.");
  command.add_option("--depth", o.channels.depth, "The depth channel, for example Z");
  CLI::Option* radial = command.add_flag(
      "--radial", o.channels.radial, "Depth is measured along rays, not along the camera's axis");
  command
      .add_option("--vfov", o.vertical_fov,
                  "Vertical angle of view, degrees, for --radial (default: the lens's)")
      ->check(CLI::Range(0.1, 179.9))
      ->needs(radial);
  command.add_flag("--straight-alpha", o.channels.straight_alpha,
                   "Colour is not multiplied by alpha");
}

void define_lens(CLI::App& command, Options& o) {
  command.add_option("--focal-length", o.dof.lens.focal_length_mm, "mm")->capture_default_str();
  command.add_option("--f-number", o.dof.lens.f_number, "Focal length over opening")
      ->capture_default_str();
  command.add_option("--sensor-width", o.dof.lens.sensor_width_mm, "mm")->capture_default_str();
  CLI::Option* distance = command.add_option("--focus-distance", o.focus_distance,
                                             "m (default: what the middle shows)");
  command.add_option("--focus-pixel", o.focus_pixel, "X,Y: focus on what is seen there")
      ->delimiter(',')
      ->expected(2)
      ->check(CLI::NonNegativeNumber)
      ->excludes(distance);
}

void define_blur(CLI::App& command, Options& o) {
  command.add_option("--method", o.method, "gather, layered or spread")
      ->check(CLI::IsMember({"gather", "layered", "spread"}))
      ->capture_default_str();
  command.add_option("--shape", o.shape, "Of blurs: disc, hexagon, octagon, or box (the fastest)")
      ->check(CLI::IsMember({"disc", "hexagon", "octagon", "box"}))
      ->capture_default_str();
  command.add_option("--blades", o.dof.spread.aperture.blades,
                     "A polygon of so many corners instead");
  command.add_option("--blade-rotation", o.dof.spread.aperture.rotation_deg, "degrees")
      ->capture_default_str();
  command.add_flag("--infill", o.dof.infill,
                   "Guess what a blurred foreground uncovers, where the file does not say");
  command
      .add_option("--layers", o.layers,
                  "Steps of blur that are told apart; otherwise 24, of `layered` 64")
      ->check(CLI::Range(1, 256));
  command.add_option("--max-blur", o.dof.spread.largest_diameter, "Largest blur, pixels")
      ->check(CLI::Range(1.0, ApertureKernels::kLargest))
      ->capture_default_str();
}

void define(CLI::App& command, Options& o) {
  define_input(command, o);
  define_lens(command, o);
  define_blur(command, o);
  add_picture_options(command, o.picture);
  add_device_option(command, o.device);
  command.add_option("--overlay", o.overlay,
                     "Also write what is in focus: red before it, blue behind it");
}

}  // namespace

void add_dof_command(CLI::App& app) {
  add_command<Options>(app, "dof", "Focus a picture with depth through a lens",
                       "relumbre dof room.exr --focal-length 50 --f-number 1.4 "
                       "--focus-pixel 640,360 --infill -o room-dof.png",
                       define, run);
}

}  // namespace relumbre::cli
