#include "relumbre/image/image_io.h"

#include <array>
#include <cctype>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/image/exr.h"
#include "relumbre/image/jpeg.h"
#include "relumbre/image/png.h"

namespace relumbre {

namespace {

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::array<float, 256> srgb_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i] = srgb_decode(static_cast<float>(i) / 255);
  return table;
}

}  // namespace

Image linear_image(const Raster& raster) {
  static const std::array<float, 256> linear = srgb_table();
  Image image = rgb_image(raster.width, raster.height);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const std::uint8_t* p = &raster.rgb[3 * i];
    image.set_rgb(i, {linear[p[0]], linear[p[1]], linear[p[2]]});
  }
  return image;
}

Image parse_image(std::string_view bytes, const std::string& name) {
  if (is_exr(bytes)) return parse_exr(bytes, name);
  if (is_png(bytes) || is_jpeg(bytes)) return linear_image(decode_image(bytes, name));
  throw FileError(name, bytes.empty() ? "is empty" : "is not an EXR, PNG or JPEG image");
}

Image load_image(const std::filesystem::path& file) {
  return parse_image(read_file(file), file.string());
}

bool can_save_image(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".exr" || extension == ".png";
}

void save_image(const std::filesystem::path& file, const Image& image, const ToneConfig& tone) {
  if (!can_save_image(file)) {
    throw FileError(file.string(), "images are written as .exr or .png");
  }
  if (lower_extension(file) == ".exr") return write_exr(file, image);
  write_png(file, tone_map(image, tone), image.width(), image.height());
}

}  // namespace relumbre
