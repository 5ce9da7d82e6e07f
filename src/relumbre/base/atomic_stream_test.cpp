#include "relumbre/base/atomic_stream.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

TEST(AtomicStream, PiecesFollowEachOtherAndAHeaderMayComeLast) {
  const TemporaryFolder folder;
  AtomicStream out(folder / "file.bin");
  out.write("0000");
  out.write("one ");
  out.write(std::as_bytes(std::span("two", 3)));
  out.seek(0);
  out.write("head");
  EXPECT_FALSE(std::filesystem::exists(folder / "file.bin"));
  out.commit();
  EXPECT_EQ(read_file(folder / "file.bin"), "headone two");
}

TEST(AtomicStream, WithoutCommitTheOldFileStays) {
  const TemporaryFolder folder;
  write_file(folder / "file.bin", "old");
  {
    AtomicStream out(folder / "file.bin");
    out.write("new");
  }
  EXPECT_EQ(read_file(folder / "file.bin"), "old");
  EXPECT_THROW(AtomicStream(folder / "none" / "file.bin"), FileError);
}

}  // namespace
}  // namespace relumbre
