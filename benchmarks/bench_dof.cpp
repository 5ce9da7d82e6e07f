// Depth of field against the picture through a lens, of the teapots and of the furnished room, and
// how its time grows with the blur. Writes dof-*.png beside the JSON: pinhole, every rung, the
// lens.

#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "relumbre/base/temporary_folder.h"
#include "relumbre/dof/depth_of_field.h"
#include "relumbre/dof/focus.h"
#include "relumbre/image/flip.h"
#include "relumbre/image/image_io.h"
#include "relumbre/image/metrics.h"
#include "relumbre/image/silhouette.h"
#include "relumbre/radiosity/seen_area.h"
#include "relumbre/render/lens_view.h"
#include "relumbre/render/response_cache.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/store/bake.h"
#include "relumbre/store/store.h"
#include "report.h"

namespace relumbre::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWidth = 1280, kHeight = 720;
constexpr double kBand = 12;  // pixels to either side of silhouettes

struct Shot {
  std::string name;
  Scene scene;
  std::size_t patches, elements;
  ThinLens lens;
};

std::vector<Shot> shots() {
  return {{"teapots", make_teapots_scene(), 500, 30'000, {135, 1.4, 5, 36}},
          {"room", make_room_scene(), 1200, 40'000, {50, 1.4, 3, 36}}};
}

/// What the pinhole camera sees in two layers, what the lens sees, and how long that took.
struct Pictures {
  Image pinhole, lens;
  double lens_seconds = 0;
};

Pictures render(const Shot& shot, std::uint32_t samples) {
  const TemporaryFolder folder;
  BakeConfig bake_config;
  bake_config.patches = shot.patches, bake_config.elements = shot.elements;
  bake_config.rays = 256;
  bake(shot.scene, bake_config, folder / "shot.h5");
  const BakedScene baked = read_store(folder / "shot.h5");

  const RayScene rays(baked.scene.mesh);
  const std::vector<float> weights = seen_area(baked.counts, baked.tessellation.area);
  const auto transport = make_compressed_operator(
      {baked.counts, baked.tessellation.patch_offsets, weights, baked.reflectance},
      CountFormat::kCounts8);
  ResponseCache cache(baked.scene, baked.tessellation, rays);
  const std::vector<Light>& lights = baked.scene.lights;
  const RelitResult lit = relight(baked.scene, baked.tessellation, baked.reflectance,
                                  baked.emission, *transport, lights, cache.responses(lights));
  const DisplayMesh display = conforming_mesh(baked.tessellation);
  const LitScene view{baked.scene, baked.tessellation, display, rays, baked.reflectance, lights,
                      lit};
  const Camera& camera = baked.scene.cameras.front();

  ViewConfig pinhole;
  pinhole.width = kWidth, pinhole.height = kHeight, pinhole.mode = ViewMode::kGouraud;
  LensViewConfig lens{.view = pinhole, .lens = shot.lens, .aperture = {}};
  lens.view.samples = samples;
  pinhole.layers = 2;
  Pictures pictures{render_view(view, camera, pinhole), {}, 0};
  pictures.lens_seconds = seconds_of([&] { pictures.lens = render_lens_view(view, camera, lens); });
  return pictures;
}

struct Rung {
  const char* name;
  DofMethod method;
  BlurShape shape = BlurShape::kAperture;
  bool second_layer = true, infill = false;
  int blades = 0;
};

constexpr Rung kLadder[] = {
    {"gather", DofMethod::kGather},
    {"layered, 2 layers", DofMethod::kLayered},
    {"spread box, 2 layers", DofMethod::kSpread, BlurShape::kBox},
    {"layered, infill", DofMethod::kLayered, BlurShape::kAperture, false, true},
    {"spread disc, 1 layer", DofMethod::kSpread, BlurShape::kAperture, false},
    {"spread disc, infill", DofMethod::kSpread, BlurShape::kAperture, false, true},
    {"spread disc, 2 layers", DofMethod::kSpread}};

DofConfig config_of(const Rung& rung, const ThinLens& lens) {
  DofConfig config{.lens = lens, .method = rung.method, .spread = {}, .infill = rung.infill};
  config.spread.shape = rung.shape;
  config.spread.aperture.blades = rung.blades;
  return config;
}

/// How far a picture is from the one through the lens, over all and in the silhouettes' band.
void judge(const std::string& name, const Image& reference, const Image& test,
           std::span<const std::uint8_t> band, Report& report) {
  const ImageComparison whole = compare_tone_mapped(reference, test),
                        near = compare_tone_mapped(reference, test, {}, band);
  const std::vector<float> flip = flip_hdr(reference, test).error;
  report.figure(name + ": PSNR", whole.psnr_db, "dB");
  report.figure(name + ": SSIM", whole.ssim_luminance, "");
  report.figure(name + ": HDR-FLIP", mean_error(flip), "");
  report.figure(name + ": PSNR in the band", near.psnr_db, "dB");
  report.figure(name + ": SSIM in the band", near.ssim_luminance, "");
  report.figure(name + ": HDR-FLIP in the band", mean_error(flip, band), "");
}

void climb(const Shot& shot, const Pictures& pictures, const fs::path& folder, Report& report) {
  const DepthPicture both = depth_picture(pictures.pinhole);
  DepthPicture front = both;
  front.behind = {};
  const std::vector<std::uint8_t> band =
      silhouette_band(both.front.depth, kWidth, kHeight, {.radius_pixels = kBand});
  const ToneConfig tone{.auto_exposure = true};
  const auto save = [&](const std::string& name, const Image& image) {
    save_image(folder / fmt::format("dof-{}-{}.png", shot.name, name), image, tone);
  };
  save("pinhole", pictures.pinhole), save("lens", pictures.lens);
  report.heading(shot.name);
  judge(shot.name + ", pinhole", pictures.lens, pictures.pinhole, band, report);
  for (const Rung& rung : kLadder) {
    const DofConfig config = config_of(rung, shot.lens);
    std::vector<Rgba> result;
    const std::function<void()> once = [&] {
      result = depth_of_field(rung.second_layer ? both : front, config);
    };
    const double seconds = median_seconds(std::span(&once, 1), 3)[0];
    const std::string name = fmt::format("{}, {}", shot.name, rung.name);
    report.add(
        {name, seconds * 1e3, "through the lens", pictures.lens_seconds * 1e3, "", kNotMeasured});
    const Image image = image_of(result, kWidth, kHeight);
    judge(name, pictures.lens, image, band, report);
    std::string file = rung.name;
    for (char& c : file) c = c == ' ' || c == ',' ? '-' : c;
    save(file, image);
  }
}

/// The same picture with lenses whose largest blur is 4 and 64 pixels, by turns.
void grow(const Pictures& pictures, const ThinLens& lens, Report& report) {
  constexpr Rung kShapes[] = {{"box", DofMethod::kSpread, BlurShape::kBox},
                              {"hexagon", DofMethod::kSpread, BlurShape::kAperture, true, false, 6},
                              {"octagon", DofMethod::kSpread, BlurShape::kAperture, true, false, 8},
                              {"disc", DofMethod::kSpread},
                              {"gather", DofMethod::kGather}};
  const DepthPicture picture = depth_picture(pictures.pinhole);
  const auto blurred = [&](double radius) {
    ThinLens result = lens;
    double largest = 0;
    for (const float c : circles_of_confusion(picture.front.depth, lens, kWidth, 4096))
      largest = std::max(largest, std::abs(static_cast<double>(c)));
    result.f_number *= largest / (2 * radius);
    return result;
  };
  report.heading("largest blur of 4 and of 64 pixels in radius");
  for (const Rung& rung : kShapes) {
    const DofConfig small = config_of(rung, blurred(4)), large = config_of(rung, blurred(64));
    const std::function<void()> runs[] = {[&] { depth_of_field(picture, small); },
                                          [&] { depth_of_field(picture, large); }};
    const std::vector<double> seconds = median_seconds(runs, 7);
    report.add({fmt::format("{}, 64 pixels", rung.name), seconds[1] * 1e3, "4 pixels",
                seconds[0] * 1e3, "", kNotMeasured});
    report.figure(fmt::format("{}: time at 64 pixels over time at 4", rung.name),
                  seconds[1] / seconds[0], "");
  }
}

int run(int argc, char** argv) {
  Report report("dof", argc, argv);
  const fs::path folder = fs::path(report.option("output", "./dof.json")).parent_path();
  const auto samples = static_cast<std::uint32_t>(std::stoul(report.option("samples", "1024")));
  report.figure("lens samples", samples, "");
  for (const Shot& shot : shots()) {
    const Pictures pictures = render(shot, samples);
    climb(shot, pictures, folder, report);
    if (shot.name == "room") grow(pictures, shot.lens, report);
  }
  return report.finish();
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  return relumbre::bench::run_benchmark(relumbre::bench::run, argc, argv);
}
