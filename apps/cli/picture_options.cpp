#include "cli/picture_options.h"

#include <cmath>

#include "cli/exposure.h"
#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/image_io.h"

namespace relumbre::cli {

void add_picture_options(CLI::App& command, PictureOptions& o) {
  command.add_option("-o,--output", o.outputs, "Picture to write: .png or .exr (repeatable)")
      ->allow_extra_args(false)
      ->required();
  command.add_option("--exposure", o.exposure, "Of .png: auto, or stops")->capture_default_str();
  command.add_option("--curve", o.curve, "Of .png: filmic or srgb")
      ->check(CLI::IsMember({"filmic", "srgb"}))
      ->capture_default_str();
}

void check_pictures(const PictureOptions& options, const std::string& command) {
  for (const std::string& output : options.outputs) {
    if (!can_save_image(output))
      throw FileError(output, "cannot be written: " + command + " writes .exr and .png");
    const AtomicFile writable(output);
  }
}

ToneConfig parse_tone(const PictureOptions& options) {
  ToneConfig tone = parse_exposure(options.exposure);
  tone.curve = options.curve == "filmic" ? ToneCurve::kFilmic : ToneCurve::kSrgb;
  return tone;
}

void save_pictures(const PictureOptions& options, const Image& image, const ToneConfig& tone,
                   Session& session) {
  const float scale = exposure_scale(image, tone);
  session.report.figure("exposure_scale", "exposure", scale,
                        fmt::format("{:.2f} stops", std::log2(scale)));
  for (const std::string& output : options.outputs) {
    save_image(output, image, tone);
    session.report.figure("output", "wrote", output);
  }
}

}  // namespace relumbre::cli
