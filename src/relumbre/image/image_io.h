/// Loads and saves images of any supported kind.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "relumbre/image/image.h"
#include "relumbre/image/raster.h"
#include "relumbre/image/tone_map.h"

namespace relumbre {

/// Linear values of an EXR (all channels as stored), or of a PNG or JPEG (R, G, B decoded from
/// sRGB to [0, 1]). The kind is told by the first bytes, not by the name. Throws FileError.
Image load_image(const std::filesystem::path& file);

/// The same of a file held in memory; `name` stands for the file in messages.
Image parse_image(std::string_view bytes, const std::string& name);

/// Writes atomically by extension, upper or lower case: `.exr` all channels, linear, 32-bit float;
/// `.png` R, G, B tone mapped by `tone`. Throws FileError naming the supported kinds for any other,
/// or if it cannot be written; ValueError if a PNG is asked of an image without R, G, B.
void save_image(const std::filesystem::path& file, const Image& image, const ToneConfig& tone = {});

/// True if save_image takes the extension: asked before long work, so that it is not lost.
bool can_save_image(const std::filesystem::path& file);

/// Bytes to linear R, G, B.
Image linear_image(const Raster& raster);

}  // namespace relumbre
