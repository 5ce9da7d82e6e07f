#include "relumbre/image/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Bytes = std::vector<std::uint8_t>;

Bytes noise(std::size_t count) {
  Bytes bytes(count);
  RandomStream random(count);
  for (auto& b : bytes) b = static_cast<std::uint8_t>(random.bits());
  return bytes;
}

/// A PNG of one row, of any depth and colour type, without gamma.
std::string one_row(int depth, int type, png_uint_32 width, Bytes row,
                    std::vector<png_color> palette = {}) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  const auto append = [](png_structp p, png_bytep data, std::size_t size) {
    static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), size);
  };
  png_set_write_fn(png, &out, append, nullptr);
  png_set_IHDR(png, info, width, 1, depth, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_write_info(png, info);
  png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

TEST(Png, RoundTripIsExact) {
  const TemporaryFolder folder;
  for (const std::uint32_t width : {1U, 2U, 13U, 257U}) {
    for (const std::uint32_t height : {1U, 7U, 64U}) {
      const Bytes rgb = noise(std::size_t{width} * height * 3);
      write_png(folder / "a.png", rgb, width, height);
      const Raster read = read_png(folder / "a.png");
      EXPECT_EQ(read.width, width);
      EXPECT_EQ(read.height, height);
      EXPECT_EQ(read.rgb, rgb);
    }
  }
}

TEST(Png, GreyBecomesEqualChannels) {
  EXPECT_THAT(decode_png(one_row(8, PNG_COLOR_TYPE_GRAY, 2, {10, 200}), "a").rgb,
              ElementsAre(10, 10, 10, 200, 200, 200));
}

TEST(Png, OneBitGreyIsBlackAndWhite) {
  EXPECT_THAT(decode_png(one_row(1, PNG_COLOR_TYPE_GRAY, 2, {0b01000000}), "a").rgb,
              ElementsAre(0, 0, 0, 255, 255, 255));
}

TEST(Png, PaletteIsExpanded) {
  EXPECT_THAT(
      decode_png(one_row(8, PNG_COLOR_TYPE_PALETTE, 2, {1, 0}, {{1, 2, 3}, {4, 5, 6}}), "a").rgb,
      ElementsAre(4, 5, 6, 1, 2, 3));
}

TEST(Png, AlphaIsDroppedAndColourKept) {
  EXPECT_THAT(decode_png(one_row(8, PNG_COLOR_TYPE_RGBA, 2, {9, 8, 7, 0, 6, 5, 4, 128}), "a").rgb,
              ElementsAre(9, 8, 7, 6, 5, 4));
  EXPECT_THAT(decode_png(one_row(8, PNG_COLOR_TYPE_GRAY_ALPHA, 1, {9, 3}), "a").rgb,
              ElementsAre(9, 9, 9));
}

TEST(Png, SixteenBitsAreRoundedNotTakenAsLinear) {
  const Bytes row = {0x12, 0x12, 0x80, 0x80, 0xFE, 0xFE};
  EXPECT_THAT(decode_png(one_row(16, PNG_COLOR_TYPE_RGB, 1, row), "a").rgb,
              ElementsAre(0x12, 0x80, 0xFE));
}

TEST(Png, SizesMustAgree) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_png(folder / "a.png", Bytes(11), 2, 2), ShapeError);
  EXPECT_THROW(write_png(folder / "a.png", Bytes(), 0, 2), ShapeError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

TEST(Png, UnwritableTargetsAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { write_png(folder / "none/a.png", Bytes(12), 2, 2); },
              ThrowsMessage<FileError>(HasSubstr("none/a.png: ")));
}

void expect_refused(std::string_view bytes, const std::string& reason) {
  EXPECT_THAT([&] { (void)decode_png(bytes, "bad.png"); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("bad.png: "), HasSubstr(reason))));
}

std::string small_file() {
  const TemporaryFolder folder;
  write_png(folder / "a.png", noise(23 * 9 * 3), 23, 9);
  return read_file(folder / "a.png");
}

TEST(Png, MissingEmptyAndForeignFilesAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { (void)read_png(folder / "none.png"); },
              ThrowsMessage<FileError>(HasSubstr("none.png: no such file")));
  expect_refused("", "is empty");
  expect_refused("GIF89a", "is not a PNG");
  expect_refused(small_file().substr(0, 8), "damaged");
}

TEST(Png, EveryTruncationOfThePictureIsRefused) {
  const std::string whole = small_file();
  const std::size_t data_end = whole.size() - 12;  // the empty IEND chunk may be missing
  for (std::size_t size = 0; size + 8 < data_end; ++size) {
    EXPECT_THROW((void)decode_png(std::string_view(whole).substr(0, size), "cut"), FileError)
        << size;
  }
}

TEST(Png, FlippedBytesGiveAPictureOrAFileError) {
  const std::string whole = small_file();
  RandomStream random(3);
  for (int i = 0; i < 5000; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 1 + i % 4; ++k) {
      bytes[8 + random.bits() % (bytes.size() - 8)] = static_cast<char>(random.bits());
    }
    try {
      EXPECT_EQ(decode_png(bytes, "flipped").rgb.size() % 3, 0);
    } catch (const FileError&) {
    }
  }
}

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::string big_endian(std::uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
          static_cast<char>(v)};
}

/// The file with another width and height in its header, and a checksum that fits.
std::string with_size(std::string bytes, std::uint32_t width, std::uint32_t height) {
  bytes.replace(16, 8, big_endian(width) + big_endian(height));
  return bytes.replace(29, 4, big_endian(crc32(std::string_view(bytes).substr(12, 17))));
}

TEST(Png, AbsurdSizesAreRefusedBeforeAllocating) {
  const std::string whole = small_file();
  EXPECT_NO_THROW((void)decode_png(with_size(whole, 23, 9), "same"));
  expect_refused(with_size(whole, 100000, 100000), "more than this reader takes");
  expect_refused(with_size(whole, 16000, 16000), "more than its");
  expect_refused(with_size(whole, 0x7FFFFFFF, 0x7FFFFFFF), "damaged");
  expect_refused(with_size(whole, 0, 9), "damaged");
}

}  // namespace
}  // namespace relumbre
