#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "cli/command.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/exr.h"
#include "relumbre/image/flip.h"
#include "relumbre/image/image_io.h"
#include "relumbre/image/metrics.h"
#include "relumbre/image/png.h"
#include "relumbre/image/silhouette.h"

namespace relumbre::cli {

namespace {

struct Options {
  std::string reference, test, difference, flip_map;
  bool flip = true;
  std::optional<double> band;
  SilhouetteConfig silhouette;
  FlipConfig flip_config;
};

/// JSON has no NaN or infinity: they become null.
nlohmann::json finite(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

struct Picture {
  Image image;
  bool linear;  ///< an EXR: its values are radiances and not what a screen shows
};

Picture load(const std::string& file) {
  const std::string bytes = read_file(file);
  return {parse_image(bytes, file), is_exr(bytes)};
}

void report(Session& session, const ImageComparison& c) {
  session.report.figure("mse", "mean squared error", finite(c.mse), fmt::format("{:.4g}", c.mse));
  session.report.figure("psnr_db", "PSNR", finite(c.psnr_db), fmt::format("{:.2f} dB", c.psnr_db));
  session.report.figure("ssim_luminance", "SSIM, luminance", finite(c.ssim_luminance),
                        fmt::format("{:.5f}", c.ssim_luminance));
  session.report.figure("ssim_rgb", "SSIM, mean of R, G, B", finite(c.ssim_rgb),
                        fmt::format("{:.5f}", c.ssim_rgb));
}

/// The depth that silhouettes are found in: the reference's, or else the test's.
std::span<const float> depth_of(const Options& options, const Image& reference, const Image& test) {
  for (const Image* image : {&reference, &test}) {
    if (image->has("Z")) return image->channel("Z");
  }
  throw FileError(options.reference, "--band needs a channel Z, here or in " + options.test);
}

std::vector<std::uint8_t> silhouettes(const Options& options, const Image& reference,
                                      const Image& test, Session& session) {
  SilhouetteConfig config = options.silhouette;
  config.radius_pixels = *options.band;
  std::vector<std::uint8_t> mask = silhouette_band(depth_of(options, reference, test),
                                                   reference.width(), reference.height(), config);
  const auto pixels = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
  const double fraction = static_cast<double>(pixels) / static_cast<double>(mask.size());
  session.report.section("band",
                         fmt::format("Band of {} pixels around silhouettes", config.radius_pixels));
  session.report.figure("pixels", "pixels", pixels,
                        grouped(pixels) + " (" + percent_text(fraction) + ")");
  session.report.json()["band"]["fraction"] = fraction;
  return mask;
}

/// HDR-FLIP where one of the files is linear, LDR-FLIP of the displayed values where none is.
std::vector<float> report_flip(const Options& options, const Picture& reference,
                               const Picture& test, Session& session) {
  const double ppd = options.flip_config.pixels_per_degree;
  const auto show = [&](const char* kind, const std::vector<float>& error) {
    session.report.section("flip", fmt::format("{}-FLIP ({:.1f} pixels per degree)", kind, ppd));
    session.report.figure("mean", "mean error", finite(mean_error(error)),
                          fmt::format("{:.5f}", mean_error(error)));
    session.report.json()["flip"]["kind"] = kind;
    session.report.json()["flip"]["pixels_per_degree"] = ppd;
  };
  if (!reference.linear && !test.linear) {
    const auto encoded = [](const Image& image) {
      return tone_mapped(image, {.curve = ToneCurve::kSrgb});
    };
    std::vector<float> error =
        flip_ldr(encoded(reference.image), encoded(test.image), options.flip_config);
    show("LDR", error);
    return error;
  }
  HdrFlip hdr = flip_hdr(reference.image, test.image, options.flip_config);
  show("HDR", hdr.error);
  const ExposureRange& range = hdr.exposures;
  session.report.figure(
      "exposures", "exposures", range.count,
      fmt::format("{} from {:.2f} to {:.2f} stops", range.count, range.start, range.stop));
  session.report.json()["flip"]["start_exposure"] = range.start;
  session.report.json()["flip"]["stop_exposure"] = range.stop;
  return std::move(hdr.error);
}

void report_band(const Options& options, const Image& reference, const Image& test,
                 std::span<const float> flip_error, Session& session) {
  const std::vector<std::uint8_t> mask = silhouettes(options, reference, test, session);
  if (options.flip) {
    const double mean = mean_error(flip_error, mask);
    session.report.figure("flip", "FLIP, mean error", finite(mean), fmt::format("{:.5f}", mean));
  }
  session.report.section("display_band", "As shown on a screen, in the band");
  report(session, compare_tone_mapped(reference, test, {}, mask));
  session.report.section("linear_band", "Linear values, in the band");
  report(session, compare_images(reference, test, mask));
}

void run(const Options& options, Session& session) {
  if (!options.flip_map.empty() && !options.flip) {
    throw CLI::ValidationError("--flip-map", "needs FLIP, which --no-flip leaves out");
  }
  const Picture reference = load(options.reference), test = load(options.test);
  session.report.note(options.test + " against " + options.reference);
  session.report.section("display", "As shown on a screen (tone mapped, peak 1)");
  report(session, compare_tone_mapped(reference.image, test.image));
  session.report.section("linear", "Linear values (peak 1)");
  report(session, compare_images(reference.image, test.image));
  std::vector<float> flip_error;
  if (options.flip) flip_error = report_flip(options, reference, test, session);
  if (options.band) report_band(options, reference.image, test.image, flip_error, session);
  if (!options.difference.empty()) {
    save_image(options.difference, difference_image(reference.image, test.image));
  }
  if (!options.flip_map.empty()) {
    write_png(options.flip_map, error_picture(flip_error), reference.image.width(),
              reference.image.height());
  }
}

void define(CLI::App& command, Options& o) {
  command.add_option("reference", o.reference, "EXR, PNG or JPEG")->required();
  command.add_option("test", o.test, "EXR, PNG or JPEG of the same size")->required();
  command.add_option("--difference", o.difference, "Also write |a - b| (.exr or .png)");
  command.add_flag("--flip,!--no-flip", o.flip,
                   "HDR-FLIP of EXR, LDR-FLIP of PNG and JPEG (default: on)");
  command.add_option("--flip-map", o.flip_map, "Also write FLIP's error at every pixel (.png)")
      ->check([](const std::string& file) {
        return std::filesystem::path(file).extension() == ".png" ? "" : "must end in .png";
      });
  command
      .add_option("--ppd", o.flip_config.pixels_per_degree,
                  "FLIP: pixels per degree of visual angle")
      ->capture_default_str();
  command.add_option("--band", o.band,
                     "All again within this many pixels of silhouettes (needs a channel Z)");
  command
      .add_option("--band-jump", o.silhouette.relative_jump,
                  "A silhouette is where neighbours' depths differ by this fraction")
      ->capture_default_str();
}

}  // namespace

void add_compare_command(CLI::App& app) {
  add_command<Options>(app, "compare", "PSNR, SSIM and FLIP of two images",
                       "relumbre compare reference.exr test.exr --band 8 --flip-map flip.png",
                       define, run);
}

}  // namespace relumbre::cli
