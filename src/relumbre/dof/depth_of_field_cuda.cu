#include <string>

#include "relumbre/base/error.h"
#include "relumbre/cuda/device.h"
#include "relumbre/dof/depth_of_field_cuda.h"
#include "relumbre/dof/infill.h"

namespace relumbre::cuda {

DeviceDof::DeviceDof(std::size_t width, std::size_t height, bool behind)
    : width_(width), height_(height), behind_(behind) {
  if (width == 0 || height == 0 || width > (std::size_t{1} << 30) / height)
    throw ShapeError("picture of " + std::to_string(width) + " × " + std::to_string(height) +
                     ": the device takes 1 to 2^30 pixels");
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

DeviceFragments& DeviceDof::fragments() {
  if (!fragments_) {
    const std::size_t pixels = width_ * height_;
    expect_free(
        DeviceFragments::bytes_of(pixels, behind_) + DeviceSpread::bytes_of(pixels, behind_),
        "depth of field: fragments");
    fragments_.emplace(pixels, behind_);
  }
  return *fragments_;
}

void DeviceDof::run(const DofConfig& config) {
  config.lens.check();
  if (!picture_) throw ValueError("depth of field: no picture was uploaded");
  if (config.infill && config.method != DofMethod::kGather && !picture_->has_behind())
    throw ValueError("depth of field: what lies behind is to be filled in before the upload");
  DeviceFragments& found = fragments();
  if (!spread_) spread_.emplace(width_ * height_, behind_);
  spread_->run(*picture_, found, config.lens, config.spread, result_.data(), stream_);
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
