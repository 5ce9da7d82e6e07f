// Bytes as the blocks of a bake's journal, behind a good header: once as they are, and once with
// every block given the hash it should have, so that the contents are reached. A resumed bake takes
// what is whole and cuts off the rest, or says with a FileError what is wrong.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include <unistd.h>

#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/store/bake_journal.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

constexpr JournalKey kKey{.hash = 1, .rows = 10, .columns = 7, .rays = 100};
constexpr std::size_t kHeader = 64, kHashAt = 56;  // of a block

/// Of the block that begins at `at`: as long as it says it is, or as far as the bytes go.
std::size_t payload_size(const std::string& blocks, std::size_t at) {
  std::uint64_t rows = 0, nonzeros = 0;
  std::memcpy(&rows, &blocks[at + 8], sizeof rows);
  std::memcpy(&nonzeros, &blocks[at + 16], sizeof nonzeros);
  const std::size_t all = blocks.size() - at - kHeader;
  return rows <= all && nonzeros <= all ? std::min<std::size_t>(all, 4 * rows + 4 * nonzeros) : all;
}

std::string with_hashes(std::string blocks) {
  for (std::size_t at = 0; blocks.size() - at >= kHeader;) {
    const std::size_t payload = payload_size(blocks, at);
    const auto block = std::as_bytes(std::span(blocks)).subspan(at, kHeader + payload);
    ContentHash hash;
    hash.add(block.first(kHashAt));
    hash.add(block.subspan(kHeader));
    const std::uint64_t digest = hash.digest();
    std::memcpy(&blocks[at + kHashAt], &digest, sizeof digest);
    at += kHeader + payload;
  }
  return blocks;
}

void resume(const std::filesystem::path& file, const std::string& blocks) {
  { const BakeJournal header(file, kKey, false); }
  put_bytes(file, bytes_of(file) + blocks);
  try {
    const BakeJournal journal(file, kKey, true);
    std::uint64_t rows = 0;
    journal.for_each_block([&rows](const SparseCounts& block) { rows += block.rows(); });
    if (rows != journal.next_row()) std::abort();
  } catch (const FileError&) {
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace relumbre

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace relumbre;
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("fuzz_journal." + std::to_string(::getpid()));
  const std::string blocks(reinterpret_cast<const char*>(data), size);
  resume(file, blocks);
  resume(file, with_hashes(blocks));
  return 0;
}
