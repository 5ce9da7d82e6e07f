#include "relumbre/image/png.h"

#include <limits>
#include <vector>

#include <png.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"

namespace relumbre {

namespace {

/// libpng's own reader and writer state: its simplified interface reports errors by value, so no
/// longjmp crosses C++ frames.
struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(this); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

std::vector<std::uint8_t> drop_alpha(std::span<const std::uint8_t> rgba) {
  std::vector<std::uint8_t> rgb(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = rgba[4 * i + c];
  }
  return rgb;
}

std::string encode_png(const std::filesystem::path& file, std::span<const std::uint8_t> rgb,
                       std::size_t width, std::size_t height) {
  PngImage png;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0) {
    throw FileError(file.string(), "cannot be encoded as PNG: " + std::string(png.message));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG\r\n\x1A\n"); }

Raster decode_png(std::string_view bytes, const std::string& name) {
  if (!is_png(bytes)) throw FileError(name, bytes.empty() ? "is empty" : "is not a PNG image");
  PngImage png;
  const auto fail = [&] { throw FileError(name, "is a damaged PNG: " + std::string(png.message)); };
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) fail();
  check_raster_size(name, png.width, png.height, bytes.size());
  png.format = PNG_FORMAT_RGBA;
  png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  std::vector<std::uint8_t> rgba(std::size_t{png.width} * png.height * 4);
  Raster raster{png.width, png.height, {}};
  if (png_image_finish_read(&png, nullptr, rgba.data(), 0, nullptr) == 0) fail();
  raster.rgb = drop_alpha(rgba);
  return raster;
}

Raster read_png(const std::filesystem::path& file) {
  return decode_png(read_file(file), file.string());
}

void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> rgb,
               std::size_t width, std::size_t height) {
  constexpr std::size_t max_side = 1'000'000;  // what libpng's own reader takes
  const std::string shape = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width == 0 || height == 0 || width > max_side || height > max_side ||
      rgb.size() != width * height * 3) {
    throw ShapeError("write_png: " + std::to_string(rgb.size()) + " bytes for " + shape);
  }
  write_file(file, encode_png(file, rgb, width, height));
}

}  // namespace relumbre
