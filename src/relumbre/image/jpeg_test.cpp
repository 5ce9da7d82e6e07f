#include "relumbre/image/jpeg.h"

#include <cstdio>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Encoding {
  J_COLOR_SPACE space = JCS_RGB;
  int components = 3;
  bool progressive = false;
};

/// A smooth picture, so that JPEG keeps it nearly.
std::vector<std::uint8_t> gradient(std::uint32_t width, std::uint32_t height, int components) {
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      for (int c = 0; c < components; ++c) {
        pixels.push_back(static_cast<std::uint8_t>(40 + 2 * x + 3 * y));
      }
    }
  }
  return pixels;
}

std::string encode(std::uint32_t width, std::uint32_t height, const Encoding& encoding) {
  std::vector<std::uint8_t> pixels = gradient(width, height, encoding.components);
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &out, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = encoding.components;
  jpeg.in_color_space = encoding.space;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 98, TRUE);
  if (encoding.progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  const std::size_t stride = pixels.size() / height;
  for (std::uint32_t y = 0; y < height; ++y) {
    JSAMPROW row = pixels.data() + y * stride;
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string bytes(reinterpret_cast<char*>(out), size);
  std::free(out);
  return bytes;
}

void expect_gradient(const std::string& bytes, std::uint32_t width, std::uint32_t height) {
  const Raster raster = decode_jpeg(bytes, "a.jpg");
  EXPECT_EQ(raster.width, width);
  EXPECT_EQ(raster.height, height);
  const auto exact = gradient(width, height, 3);
  ASSERT_EQ(raster.rgb.size(), exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(raster.rgb[i], exact[i], 6);
}

TEST(Jpeg, ColourGreyAndProgressiveDecodeToNearlyTheSource) {
  for (const std::uint32_t width : {1U, 8U, 17U, 40U}) {
    for (const std::uint32_t height : {1U, 16U, 23U}) {
      expect_gradient(encode(width, height, {}), width, height);
      expect_gradient(encode(width, height, {.progressive = true}), width, height);
      expect_gradient(encode(width, height, {JCS_GRAYSCALE, 1}), width, height);
    }
  }
}

void expect_refused(std::string_view bytes, const std::string& reason) {
  EXPECT_THAT([&] { (void)decode_jpeg(bytes, "bad.jpg"); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("bad.jpg: "), HasSubstr(reason))));
}

TEST(Jpeg, CmykEmptyAndForeignAreRefused) {
  expect_refused(encode(8, 8, {JCS_CMYK, 4}), "unsupported");
  expect_refused("", "is empty");
  expect_refused("GIF89a", "is not a JPEG");
  expect_refused("\xFF\xD8\xFF", "damaged");
}

TEST(Jpeg, EveryTruncationIsRefused) {
  for (const bool progressive : {false, true}) {
    const std::string whole = encode(40, 23, {.progressive = progressive});
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
      EXPECT_THROW((void)decode_jpeg(std::string_view(whole).substr(0, size), "cut"), FileError)
          << size;
    }
  }
}

TEST(Jpeg, FlippedBytesGiveAPictureOrAFileError) {
  for (const bool progressive : {false, true}) {
    const std::string whole = encode(40, 23, {.progressive = progressive});
    RandomStream random(9);
    for (int i = 0; i < 1500; ++i) {
      std::string bytes = whole;
      for (int k = 0; k < 1 + i % 4; ++k) {
        bytes[3 + random.bits() % (bytes.size() - 3)] = static_cast<char>(random.bits());
      }
      try {
        EXPECT_EQ(decode_jpeg(bytes, "flipped").rgb.size() % 3, 0);
      } catch (const FileError&) {
      }
    }
  }
}

TEST(Jpeg, AbsurdSizesAreRefusedBeforeAllocating) {
  std::string bytes = encode(8, 8, {});
  const std::size_t frame = bytes.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  bytes.replace(frame + 5, 4, "\xFF\x00\xFF\x00", 4);
  expect_refused(bytes, "more than this reader takes");
  bytes.replace(frame + 5, 4, "\x3F\x00\x3F\x00", 4);
  expect_refused(bytes, "more than its");
}

TEST(Jpeg, EndlessScansAreRefused) {
  const std::string whole = encode(16, 16, {.progressive = true});
  const std::size_t first = whole.find("\xFF\xDA"), next = whole.find("\xFF\xC4", first);
  ASSERT_NE(next, std::string::npos);
  std::string bytes = whole.substr(0, next);
  for (int i = 0; i < 500; ++i) bytes += whole.substr(first, next - first);
  expect_refused(bytes + whole.substr(next), "more than 100 scans");
}

}  // namespace
}  // namespace relumbre
