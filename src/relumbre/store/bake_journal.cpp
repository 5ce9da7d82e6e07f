#include "relumbre/store/bake_journal.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMagic("RELUMBRE BAKE\n\0\0", 16);
constexpr std::uint32_t kVersion = 1;
constexpr std::int64_t kSecondsBetweenSyncs = 5;

struct FileHeader {
  std::array<char, 16> magic{};
  std::uint32_t version = kVersion;
  std::uint32_t rays = 0;
  std::uint64_t key = 0, rows = 0, columns = 0;
  std::uint64_t self = 0;

  [[nodiscard]] std::uint64_t own_hash() const {
    return content_hash(std::as_bytes(std::span(this, 1)).first(offsetof(FileHeader, self)));
  }
};
static_assert(sizeof(FileHeader) == 56);

FileHeader header_of(const JournalKey& key) {
  FileHeader header;
  std::copy(kMagic.begin(), kMagic.end(), header.magic.begin());
  header.rays = key.rays;
  header.key = key.hash;
  header.rows = key.rows;
  header.columns = key.columns;
  header.self = header.own_hash();
  return header;
}

std::int64_t steady_seconds() {
  using namespace std::chrono;
  return duration_cast<seconds>(steady_clock::now().time_since_epoch()).count();
}

std::size_t column_bytes(const JournalKey& key) { return key.columns <= 65536 ? 2 : 4; }
std::size_t count_bytes(const JournalKey& key) { return key.rays <= 65535 ? 2 : 4; }

/// Writes values at `out`, each in `width` bytes, and returns what follows them.
std::byte* pack(std::span<const std::uint32_t> values, std::size_t width, std::byte* out) {
  for (const std::uint32_t v : values) {
    std::memcpy(out, &v, width);  // little-endian: the low bytes come first
    out += width;
  }
  return out;
}

const std::byte* unpack(const std::byte* in, std::size_t width, std::span<std::uint32_t> values) {
  for (std::uint32_t& v : values) {
    v = 0;
    std::memcpy(&v, in, width);
    in += width;
  }
  return in;
}

}  // namespace

struct BakeJournal::BlockHeader {
  std::uint64_t first = 0, rows = 0, nonzeros = 0;
  RayTally tally;
  std::uint32_t largest_count = 0, zero = 0;
  std::uint64_t hash = 0;

  [[nodiscard]] std::uint64_t hash_with(std::span<const std::byte> payload) const {
    ContentHash content;
    content.add(std::as_bytes(std::span(this, 1)).first(offsetof(BlockHeader, hash)));
    content.add(payload);
    return content.digest();
  }
};

fs::path BakeJournal::path_for(const fs::path& store) {
  fs::path file = store;
  file += ".partial";
  return file;
}

BakeJournal::BakeJournal(fs::path file, const JournalKey& key, bool resume)
    : file_(std::move(file)), key_(key), descriptor_(open_for_update(file_)) {
  // File systems without locks go without.
  if (::flock(descriptor_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw FileError(file_.string(), "is in use by another bake");
  }
  last_sync_ = steady_seconds();
  const bool something = file_length(descriptor_.get(), file_) >= sizeof(FileHeader);
  if (resume && something) {
    recover();
  } else {
    start();
  }
}

void BakeJournal::start() {
  if (::ftruncate(descriptor_.get(), 0) != 0) throw FileError(file_.string(), std::strerror(errno));
  const FileHeader header = header_of(key_);
  write_at(descriptor_.get(), 0, std::as_bytes(std::span(&header, 1)), file_);
  end_ = sizeof header;
}

void BakeJournal::recover() {
  FileHeader found;
  read_at(descriptor_.get(), 0, std::as_writable_bytes(std::span(&found, 1)), file_);
  if (std::string_view(found.magic.data(), found.magic.size()) != kMagic) {
    throw FileError(file_.string(), "is not the journal of a bake");
  }
  if (found.version != kVersion) {
    throw FileError(file_.string(), fmt::format("is a journal of version {}, this program "
                                                "continues version {}",
                                                found.version, kVersion));
  }
  if (found.self != found.own_hash()) throw FileError(file_.string(), "is damaged (its header)");
  if (found.self != header_of(key_).self) {
    throw FileError(file_.string(), "is of another scene or other settings");
  }
  end_ = sizeof found;
  const std::uint64_t length = file_length(descriptor_.get(), file_);
  while (recover_block(length)) {
  }
  if (::ftruncate(descriptor_.get(), static_cast<off_t>(end_)) != 0) {
    throw FileError(file_.string(), std::strerror(errno));
  }
}

std::uint64_t BakeJournal::payload_bytes(std::uint64_t rows, std::uint64_t nonzeros) const {
  return rows * sizeof(std::uint32_t) + nonzeros * (column_bytes(key_) + count_bytes(key_));
}

/// Takes in the block at end_. False if there is none that is whole.
bool BakeJournal::recover_block(std::uint64_t length) {
  BlockHeader header;
  if (length - end_ < sizeof header) return false;
  read_at(descriptor_.get(), end_, std::as_writable_bytes(std::span(&header, 1)), file_);
  const std::uint64_t left = length - end_ - sizeof header;
  const bool plausible = header.first == next_row_ && header.rows > 0 &&
                         header.rows <= key_.rows - next_row_ && header.nonzeros <= left &&
                         header.rows <= left && payload_bytes(header.rows, header.nonzeros) <= left;
  if (!plausible) return false;
  std::vector<std::byte> payload(payload_bytes(header.rows, header.nonzeros));
  read_at(descriptor_.get(), end_ + sizeof header, payload, file_);
  if (header.hash != header.hash_with(payload)) return false;
  accept(header);
  return true;
}

void BakeJournal::accept(const BlockHeader& header) {
  blocks_.push_back({end_ + sizeof header, header.rows, header.nonzeros});
  end_ += sizeof header + payload_bytes(header.rows, header.nonzeros);
  next_row_ += header.rows;
  nonzeros_ += header.nonzeros;
  largest_count_ = std::max(largest_count_, header.largest_count);
  tally_ += header.tally;
}

void BakeJournal::append(std::uint64_t first, const SparseCounts& block, const RayTally& tally) {
  assert(first == next_row_ && block.rows() <= key_.rows - next_row_);
  BlockHeader header;
  header.first = first;
  header.rows = block.rows();
  header.nonzeros = block.nonzeros();
  header.tally = tally;
  header.largest_count =
      block.count.empty() ? 0 : *std::max_element(block.count.begin(), block.count.end());
  std::vector<std::byte> bytes = encode(block);
  header.hash = header.hash_with(std::span(bytes).subspan(sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  if (const int reason = try_write_at(descriptor_.get(), end_, bytes); reason != 0) {
    [[maybe_unused]] const int cut = ::ftruncate(descriptor_.get(), static_cast<off_t>(end_));
    throw FileError(file_.string(), fmt::format("{}; {} of {} rows are kept and can be resumed",
                                                std::strerror(reason), next_row_, key_.rows));
  }
  accept(header);
  sync_now_and_then();
}

/// A killed process loses nothing that was written; only a power cut needs the disk to have it.
void BakeJournal::sync_now_and_then() {
  const std::int64_t now = steady_seconds();
  if (now - last_sync_ < kSecondsBetweenSyncs) return;
  last_sync_ = now;
  if (::fdatasync(descriptor_.get()) != 0) throw FileError(file_.string(), std::strerror(errno));
}

/// Room for the header, then the payload.
std::vector<std::byte> BakeJournal::encode(const SparseCounts& block) const {
  std::vector<std::byte> bytes(sizeof(BlockHeader) + payload_bytes(block.rows(), block.nonzeros()));
  std::vector<std::uint32_t> lengths(block.rows());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    lengths[i] = static_cast<std::uint32_t>(block.row_offsets[i + 1] - block.row_offsets[i]);
  }
  std::byte* out = pack(lengths, sizeof(std::uint32_t), bytes.data() + sizeof(BlockHeader));
  out = pack(block.column, column_bytes(key_), out);
  pack(block.count, count_bytes(key_), out);
  return bytes;
}

SparseCounts BakeJournal::decode(const Extent& extent) const {
  std::vector<std::byte> payload(payload_bytes(extent.rows, extent.nonzeros));
  read_at(descriptor_.get(), extent.offset, payload, file_);
  std::vector<std::uint32_t> lengths(extent.rows);
  const std::byte* in = unpack(payload.data(), sizeof(std::uint32_t), lengths);
  SparseCounts block;
  block.columns = key_.columns;
  block.rays = key_.rays;
  block.row_offsets.reserve(extent.rows + 1);
  for (const std::uint32_t length : lengths) {
    block.row_offsets.push_back(block.row_offsets.back() + length);
  }
  block.column.resize(extent.nonzeros);
  block.count.resize(extent.nonzeros);
  in = unpack(in, column_bytes(key_), block.column);
  unpack(in, count_bytes(key_), block.count);
  return block;
}

void BakeJournal::for_each_block(const std::function<void(const SparseCounts&)>& visit) const {
  for (const Extent& extent : blocks_) {
    const SparseCounts block = decode(extent);
    try {
      validate(block);
    } catch (const Error& error) {
      throw FileError(file_.string(), error.what());
    }
    visit(block);
  }
}

void BakeJournal::remove() {
  if (::unlink(file_.c_str()) != 0) throw FileError(file_.string(), std::strerror(errno));
}

}  // namespace relumbre
