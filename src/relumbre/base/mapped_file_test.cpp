#include "relumbre/base/mapped_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

class MappedFileTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                  testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(MappedFileTest, HasTheFilesBytes) {
  for (const std::size_t size : {1UL, 4095UL, 4096UL, 4097UL, 100'000UL}) {
    std::string text(size, 0);
    for (std::size_t i = 0; i < size; ++i) text[i] = static_cast<char>(i * 7);
    const MappedFile file(write("bytes", text));
    ASSERT_EQ(file.bytes().size(), size);
    EXPECT_TRUE(std::ranges::equal(file.bytes(), std::as_bytes(std::span(text))));
  }
}

TEST_F(MappedFileTest, AnEmptyFileHasNoBytes) {
  EXPECT_TRUE(MappedFile(write("empty", "")).bytes().empty());
}

TEST_F(MappedFileTest, OutlivesTheFilesName) {
  const auto name = write("gone", "still here");
  const MappedFile file(name);
  std::filesystem::remove(name);
  EXPECT_EQ(static_cast<char>(file.bytes()[9]), 'e');
}

TEST_F(MappedFileTest, WhatIsNoRegularFileIsRefusedByName) {
  for (const std::filesystem::path& bad : {folder_ / "missing", folder_}) {
    try {
      const MappedFile file(bad);
      ADD_FAILURE() << bad;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(bad.string()), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace relumbre
