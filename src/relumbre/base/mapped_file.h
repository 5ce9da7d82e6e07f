/// A file as memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace relumbre {

/// Maps a whole file for reading; pages are read when they are touched. The file must not shrink
/// meanwhile: touching what it lost ends the program.
class MappedFile {
 public:
  /// Throws FileError if it is missing or not a regular file. An empty file has no bytes.
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace relumbre
