/// 8-bit pictures as PNG and JPEG hold them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace relumbre {

/// 8-bit sRGB pixels, row-major, row 0 at the top.
struct Raster {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< width · height · 3
};

/// Decodes a PNG or a JPEG held in memory, told apart by their first bytes. `name` stands for the
/// file in messages. Throws FileError: neither of the two, damaged, truncated, or too large.
Raster decode_image(std::string_view bytes, const std::string& name);

/// Refuses, before anything is allocated, a picture of more than 2^28 pixels, one without pixels,
/// and one that claims far more pixels than `encoded_bytes` can hold. Throws FileError.
void check_raster_size(const std::string& name, std::uint64_t width, std::uint64_t height,
                       std::size_t encoded_bytes);

}  // namespace relumbre
