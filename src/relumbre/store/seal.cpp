#include "relumbre/store/seal.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/store/descriptor.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMagic("RELUMBRE STORE\n\0", 16);
constexpr std::string_view kNote =
    "A baked scene of Relumbre. After these 512 bytes it is an HDF5 file: h5py, MATLAB and Julia "
    "open it as it is. Changing it breaks the seal.\n";

/// The block as it lies in the file.
struct Seal {
  std::array<char, 16> magic{};
  std::uint32_t version = 0;
  std::uint32_t zero = 0;
  std::uint64_t length = 0;
  std::uint64_t contents = 0;
  std::array<char, 464> note{};
  std::uint64_t self = 0;

  [[nodiscard]] std::uint64_t own_hash() const {
    return content_hash(std::as_bytes(std::span(this, 1)).first(offsetof(Seal, self)));
  }
};
static_assert(sizeof(Seal) == kSealBytes && offsetof(Seal, self) == 504);

/// XXH64 of bytes [kSealBytes, length).
std::uint64_t hash_contents(int descriptor, std::uint64_t length, const fs::path& name) {
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  ContentHash hash;
  for (std::uint64_t at = kSealBytes; at < length;) {
    const auto piece = std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), length - at));
    read_at(descriptor, at, piece, name);
    hash.add(piece);
    at += piece.size();
  }
  return hash.digest();
}

void check_length(const Seal& seal, std::uint64_t length, const fs::path& file) {
  if (length == seal.length) return;
  throw FileError(file.string(),
                  fmt::format("is {}: {} bytes, {} were written",
                              length < seal.length ? "truncated" : "longer than it should be",
                              length, seal.length));
}

void check_header(const Seal& seal, std::uint64_t length, const fs::path& file) {
  if (seal.version > kStoreVersion) {
    throw FileError(file.string(), fmt::format("is a store of version {}, this program reads "
                                               "version {}",
                                               seal.version, kStoreVersion));
  }
  if (seal.self != seal.own_hash()) {
    throw FileError(file.string(), "was altered after it was written (its first 512 bytes)");
  }
  check_length(seal, length, file);
}

}  // namespace

std::uint64_t write_seal(int descriptor, const fs::path& name) {
  Seal seal;
  std::copy(kMagic.begin(), kMagic.end(), seal.magic.begin());
  std::copy(kNote.begin(), kNote.end(), seal.note.begin());
  seal.version = kStoreVersion;
  seal.length = file_length(descriptor, name);
  seal.contents = hash_contents(descriptor, seal.length, name);
  seal.self = seal.own_hash();
  write_at(descriptor, 0, std::as_bytes(std::span(&seal, 1)), name);
  return seal.contents;
}

std::uint64_t verify_seal(const fs::path& file) {
  const Descriptor descriptor = open_for_reading(file);
  const std::uint64_t length = file_length(descriptor.get(), file);
  Seal seal;
  if (length >= kSealBytes) {
    read_at(descriptor.get(), 0, std::as_writable_bytes(std::span(&seal, 1)), file);
  }
  if (std::string_view(seal.magic.data(), seal.magic.size()) != kMagic) {
    throw FileError(file.string(), "is not a Relumbre store");
  }
  check_header(seal, length, file);
  if (hash_contents(descriptor.get(), length, file) != seal.contents) {
    throw FileError(file.string(), "was altered after it was written (checksum mismatch)");
  }
  return seal.contents;
}

}  // namespace relumbre
