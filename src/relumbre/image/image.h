/// Float images with named channels, as EXR has them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// width × height pixels, planar: every channel is its own row-major plane, row 0 at the top.
class Image {
 public:
  struct Channel {
    std::string name;
    std::vector<float> values;  ///< width · height
  };

  Image() = default;
  /// All planes are zero. A name given twice makes one plane. Throws ValueError if a side is 0 or
  /// width · height · channels exceeds 2^33.
  Image(std::size_t width, std::size_t height, std::span<const std::string> channel_names);

  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] std::size_t height() const { return height_; }
  [[nodiscard]] std::size_t pixels() const { return width_ * height_; }
  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }
  [[nodiscard]] bool has(std::string_view name) const;
  /// The plane of that name. Throws ValueError naming the channel if there is none.
  [[nodiscard]] std::span<float> channel(std::string_view name);
  [[nodiscard]] std::span<const float> channel(std::string_view name) const;
  /// Adds a plane of zeros (or returns the one that is there). Spans and references into
  /// channels() stay valid only until a plane is added. Throws ValueError beyond 2^33 values.
  std::span<float> add(std::string_view name);

  /// True if planes R, G and B are there.
  [[nodiscard]] bool has_rgb() const;
  /// R, G, B at pixel i < pixels(). Throw ValueError if one of the three planes is missing.
  [[nodiscard]] Rgb rgb(std::size_t i) const;
  void set_rgb(std::size_t i, const Rgb& c);

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);
  [[nodiscard]] std::size_t find(std::string_view name) const;
  void require_rgb() const;

  std::size_t width_ = 0, height_ = 0;
  std::vector<Channel> channels_;
  std::array<std::size_t, 3> rgb_{kAbsent, kAbsent, kAbsent};  ///< where R, G, B are in channels_
};

/// A black image with channels R, G, B.
Image rgb_image(std::size_t width, std::size_t height);

}  // namespace relumbre
