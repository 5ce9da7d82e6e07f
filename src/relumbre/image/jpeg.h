/// JPEG pictures, as textures bring them.
#pragma once

#include <string>
#include <string_view>

#include "relumbre/image/raster.h"

namespace relumbre {

/// Decodes a baseline or progressive JPEG held in memory to 8-bit sRGB; grey is expanded. `name`
/// stands for the file in messages. Throws FileError: not a JPEG, CMYK, damaged, truncated, more
/// than 100 scans, or too large (check_raster_size).
Raster decode_jpeg(std::string_view bytes, const std::string& name);

/// True if the bytes begin as a JPEG file does.
bool is_jpeg(std::string_view bytes);

}  // namespace relumbre
