#include "relumbre/base/atomic_file.h"

#include <csignal>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(AtomicFile, WriteThenReadGivesTheSameBytes) {
  const TemporaryFolder folder;
  for (const std::string& bytes :
       {std::string(), std::string("a\0b\n", 4), std::string(70000, 'x')}) {
    write_file(folder / "file.bin", bytes);
    EXPECT_EQ(read_file(folder / "file.bin"), bytes);
    EXPECT_EQ(entries(folder.path()), 1);
  }
}

TEST(AtomicFile, FollowsALink) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "far");
  write_file(folder / "far/file.txt", "old");
  fs::create_symlink(folder / "far/file.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_file(folder / "far/file.txt"), "new");
}

TEST(AtomicFile, APipeIsWrittenToAndStaysAPipe) {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  write_file(pipe, "through");
  char bytes[16] = {};
  EXPECT_EQ(::read(reader, bytes, sizeof bytes), 7);
  EXPECT_STREQ(bytes, "through");
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, WithoutCommitNothingIsLeftAndTheOldFileStays) {
  const TemporaryFolder folder;
  write_file(folder / "file.txt", "old");
  {
    const AtomicFile file(folder / "file.txt");
    EXPECT_EQ(file.path().extension(), ".txt");
    EXPECT_EQ(file.path().parent_path(), folder.path());
    std::ofstream(file.path()) << "half-written";
    EXPECT_EQ(read_file(folder / "file.txt"), "old");
  }
  EXPECT_EQ(read_file(folder / "file.txt"), "old");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, MissingFolderIsNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { AtomicFile(folder / "none/file.txt"); },
              ThrowsMessage<FileError>(HasSubstr("none/file.txt: the folder does not exist")));
}

TEST(AtomicFile, AFolderIsNoTarget) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { AtomicFile{folder.path()}; },
              ThrowsMessage<FileError>(HasSubstr("is a folder")));
}

TEST(AtomicFile, UnwritableFolderIsRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THROW(AtomicFile(folder / "file.txt"), FileError);
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST(AtomicFile, PseudoFolderThatTakesNoFilesIsRefused) {
  if (!fs::is_directory("/proc/self")) GTEST_SKIP() << "needs /proc";
  EXPECT_THAT([] { write_file("/proc/self/file.txt", "x"); },
              ThrowsMessage<FileError>(HasSubstr("/proc/self/file.txt: ")));
}

TEST(AtomicFile, AFullDiskLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  write_file(folder / "file.txt", "old");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);  // so that write() fails with an error
  const rlimit small{1000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_file(folder / "file.txt", std::string(100000, 'x')), FileError);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(read_file(folder / "file.txt"), "old");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ReadFile, RefusesMissingFoldersAndTooLarge) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { (void)read_file(folder / "none"); },
              ThrowsMessage<FileError>(HasSubstr("none: no such file")));
  EXPECT_THAT([&] { (void)read_file(folder.path()); },
              ThrowsMessage<FileError>(HasSubstr("not a regular file")));
  write_file(folder / "ten", "0123456789");
  EXPECT_THAT([&] { (void)read_file(folder / "ten", 9); },
              ThrowsMessage<FileError>(HasSubstr("has 10 bytes")));
  EXPECT_EQ(read_file(folder / "ten", 10).size(), 10);
}

}  // namespace
}  // namespace relumbre
