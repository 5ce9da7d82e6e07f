#include "cli/lens_options.h"

namespace relumbre::cli {

ThinLens LensOptions::focused(std::span<const float> depth, std::size_t width,
                              std::size_t height) const {
  ThinLens result = lens;
  if (focus_distance) {
    result.focus_distance_m = *focus_distance;
  } else if (!focus_pixel.empty()) {
    result.focus_distance_m =
        focus_on_pixel(depth, width, height, static_cast<std::size_t>(focus_pixel[0]),
                       static_cast<std::size_t>(focus_pixel[1]));
  } else if (focus == "nearest") {
    result.focus_distance_m = focus_on_nearest(depth);
  } else {
    result.focus_distance_m = focus_on_pixel(depth, width, height, width / 2, height / 2);
  }
  result.check();
  return result;
}

void add_lens_options(CLI::App& command, LensOptions& o) {
  const std::string group = "Lens";
  command.add_option("--focal-length", o.lens.focal_length_mm, "Millimetres")
      ->capture_default_str()
      ->group(group);
  command.add_option("--f-number", o.lens.f_number, "Focal length / diameter of the opening")
      ->capture_default_str()
      ->group(group);
  command.add_option("--sensor-width", o.lens.sensor_width_mm, "Millimetres")
      ->capture_default_str()
      ->group(group);
  CLI::Option* distance = command.add_option("--focus-distance", o.focus_distance,
                                             "Depth in metres of the plane in focus");
  CLI::Option* pixel =
      command.add_option("--focus-pixel", o.focus_pixel, "X,Y: focus on what is seen there");
  distance->group(group);
  pixel->delimiter(',')
      ->expected(2)
      ->check(CLI::NonNegativeNumber)
      ->excludes(distance)
      ->group(group);
  command.add_option("--focus", o.focus, "On the picture's center, or the nearest surface")
      ->check(CLI::IsMember({"center", "nearest"}))
      ->excludes(distance)
      ->excludes(pixel)
      ->capture_default_str()
      ->group(group);
  command.add_option("--blades", o.aperture.blades, "Of the opening: 0 is a disc, 6 a hexagon")
      ->capture_default_str()
      ->group(group);
  command.add_option("--blade-rotation", o.aperture.rotation_deg, "Degrees counter-clockwise")
      ->capture_default_str()
      ->group(group);
}

}  // namespace relumbre::cli
