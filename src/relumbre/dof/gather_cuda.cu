#include "relumbre/cuda/launch.cuh"
#include "relumbre/dof/blur_steps.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/gather_cuda.h"

namespace relumbre::cuda {

namespace {

constexpr unsigned kThreads = 256;

__global__ void find_radii(const float* depth, CircleOfDepth circle, std::size_t pixels,
                           float* radii) {
  const std::size_t i = std::size_t{blockIdx.x} * kThreads + threadIdx.x;
  if (i < pixels) radii[i] = box_radius(circle(depth[i]));
}

/// In doubles: pictures with lamps in them have a range that no fixed point holds.
SatConfig doubles() {
  SatConfig config;
  config.kind = SatKind::kFloat64;
  return config;
}

}  // namespace

DeviceGather::DeviceGather(std::size_t width, std::size_t height)
    : table_(width, height, 4, doubles()), radii_(width * height) {}

std::size_t DeviceGather::bytes_of(std::size_t pixels) {
  return pixels * (4 * sizeof(double) + sizeof(float));
}

void DeviceGather::run(const DevicePicture& picture, const ThinLens& lens, double largest_diameter,
                       Rgba* result, const Stream& stream) {
  circles_of_confusion({}, lens, picture.width(), largest_diameter);  // checks both
  const std::size_t pixels = picture.pixels();
  launch(find_radii,
         {.blocks = static_cast<unsigned>((pixels + kThreads - 1) / kThreads), .threads = kThreads},
         stream, picture.front().depth.data(),
         CircleOfDepth(lens, picture.width(), largest_diameter), pixels, radii_.data());
  table_.build(&picture.front().color.data()->r, stream);
  box_filter(table_, radii_.data(), {.mode = Border::kClamp}, &result->r, stream);
}

}  // namespace relumbre::cuda
