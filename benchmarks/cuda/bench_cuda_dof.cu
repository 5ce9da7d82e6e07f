// Depth of field of a picture of 1920 × 1080 that is on the device: every method, several blurs.
// Beside it a copy on the device of the bytes that any method has to move (a colour and a depth
// read, a colour written), and spread() on the CPU. Transfers are timed apart.
#include <chrono>
#include <cmath>
#include <random>

#include "bench.cuh"
#include "relumbre/dof/depth_of_field_cuda.h"

namespace relumbre::bench {
namespace {

constexpr std::size_t kWidth = 1920, kHeight = 1080, kPixels = kWidth * kHeight;
/// The CPU's row by row spreading takes long for more.
constexpr double kLargestOnCpu = 64;

/// A floor that goes back to the sky, balls that hang before it at all depths, each with its own
/// light and noise on it; some pixels are lamps. `behind`: the same without the balls.
DepthPicture picture_of(bool behind) {
  struct Ball {
    float x, y, radius, depth;
  };
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24F; };
  std::vector<Ball> balls;
  for (int i = 0; i < 40; ++i)
    balls.push_back({uniform() * 1920, uniform() * 1080, 20 + 90 * uniform(), 1 + 7 * uniform()});
  DepthPicture picture{.width = kWidth, .height = kHeight, .front = {}};
  for (std::size_t i = 0; i < kPixels; ++i) {
    const auto x = static_cast<float>(i % kWidth), y = static_cast<float>(i / kWidth);
    const float floor = y > 400 ? 700 / (y - 400 + 7) : 100;
    float depth = floor, light = y > 400 ? 0.4F : 0.8F;
    for (const Ball& ball : balls) {
      const float dx = (x - ball.x) / ball.radius, dy = (y - ball.y) / ball.radius;
      const float z = ball.depth - 0.2F * std::sqrt(std::max(1 - dx * dx - dy * dy, 0.0F));
      if (dx * dx + dy * dy < 1 && z < depth) depth = z, light = 0.5F - 0.4F * dy;
    }
    const auto color = [&](float l) {
      const float lamp = uniform() < 2e-4F ? 200.0F : 1.0F;
      return Rgba{lamp * l * uniform(), lamp * l * uniform(), lamp * l * uniform(), 1};
    };
    picture.front.color.push_back(color(light));
    picture.front.depth.push_back(depth);
    if (!behind) continue;
    picture.behind.color.push_back(color(0.5F));
    picture.behind.depth.push_back(floor);
  }
  return picture;
}

/// In focus at 3 m; so many pixels of blur in diameter at most.
DofConfig config_of(DofMethod method, BlurShape shape, double blur) {
  DofConfig config{};
  config.method = method;
  config.spread.shape = shape;
  config.lens.focus_distance_m = 3;
  config.lens.f_number = 1;
  // The nearest is about 1 m away and blurred twice as much as what is far away.
  config.lens.f_number = 2 * config.lens.coc_at_infinity_pixels(kWidth) / blur;
  config.spread.largest_diameter = blur;
  return config;
}

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void expect_alike(const std::vector<Rgba>& device, const std::vector<Rgba>& cpu) {
  const auto alike = [](float a, float b) {
    return std::abs(a - b) <= 1e-5F * std::max(1.0F, std::abs(b));
  };
  for (std::size_t i = 0; i < kPixels; ++i)
    if (!alike(device[i].r, cpu[i].r) || !alike(device[i].g, cpu[i].g) ||
        !alike(device[i].b, cpu[i].b) || !alike(device[i].a, cpu[i].a))
      throw Error("pixel " + std::to_string(i) + " differs from the CPU's");
}

struct Case {
  const char* name;
  DofMethod method;
  BlurShape shape = BlurShape::kAperture;
  int blades = 0;
};
constexpr Case kCases[] = {{"gather", DofMethod::kGather},
                           {"layered", DofMethod::kLayered},
                           {"spread box", DofMethod::kSpread, BlurShape::kBox},
                           {"spread disc", DofMethod::kSpread},
                           {"spread hexagon", DofMethod::kSpread, BlurShape::kAperture, 6}};

Row measure(cuda::DeviceDof& dof, const DepthPicture& picture, const Case& what, double blur,
            const std::string& kind) {
  DofConfig config = config_of(what.method, what.shape, blur);
  config.spread.aperture.blades = what.blades;
  Row row;
  row.name =
      std::string(what.name) + ", " + std::to_string(static_cast<int>(blur)) + " pixels" + kind;
  dof.run(config);
  const std::vector<Rgba> result = dof.download();
  if (what.method == DofMethod::kSpread && blur <= kLargestOnCpu) {
    std::vector<Rgba> cpu;
    row.peer = "the CPU's";
    row.peer_seconds = seconds_of([&] { cpu = spread(picture, config.lens, config.spread); });
    // A CPU spreads large polygons along their edges, a little softer.
    if (what.shape == BlurShape::kAperture && what.blades == 0) expect_alike(result, cpu);
  }
  const std::size_t bytes = kPixels * (2 * sizeof(Rgba) + sizeof(float));
  const Work works[] = {[&](const cuda::Stream&) { dof.run(config); }, DeviceCopy(bytes / 2)};
  const std::vector<double> seconds = median_seconds(works, dof.stream());
  row.seconds = seconds[0];
  row.bytes = static_cast<double>(bytes);
  row.limit = "a copy of these bytes";
  row.limit_seconds = seconds[1];
  print(row);
  return row;
}

void print_transfers(cuda::DeviceDof& dof, const DepthPicture& picture) {
  const double up = seconds_of([&] { dof.upload(picture); });
  const double down = seconds_of([&] { static_cast<void>(dof.download()); });
  std::printf("to the device, with its checks %.2f ms, back %.2f ms (pageable memory)\n", up * 1e3,
              down * 1e3);
}

void run() {
  print_heading("Depth of field of 1920 x 1080, by largest diameter of the blur");
  const DepthPicture picture = picture_of(false), both = picture_of(true);
  cuda::DeviceDof dof(kWidth, kHeight, false);
  dof.upload(picture);
  print_transfers(dof, picture);
  double disc = kNotMeasured, box = 0;
  for (const Case& what : kCases) {
    for (const double blur : {4.0, 16.0, 64.0, 256.0}) {
      const Row row = measure(dof, picture, what, blur, "");
      if (what.method != DofMethod::kSpread || what.blades != 0) continue;
      if (what.shape == BlurShape::kBox) box = std::max(box, row.seconds);
      if (what.shape == BlurShape::kAperture && blur == 16) disc = row.seconds;
    }
  }
  cuda::DeviceDof dof_of_both(kWidth, kHeight, true);
  dof_of_both.upload(both);
  for (const Case& what : kCases)
    if (what.method != DofMethod::kGather) measure(dof_of_both, both, what, 16, ", 2 layers");
  print_figure("dof_spread_1080p_ms", disc * 1e3, 1, "ms", true);
  print_figure("dof_spread_box_1080p_ms", box * 1e3, 1, "ms", true);
}

}  // namespace
}  // namespace relumbre::bench

int main() { return relumbre::bench::run_benchmark(relumbre::bench::run); }
