#include <string>

#include "relumbre/base/error.h"
#include "relumbre/cuda/device.h"
#include "relumbre/dof/depth_of_field_cuda.h"
#include "relumbre/dof/infill.h"

namespace relumbre::cuda {

namespace {

/// Up to three fragments a pixel in two layers each are told apart by 32 bits.
constexpr std::size_t kMostPixels = std::size_t{1} << 29;

}  // namespace

DeviceDof::DeviceDof(std::size_t width, std::size_t height, bool behind)
    : width_(width), height_(height), behind_(behind) {
  if (width == 0 || height == 0 || width > kMostPixels / height)
    throw ShapeError("picture of " + std::to_string(width) + " × " + std::to_string(height) +
                     ": the device takes 1 to 2^29 pixels");
}

void DeviceDof::upload(const DepthPicture& picture) {
  if (!picture_) {
    const std::size_t pixels = width_ * height_;
    expect_free(DevicePicture::bytes_of(pixels, behind_) + pixels * sizeof(Rgba),
                "depth of field: picture");
    picture_.emplace(width_, height_, behind_);
    result_ = DeviceArray<Rgba>(pixels);
  }
  picture_->upload(picture, stream_);
  stream_.wait();
}

/// Makes it when it is first asked for, if there is room.
template <class Method, class... Arguments>
Method& DeviceDof::made(std::optional<Method>& method, std::size_t bytes, Arguments... arguments) {
  if (!method) {
    expect_free(bytes, "depth of field");
    method.emplace(arguments...);
  }
  return *method;
}

DeviceFragments& DeviceDof::fragments() {
  const std::size_t pixels = width_ * height_;
  return made(fragments_, DeviceFragments::bytes_of(pixels, behind_), pixels, behind_);
}

void DeviceDof::run(const DofConfig& config) {
  config.lens.check();
  if (!picture_) throw ValueError("depth of field: no picture was uploaded");
  if (config.infill && config.method != DofMethod::kGather && !picture_->has_behind())
    throw ValueError("depth of field: what lies behind is to be filled in before the upload");
  const std::size_t pixels = width_ * height_;
  const double largest = config.spread.largest_diameter;
  switch (config.method) {
    case DofMethod::kGather:
      return made(gather_, DeviceGather::bytes_of(pixels), width_, height_)
          .run(*picture_, config.lens, largest, result_.data(), stream_);
    case DofMethod::kLayered:
      return made(layered_, DeviceLayered::bytes_of(pixels, behind_), pixels, behind_)
          .run(*picture_, fragments(), config.lens, {config.layered_steps, largest}, result_.data(),
               stream_);
    case DofMethod::kSpread:
      return made(spread_, DeviceSpread::bytes_of(pixels, behind_), pixels, behind_)
          .run(*picture_, fragments(), config.lens, config.spread, result_.data(), stream_);
  }
}

std::vector<Rgba> DeviceDof::download() const {
  std::vector<Rgba> result(result_.size());
  copy_to_host(result_.data(), result, stream_);
  stream_.wait();
  return result;
}

std::vector<Rgba> depth_of_field(const DepthPicture& picture, const DofConfig& config) {
  picture.check();
  config.lens.check();
  const bool fill = config.infill && config.method != DofMethod::kGather && !picture.has_behind();
  DofConfig as_it_is = config;
  as_it_is.infill = false;
  DeviceDof dof(picture.width, picture.height, fill || picture.has_behind());
  dof.upload(fill ? infilled(picture, config.lens, config.spread.largest_diameter) : picture);
  dof.run(as_it_is);
  return dof.download();
}

}  // namespace relumbre::cuda
