/// The header of PLY files. Internal to the import.
#pragma once

#include <cstdint>
#include <filesystem>

namespace relumbre {

/// Reads the header and refuses a file that is shorter than the elements it announces need at
/// least: bytes in the binary formats (a face has three corners or more), lines in the text format.
/// Throws FileError. O(header), or O(file) for text.
/// Source: Turk 1994, "The PLY Polygon File Format".
void check_ply(const std::filesystem::path& file, std::uintmax_t size);

}  // namespace relumbre
