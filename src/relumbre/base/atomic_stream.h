/// Files that are written piece by piece and appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "relumbre/base/atomic_file.h"

namespace relumbre {

/// An AtomicFile and the stream into it. Without commit() nothing is left behind. All throw
/// FileError that names the target.
class AtomicStream {
 public:
  explicit AtomicStream(const std::filesystem::path& target);

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// The next write goes there, for headers that are known last.
  void seek(std::uint64_t offset);
  void commit();

 private:
  void check() const;

  std::string name_;
  AtomicFile file_;
  std::ofstream out_;
};

}  // namespace relumbre
