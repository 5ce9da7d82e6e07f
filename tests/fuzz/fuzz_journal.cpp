// Bytes as the blocks of a bake's journal, behind a good header; the first block gets the hash it
// should have, so that its contents are reached. A resumed bake takes what is whole and cuts off
// the rest, or says with a FileError what is wrong.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include <unistd.h>

#include "relumbre/base/error.h"
#include "relumbre/store/bake_journal.h"
#include "relumbre/store/content_hash.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

constexpr JournalKey kKey{.hash = 1, .rows = 10, .columns = 7, .rays = 100};
constexpr std::size_t kHeader = 64, kHashAt = 56;  // of a block

/// As long as the block says it is, or as far as the bytes go.
std::size_t payload_size(const std::string& block) {
  std::uint64_t rows = 0, nonzeros = 0;
  std::memcpy(&rows, &block[8], sizeof rows);
  std::memcpy(&nonzeros, &block[16], sizeof nonzeros);
  const std::size_t all = block.size() - kHeader;
  return rows <= all && nonzeros <= all ? std::min<std::size_t>(all, 4 * rows + 4 * nonzeros) : all;
}

std::string with_hash(std::string block) {
  if (block.size() < kHeader) return block;
  const auto bytes = std::as_bytes(std::span(block));
  ContentHash hash;
  hash.add(bytes.first(kHashAt));
  hash.add(bytes.subspan(kHeader, payload_size(block)));
  const std::uint64_t digest = hash.digest();
  std::memcpy(&block[kHashAt], &digest, sizeof digest);
  return block;
}

void resume(const std::filesystem::path& file) {
  const BakeJournal journal(file, kKey, true);
  std::uint64_t rows = 0;
  journal.for_each_block([&rows](const SparseCounts& block) { rows += block.rows(); });
  if (rows != journal.next_row()) std::abort();
}

}  // namespace
}  // namespace relumbre

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace relumbre;
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("fuzz_journal." + std::to_string(::getpid()));
  { const BakeJournal header(file, kKey, false); }
  const std::string blocks(reinterpret_cast<const char*>(data), size);
  put_bytes(file, bytes_of(file) + with_hash(blocks));
  try {
    resume(file);
  } catch (const FileError&) {
  }
  std::filesystem::remove(file);
  return 0;
}
