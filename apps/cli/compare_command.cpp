#include <cmath>

#include "cli/command.h"
#include "relumbre/image/image_io.h"
#include "relumbre/image/metrics.h"

namespace relumbre::cli {

namespace {

struct Options {
  std::string reference, test, difference;
};

/// JSON has no NaN or infinity: they become null.
nlohmann::json finite(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

void report(Session& session, const ImageComparison& c) {
  session.report.figure("mse", "mean squared error", finite(c.mse), fmt::format("{:.4g}", c.mse));
  session.report.figure("psnr_db", "PSNR", finite(c.psnr_db), fmt::format("{:.2f} dB", c.psnr_db));
  session.report.figure("ssim_luminance", "SSIM, luminance", finite(c.ssim_luminance),
                        fmt::format("{:.5f}", c.ssim_luminance));
  session.report.figure("ssim_rgb", "SSIM, mean of R, G, B", finite(c.ssim_rgb),
                        fmt::format("{:.5f}", c.ssim_rgb));
}

void run(const Options& options, Session& session) {
  const Image reference = load_image(options.reference), test = load_image(options.test);
  session.report.note(options.test + " against " + options.reference);
  session.report.section("display", "As shown on a screen (tone mapped, peak 1)");
  report(session, compare_tone_mapped(reference, test));
  session.report.section("linear", "Linear values (peak 1)");
  report(session, compare_images(reference, test));
  if (!options.difference.empty()) {
    save_image(options.difference, difference_image(reference, test));
  }
}

}  // namespace

void add_compare_command(CLI::App& app) {
  add_command<Options>(
      app, "compare", "PSNR and SSIM of two images",
      "relumbre compare reference.exr test.exr --difference difference.png",
      [](CLI::App& command, Options& o) {
        command.add_option("reference", o.reference, "EXR, PNG or JPEG")->required();
        command.add_option("test", o.test, "EXR, PNG or JPEG of the same size")->required();
        command.add_option("--difference", o.difference, "Also write |a - b| (.exr or .png)");
      },
      run);
}

}  // namespace relumbre::cli
