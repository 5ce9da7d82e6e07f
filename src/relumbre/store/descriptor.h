/// POSIX file descriptors that close themselves, and reads and writes that do all or throw.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

namespace relumbre {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  [[nodiscard]] int get() const { return value_; }

 private:
  int value_;
};

// In all of these, `name` is what a FileError calls the file.

/// A regular file. Throws FileError.
Descriptor open_for_reading(const std::filesystem::path& file);

/// Opens for reading and writing; made if it is not there, never cut. Throws FileError.
Descriptor open_for_update(const std::filesystem::path& file);

std::uint64_t file_length(int descriptor, const std::filesystem::path& name);

/// Fills `bytes` from `offset`. Throws FileError, also where the file ends before.
void read_at(int descriptor, std::uint64_t offset, std::span<std::byte> bytes,
             const std::filesystem::path& name);

/// Writes all of `bytes` at `offset` and returns 0, or returns errno.
int try_write_at(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes);

/// The same, but throws FileError.
void write_at(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes,
              const std::filesystem::path& name);

}  // namespace relumbre
