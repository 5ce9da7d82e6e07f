#include "relumbre/base/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

void sync_to_disk(const fs::path& file, const fs::path& target) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool failed = descriptor < 0 || ::fsync(descriptor) != 0;
  const int reason = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (failed) throw FileError(target.string(), std::strerror(reason));
}

/// Where a link leads, in the end; any other path as it is.
fs::path followed(fs::path target) {
  std::error_code error;
  if (!fs::is_symlink(target, error)) return target;
  fs::path followed = fs::weakly_canonical(target, error);
  return error ? target : followed;
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(followed(std::move(target))) {
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw FileError(target_.string(), "the folder does not exist");
  }
  if (fs::is_directory(target_, error)) throw FileError(target_.string(), "is a folder");
  is_device_ = fs::exists(target_, error) && !fs::is_regular_file(target_, error);
  if (is_device_) {
    temporary_ = target_;
    return;
  }
  std::string name(1, '.');
  name += target_.stem().string() + '.' + std::to_string(::getpid()) + ".tmp";
  temporary_ = folder / (name + target_.extension().string());
  const int descriptor = ::open(temporary_.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) throw FileError(target_.string(), std::strerror(errno));
  ::close(descriptor);
}

AtomicFile::~AtomicFile() {
  if (committed_ || is_device_) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  if (is_device_) return;
  sync_to_disk(temporary_, target_);
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) throw FileError(target_.string(), error.message());
  committed_ = true;
}

void write_file(const fs::path& target, std::string_view bytes) {
  AtomicFile file(target);
  std::ofstream out(file.path(), std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw FileError(target.string(), "cannot be written (is the disk full?)");
  file.commit();
}

std::string read_file(const fs::path& file, std::uintmax_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) throw FileError(file.string(), "no such file");
  if (error) throw FileError(file.string(), error.message());
  if (!fs::is_regular_file(status)) throw FileError(file.string(), "is not a regular file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw FileError(file.string(), error.message());
  if (size > max_bytes) {
    throw FileError(file.string(), "has " + std::to_string(size) + " bytes, more than the " +
                                       std::to_string(max_bytes) + " this reader takes");
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) {
    throw FileError(file.string(), "cannot be read");
  }
  return bytes;
}

}  // namespace relumbre
