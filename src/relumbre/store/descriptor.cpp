#include "relumbre/store/descriptor.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace fs = std::filesystem;

Descriptor::~Descriptor() {
  if (value_ >= 0) ::close(value_);
}

Descriptor open_for_reading(const fs::path& file) {
  std::error_code error;
  const bool special = fs::exists(file, error) && !fs::is_regular_file(file, error);
  if (special) throw FileError(file.string(), "is not a regular file");
  Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) throw FileError(file.string(), std::strerror(errno));
  return descriptor;
}

Descriptor open_for_update(const fs::path& file) {
  Descriptor descriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (descriptor.get() < 0) throw FileError(file.string(), std::strerror(errno));
  return descriptor;
}

std::uint64_t file_length(int descriptor, const fs::path& name) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) throw FileError(name.string(), std::strerror(errno));
  return static_cast<std::uint64_t>(status.st_size);
}

void read_at(int descriptor, std::uint64_t offset, std::span<std::byte> bytes,
             const fs::path& name) {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(name.string(), std::strerror(errno));
    if (got == 0) throw FileError(name.string(), "ended while it was read");
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

int try_write_at(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put =
        ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno;
    if (put == 0) return ENOSPC;
    bytes = bytes.subspan(static_cast<std::size_t>(put));
    offset += static_cast<std::uint64_t>(put);
  }
  return 0;
}

void write_at(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes,
              const fs::path& name) {
  const int reason = try_write_at(descriptor, offset, bytes);
  if (reason != 0) throw FileError(name.string(), std::strerror(reason));
}

}  // namespace relumbre
