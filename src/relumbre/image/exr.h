/// OpenEXR files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/image/image.h"

namespace relumbre {

struct ExrConfig {
  /// Channels stored as 16-bit half floats (11 significant bits, infinite beyond 65504). All others
  /// are stored as 32-bit floats, exactly.
  std::vector<std::string> half_channels;
};

/// Reads every channel (half, float or uint, converted to float) of a scanline or tiled file, in
/// the file's alphabetical order. Pixel (0, 0) is the data window's upper left corner, wherever
/// that lies. Of a multi-part file it reads part 0, of a mipmap the full resolution.
/// Throws FileError: missing, not OpenEXR, deep, subsampled channels, damaged, incomplete, more
/// than 2^28 pixels or 2^30 values, or far more than a file of its size can hold.
Image read_exr(const std::filesystem::path& file);

/// The same of a file held in memory; `name` stands for the file in messages.
Image parse_exr(std::string_view bytes, const std::string& name);

/// Writes all channels, ZIP-compressed scanlines, atomically. Throws ValueError if a half channel
/// is not in the image or the image has no channel, FileError if it cannot be written.
void write_exr(const std::filesystem::path& file, const Image& image, const ExrConfig& config = {});

/// True if the bytes begin as an OpenEXR file does.
bool is_exr(std::string_view bytes);

}  // namespace relumbre
