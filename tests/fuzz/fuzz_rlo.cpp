// Feeds arbitrary bytes to the octree's reader: it must return a tree that can be walked or throw
// an Error. Each input is tried as it is and with its hashes put right, or few would get past them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/base/huge_array.h"
#include "relumbre/octree/rlo_file.h"

namespace {

using namespace relumbre;

// docs/rlo.md
constexpr std::size_t kSections = 144, kSectionCount = 5, kFileBytes = 264, kHash = 272;

std::uint64_t hash_of(std::span<const std::byte> bytes) {
  ContentHash digest;
  digest.add(bytes);
  return digest.digest();
}

void put_hashes_right(std::span<std::byte> bytes) {
  if (bytes.size() < kHash + sizeof(std::uint64_t)) return;
  for (std::size_t s = 0; s < kSectionCount; ++s) {
    std::uint64_t entry[3];
    std::byte* at = &bytes[kSections + s * sizeof entry];
    std::memcpy(entry, at, sizeof entry);
    if (entry[0] > bytes.size() || entry[1] > bytes.size() - entry[0]) continue;
    entry[2] = hash_of(bytes.subspan(entry[0], entry[1]));
    std::memcpy(at, entry, sizeof entry);
  }
  const std::uint64_t size = bytes.size();
  std::memcpy(&bytes[kFileBytes], &size, sizeof size);
  const std::uint64_t hash = hash_of(bytes.first(kHash));
  std::memcpy(&bytes[kHash], &hash, sizeof hash);
}

void walk(std::span<const std::byte> bytes) {
  try {
    const RloFile file = view_rlo(bytes, nullptr, "fuzz.rlo");
    std::uint64_t voxels = 0;
    for_each_voxel(file.tree, [&](std::uint64_t, std::uint64_t index) {
      if (file.tree.has_values()) voxels += file.tree.values()[index].color & 1;
      ++voxels;
    });
  } catch (const Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  HugeBuffer bytes(std::max<std::size_t>(size, 1));
  std::memcpy(bytes.data(), data, size);
  const auto span = bytes.span().first(size);
  walk(span);
  put_hashes_right(span);
  walk(span);
  return 0;
}
