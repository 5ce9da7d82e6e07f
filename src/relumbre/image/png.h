/// PNG files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "relumbre/image/raster.h"

namespace relumbre {

/// Writes 8-bit sRGB pixels (width · height · 3, row 0 at the top) atomically.
/// Throws ShapeError if the sizes disagree or a side is 0, FileError if it cannot be written.
void write_png(const std::filesystem::path& file, std::span<const std::uint8_t> rgb,
               std::size_t width, std::size_t height);

/// Reads any PNG as 8-bit sRGB: 16 bits are rounded, grey and palette expanded, alpha dropped
/// (the colour as stored, not composited), a gAMA other than sRGB's converted.
/// Throws FileError: missing, not a PNG, damaged, truncated, or too large (check_raster_size).
Raster read_png(const std::filesystem::path& file);

/// The same of a PNG held in memory; `name` stands for the file in messages.
Raster decode_png(std::string_view bytes, const std::string& name);

/// True if the bytes begin as a PNG file does.
bool is_png(std::string_view bytes);

}  // namespace relumbre
