/// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace relumbre {

/// A file written beside its name and renamed into place; a link's target, if it is a link.
/// Write to path(), then commit(). Without commit() nothing is left behind. What is there and is no
/// regular file, a device or a pipe, is written to as it is and never replaced.
class AtomicFile {
 public:
  /// Throws FileError if the folder does not exist or cannot be written to.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// The temporary file, in the target's folder, with the target's extension kept last; or the
  /// device.
  [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
  /// Flushes to disk and renames over the target. Throws FileError (a full disk, for example).
  void commit();

 private:
  std::filesystem::path target_, temporary_;
  bool is_device_ = false, committed_ = false;
};

/// Writes `bytes` to `target` atomically. Throws FileError.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// The whole file. Throws FileError if it is missing, not a regular file, or larger than
/// `max_bytes`.
std::string read_file(const std::filesystem::path& file,
                      std::uintmax_t max_bytes = std::uintmax_t{1} << 32);

}  // namespace relumbre
