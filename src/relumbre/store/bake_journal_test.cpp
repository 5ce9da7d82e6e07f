#include "relumbre/store/bake_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/temporary_folder.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr JournalKey kKey{.hash = 0x1234, .rows = 10, .columns = 7, .rays = 100};

/// Two rows: the first with `first` in its name, the second empty.
SparseCounts block_of(const JournalKey& key, std::uint32_t first) {
  SparseCounts block;
  block.columns = key.columns;
  block.rays = key.rays;
  block.row_offsets = {0, 2, 2};
  block.column = {0, static_cast<std::uint32_t>(key.columns - 1)};
  block.count = {first + 1, key.rays - first - 1};
  return block;
}

constexpr RayTally kTally{.hits = 100, .back_face = 60, .escaped = 40};

void append_blocks(BakeJournal& journal, const JournalKey& key, std::uint32_t blocks) {
  for (std::uint32_t i = 0; i < blocks; ++i) {
    const auto first = static_cast<std::uint32_t>(journal.next_row());
    journal.append(first, block_of(key, first), kTally);
  }
}

void expect_holds(const BakeJournal& journal, const JournalKey& key, std::uint32_t blocks) {
  EXPECT_EQ(journal.next_row(), 2 * blocks);
  EXPECT_EQ(journal.nonzeros(), 2 * blocks);
  EXPECT_EQ(journal.tally().back_face, 60 * blocks);
  std::uint32_t first = 0;
  journal.for_each_block([&](const SparseCounts& block) {
    const SparseCounts expected = block_of(key, first);
    EXPECT_EQ(block.columns, expected.columns);
    EXPECT_EQ(block.rays, expected.rays);
    EXPECT_EQ(block.row_offsets, expected.row_offsets);
    EXPECT_EQ(block.column, expected.column);
    EXPECT_EQ(block.count, expected.count);
    first += 2;
  });
  EXPECT_EQ(first, 2 * blocks);
}

class Journal : public testing::Test {
 protected:
  /// Leaves a journal of that many blocks, as a killed process would.
  void leave(std::uint32_t blocks, const JournalKey& key = kKey) {
    BakeJournal journal(file_, key, false);
    append_blocks(journal, key, blocks);
  }
  std::string resume_error(const JournalKey& key) {
    return file_error([&] { BakeJournal(file_, key, true); });
  }

  TemporaryFolder folder_;
  fs::path file_ = folder_ / "scene.h5.partial";
};

TEST_F(Journal, LiesBesideItsStore) {
  EXPECT_EQ(BakeJournal::path_for(folder_ / "scene.h5"), file_);
}

TEST_F(Journal, GivesBackItsBlocks) {
  BakeJournal journal(file_, kKey, false);
  append_blocks(journal, kKey, 5);
  expect_holds(journal, kKey, 5);
  EXPECT_EQ(journal.largest_count(), 99U);
  journal.remove();
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(Journal, ResumesAfterItsLastBlock) {
  leave(2);
  BakeJournal journal(file_, kKey, true);
  expect_holds(journal, kKey, 2);
  append_blocks(journal, kKey, 3);
  expect_holds(journal, kKey, 5);
}

TEST_F(Journal, ResumesNothingFromNothing) {
  expect_holds(BakeJournal(file_, kKey, true), kKey, 0);
  put_bytes(file_, "REL");  // killed in its first write
  expect_holds(BakeJournal(file_, kKey, true), kKey, 0);
}

TEST_F(Journal, StartsAnewUnlessAskedToResume) {
  leave(3);
  expect_holds(BakeJournal(file_, kKey, false), kKey, 0);
}

TEST_F(Journal, KeepsWideColumnsAndCounts) {
  const JournalKey wide{.hash = 1, .rows = 10, .columns = 70000, .rays = 1000000};
  leave(3, wide);
  const BakeJournal journal(file_, wide, true);
  expect_holds(journal, wide, 3);
  EXPECT_EQ(journal.largest_count(), 999999U);
}

TEST_F(Journal, CutAnywhereKeepsTheWholeBlocksBefore) {
  leave(1);
  const std::size_t one = fs::file_size(file_);
  leave(0);
  const std::size_t none = fs::file_size(file_);
  leave(3);
  const std::string bytes = bytes_of(file_);
  for (std::size_t length = none; length < bytes.size(); ++length) {
    put_bytes(file_, bytes.substr(0, length));
    const auto whole = static_cast<std::uint32_t>((length - none) / (one - none));
    BakeJournal journal(file_, kKey, true);
    expect_holds(journal, kKey, whole);
    append_blocks(journal, kKey, 3 - whole);
    EXPECT_EQ(bytes_of(file_), bytes) << length;
  }
}

TEST_F(Journal, FlippedByteKeepsTheWholeBlocksBefore) {
  leave(0);
  const std::size_t none = fs::file_size(file_);
  leave(1);
  const std::size_t one = fs::file_size(file_);
  leave(3);
  const std::string bytes = bytes_of(file_);
  for (std::size_t i = none; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ (1 << i % 8));
    put_bytes(file_, damaged);
    const auto whole = static_cast<std::uint32_t>((i - none) / (one - none));
    expect_holds(BakeJournal(file_, kKey, true), kKey, whole);
  }
}

TEST_F(Journal, RefusesDamagedHeaders) {
  leave(1);
  const std::string bytes = bytes_of(file_);
  for (std::size_t i = 0; i < 56; ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    put_bytes(file_, damaged);
    EXPECT_THAT(resume_error(kKey), HasSubstr(file_.string())) << i;
    EXPECT_EQ(bytes_of(file_), damaged);
  }
}

TEST_F(Journal, RefusesWhatIsNoJournal) {
  put_bytes(file_, std::string(100, 'x'));
  EXPECT_THAT(resume_error(kKey), HasSubstr("is not the journal of a bake"));
  EXPECT_EQ(fs::file_size(file_), 100U);
}

TEST_F(Journal, RefusesAnotherSceneOrOtherSettings) {
  leave(2);
  for (const JournalKey& other :
       {JournalKey{.hash = 1, .rows = 10, .columns = 7, .rays = 100},
        JournalKey{.hash = 0x1234, .rows = 9, .columns = 7, .rays = 100},
        JournalKey{.hash = 0x1234, .rows = 10, .columns = 8, .rays = 100},
        JournalKey{.hash = 0x1234, .rows = 10, .columns = 7, .rays = 99}}) {
    EXPECT_THAT(resume_error(other), HasSubstr("is of another scene or other settings"));
  }
  expect_holds(BakeJournal(file_, kKey, true), kKey, 2);
}

TEST_F(Journal, ServesOneBakeAtATime) {
  const BakeJournal journal(file_, kKey, false);
  EXPECT_THAT(resume_error(kKey), HasSubstr("is in use by another bake"));
  EXPECT_THAT(file_error([&] { BakeJournal(file_, kKey, false); }),
              HasSubstr("is in use by another bake"));
}

TEST_F(Journal, FullDiskKeepsWhatIsFinished) {
  leave(2);
  {
    BakeJournal journal(file_, kKey, true);
    const FullDisk disk(fs::file_size(file_) + 40);
    EXPECT_THAT(file_error([&] { append_blocks(journal, kKey, 1); }),
                AllOf(HasSubstr(file_.string()), HasSubstr("File too large"),
                      HasSubstr("4 of 10 rows are kept")));
  }
  BakeJournal journal(file_, kKey, true);
  expect_holds(journal, kKey, 2);
  append_blocks(journal, kKey, 3);
  expect_holds(journal, kKey, 5);
}

TEST_F(Journal, NamesAFolderThatIsNotThere) {
  const fs::path nowhere = folder_ / "nowhere" / "a.partial";
  EXPECT_THAT(file_error([&] { BakeJournal(nowhere, kKey, false); }), HasSubstr(nowhere.string()));
}

}  // namespace
}  // namespace relumbre
