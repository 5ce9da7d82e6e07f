#include "relumbre/image/raster.h"

#include "relumbre/base/error.h"
#include "relumbre/image/jpeg.h"
#include "relumbre/image/png.h"

namespace relumbre {

namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;
// Deflate shrinks by at most 1032:1, and a PNG pixel takes at least one bit: 8256 pixels a byte.
// A Huffman-coded JPEG block of 64 pixels takes at least a bit or so, far fewer pixels a byte.
constexpr std::uint64_t kMaxPixelsPerByte = 8448;

}  // namespace

Raster decode_image(std::string_view bytes, const std::string& name) {
  if (is_png(bytes)) return decode_png(bytes, name);
  if (is_jpeg(bytes)) return decode_jpeg(bytes, name);
  throw FileError(name, bytes.empty() ? "is empty" : "is neither a PNG nor a JPEG image");
}

void check_raster_size(const std::string& name, std::uint64_t width, std::uint64_t height,
                       std::size_t encoded_bytes) {
  const std::string shape = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width == 0 || height == 0) throw FileError(name, "has " + shape);
  if (width > kMaxPixels / height) {
    throw FileError(name, "has " + shape + ", more than this reader takes");
  }
  if (width * height / kMaxPixelsPerByte > encoded_bytes) {
    throw FileError(name, "claims " + shape + ", more than its " + std::to_string(encoded_bytes) +
                              " bytes can hold");
  }
}

}  // namespace relumbre
