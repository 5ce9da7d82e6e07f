#include "relumbre/image/image.h"

#include <utility>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr std::size_t kMaxValues = std::size_t{1} << 33;
constexpr std::array<std::string_view, 3> kRgbNames = {"R", "G", "B"};

std::string shape_text(std::size_t width, std::size_t height, std::size_t channels) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels, " +
         std::to_string(channels) + " channels";
}

void require_bounded(std::size_t width, std::size_t height, std::size_t channels) {
  const bool fits =
      width <= kMaxValues / height && (channels == 0 || width * height <= kMaxValues / channels);
  if (!fits) {
    throw ValueError("image: " + shape_text(width, height, channels) +
                     " are more values than an image may hold");
  }
}

}  // namespace

Image::Image(std::size_t width, std::size_t height, std::span<const std::string> channel_names)
    : width_(width), height_(height) {
  if (width == 0 || height == 0) {
    throw ValueError("image: " + shape_text(width, height, channel_names.size()) +
                     ": a side is zero");
  }
  require_bounded(width, height, channel_names.size());
  for (const std::string& name : channel_names) add(name);
}

std::size_t Image::find(std::string_view name) const {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].name == name) return i;
  }
  return kAbsent;
}

bool Image::has(std::string_view name) const { return find(name) != kAbsent; }

std::span<const float> Image::channel(std::string_view name) const {
  const std::size_t i = find(name);
  if (i == kAbsent) throw ValueError("image: has no channel '" + std::string(name) + "'");
  return channels_[i].values;
}

std::span<float> Image::channel(std::string_view name) {
  const std::span<const float> plane = std::as_const(*this).channel(name);
  return {const_cast<float*>(plane.data()), plane.size()};
}

std::span<float> Image::add(std::string_view name) {
  if (pixels() == 0) throw ValueError("image: an image without pixels takes no channel");
  if (const std::size_t i = find(name); i != kAbsent) return channels_[i].values;
  require_bounded(width_, height_, channels_.size() + 1);
  channels_.push_back({std::string(name), std::vector<float>(pixels())});
  for (std::size_t c = 0; c < 3; ++c) {
    if (name == kRgbNames[c]) rgb_[c] = channels_.size() - 1;
  }
  return channels_.back().values;
}

bool Image::has_rgb() const {
  return rgb_[0] != kAbsent && rgb_[1] != kAbsent && rgb_[2] != kAbsent;
}

void Image::require_rgb() const {
  for (std::size_t c = 0; c < 3; ++c) {
    if (rgb_[c] == kAbsent) {
      throw ValueError("image: has no channel '" + std::string(kRgbNames[c]) + "'");
    }
  }
}

Rgb Image::rgb(std::size_t i) const {
  require_rgb();
  return {channels_[rgb_[0]].values[i], channels_[rgb_[1]].values[i], channels_[rgb_[2]].values[i]};
}

void Image::set_rgb(std::size_t i, const Rgb& c) {
  require_rgb();
  for (std::size_t k = 0; k < 3; ++k) channels_[rgb_[k]].values[i] = c[k];
}

Image rgb_image(std::size_t width, std::size_t height) {
  const std::array<std::string, 3> names = {"R", "G", "B"};
  return {width, height, names};
}

}  // namespace relumbre
