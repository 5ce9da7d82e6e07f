/// The rows of a bake that are finished, in a file that survives a killed process.
///
///   header   magic[16] │ version u32 │ rays u32 │ key u64 │ n u64 │ k u64 │ hash of these u64
///   block    first row u64 │ rows u64 │ nonzeros u64 │ hits, back_face, escaped u64 │
///            largest count u32 │ 0 u32 │ hash of the block's other bytes u64
///            nonzeros of each row   u32 × rows
///            column                 u16 × nonzeros (u32 where k > 65,536)
///            count                  u16 × nonzeros (u32 where rays > 65,535)
///   block    ...
///
/// Little-endian; hashes are XXH64. Blocks follow each other in ascending order of rows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/sparse_counts.h"
#include "relumbre/store/descriptor.h"

namespace relumbre {

/// What the counts are of. A journal with another key is never continued.
struct JournalKey {
  std::uint64_t hash = 0;  ///< of all that the counts depend on: geometry, elements, rays, seed
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  std::uint32_t rays = 0;
};

/// An append-only journal. One process at a time may have it open. Reading back needs the memory of
/// one block.
class BakeJournal {
 public:
  /// Where the journal of a store lies: beside it, with ".partial" added to its name.
  static std::filesystem::path path_for(const std::filesystem::path& store);

  /// resume = true: continues what is there, after its last intact block; what follows that (a
  /// block that was being written when the process died) is cut off. Starts anew if there is
  /// nothing. resume = false: starts anew; a former journal is lost. Throws FileError: in use by
  /// another bake; on resume, not a journal, of another version, of another scene or other
  /// settings; cannot be written.
  BakeJournal(std::filesystem::path file, const JournalKey& key, bool resume);

  /// Rows [0, next_row()) are finished.
  [[nodiscard]] std::uint64_t next_row() const { return next_row_; }
  [[nodiscard]] std::uint64_t nonzeros() const { return nonzeros_; }
  [[nodiscard]] std::uint32_t largest_count() const { return largest_count_; }
  [[nodiscard]] const RayTally& tally() const { return tally_; }

  /// Adds rows [first, first + block.rows()); first must be next_row(). The block is handed to the
  /// operating system at once and to the disk every few seconds. Where that fails (a full disk),
  /// the journal keeps all blocks before, and FileError says how many rows that is.
  void append(std::uint64_t first, const SparseCounts& block, const RayTally& tally);

  /// Visits all blocks in order. Throws FileError if one does not read back as it was written.
  void for_each_block(const std::function<void(const SparseCounts&)>& visit) const;

  /// Deletes the file: its store is complete.
  void remove();

 private:
  struct BlockHeader;
  struct Extent {
    std::uint64_t offset, rows, nonzeros;
  };

  void start();
  void recover();
  bool recover_block(std::uint64_t length);
  void accept(const BlockHeader& header);
  void sync_now_and_then();
  [[nodiscard]] std::uint64_t payload_bytes(std::uint64_t rows, std::uint64_t nonzeros) const;
  [[nodiscard]] std::vector<std::byte> encode(const SparseCounts& block) const;
  [[nodiscard]] SparseCounts decode(const Extent& extent) const;

  std::filesystem::path file_;
  JournalKey key_;
  Descriptor descriptor_;
  std::vector<Extent> blocks_;
  std::uint64_t end_ = 0;  ///< where the next block goes
  std::uint64_t next_row_ = 0, nonzeros_ = 0;
  std::uint32_t largest_count_ = 0;
  RayTally tally_;
  std::int64_t last_sync_ = 0;  ///< steady clock, seconds
};

}  // namespace relumbre
