/// NumPy .npy arrays of float32, the exchange format for vectors E and B.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relumbre {

/// A C-ordered array. data.size() is the product of shape.
struct FloatArray {
  std::vector<std::size_t> shape;
  std::vector<float> data;
};

/// Reads a little-endian '<f4' or '<f8' (converted) C-ordered array, format version 1 to 3.
/// Throws FileError naming what is wrong: not .npy, another type, Fortran order, truncated.
FloatArray read_npy(const std::filesystem::path& file);

/// The same of a file held in memory; `name` stands for the file in messages.
FloatArray parse_npy(std::string_view bytes, const std::string& name);

/// Writes version 1.0, '<f4', C order, atomically. Throws ShapeError if sizes disagree, FileError.
void write_npy(const std::filesystem::path& file, std::span<const std::size_t> shape,
               std::span<const float> data);

}  // namespace relumbre
