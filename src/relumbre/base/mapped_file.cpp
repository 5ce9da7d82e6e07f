#include "relumbre/base/mapped_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

class OpenFile {
 public:
  explicit OpenFile(const std::filesystem::path& file)
      : name_(file.string()), descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) throw FileError(name_, std::strerror(errno));
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  [[nodiscard]] std::size_t size() const {
    struct stat info {};
    if (::fstat(descriptor_, &info) != 0) throw FileError(name_, std::strerror(errno));
    if (!S_ISREG(info.st_mode)) throw FileError(name_, "is not a regular file");
    return static_cast<std::size_t>(info.st_size);
  }
  [[nodiscard]] const void* map(std::size_t bytes) const {
    void* memory = ::mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE, descriptor_, 0);
    if (memory == MAP_FAILED) throw FileError(name_, std::strerror(errno));
    return memory;
  }

 private:
  std::string name_;
  int descriptor_;
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& file) {
  const OpenFile open(file);
  const std::size_t size = open.size();
  if (size > 0) bytes_ = {static_cast<const std::byte*>(open.map(size)), size};
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

}  // namespace relumbre
