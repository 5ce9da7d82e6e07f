#include "relumbre/base/atomic_stream.h"

#include "relumbre/base/error.h"

namespace relumbre {

AtomicStream::AtomicStream(const std::filesystem::path& target)
    : name_(target.string()), file_(target), out_(file_.path(), std::ios::binary) {}

void AtomicStream::write(std::span<const std::byte> bytes) {
  out_.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  check();
}

void AtomicStream::seek(std::uint64_t offset) {
  out_.seekp(static_cast<std::streamoff>(offset));
  check();
}

void AtomicStream::commit() {
  out_.close();
  check();
  file_.commit();
}

void AtomicStream::check() const {
  if (!out_) throw FileError(name_, "cannot be written (is the disk full?)");
}

}  // namespace relumbre
