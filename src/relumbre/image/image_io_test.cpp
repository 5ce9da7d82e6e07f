#include "relumbre/image/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/image/png.h"

namespace relumbre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(ImageIo, BytesSurviveLoadingAndSavingWithoutACurve) {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> rgb(16 * 16 * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<std::uint8_t>(i);
  write_png(folder / "a.png", rgb, 16, 16);
  const Image image = load_image(folder / "a.png");
  save_image(folder / "b.PNG", image, {.curve = ToneCurve::kSrgb});
  EXPECT_EQ(read_png(folder / "b.PNG").rgb, rgb);
}

TEST(ImageIo, PngIsDecodedToLinear) {
  const Image image = linear_image({1, 1, {0, 255, 188}});
  EXPECT_EQ(image.rgb(0).x, 0);
  EXPECT_EQ(image.rgb(0).y, 1);
  EXPECT_NEAR(image.rgb(0).z, 0.5029, 1e-4);
}

TEST(ImageIo, ExrKeepsAllChannelsAndIsNotToneMapped) {
  const TemporaryFolder folder;
  Image image = rgb_image(3, 2);
  image.set_rgb(2, {100, 0.001F, -2});
  image.add("Z")[4] = 7;
  save_image(folder / "a.exr", image, {.exposure_stops = 5});
  const Image read = load_image(folder / "a.exr");
  EXPECT_EQ(read.rgb(2), (Rgb{100, 0.001F, -2}));
  EXPECT_EQ(read.channel("Z")[4], 7);
}

TEST(ImageIo, TheKindIsToldByContentNotByName) {
  const TemporaryFolder folder;
  save_image(folder / "a.exr", rgb_image(3, 2));
  std::filesystem::rename(folder / "a.exr", folder / "a.png");
  EXPECT_EQ(load_image(folder / "a.png").width(), 3);
}

TEST(ImageIo, OtherKindsAreRefusedByName) {
  const TemporaryFolder folder;
  for (const char* name : {"a.jpg", "a", "a.exr.tiff", ".png"}) {
    EXPECT_FALSE(can_save_image(folder / name));
    EXPECT_THAT([&] { save_image(folder / name, rgb_image(2, 2)); },
                ThrowsMessage<FileError>(AllOf(HasSubstr(name), HasSubstr(".exr or .png"))));
  }
  write_file(folder / "a.exr", "GIF89a");
  EXPECT_THAT([&] { (void)load_image(folder / "a.exr"); },
              ThrowsMessage<FileError>(HasSubstr("a.exr: is not an EXR, PNG or JPEG image")));
  write_file(folder / "empty.png", "");
  EXPECT_THAT([&] { (void)load_image(folder / "empty.png"); },
              ThrowsMessage<FileError>(HasSubstr("empty.png: is empty")));
  EXPECT_THROW((void)load_image(folder / "none.png"), FileError);
  EXPECT_THROW((void)load_image(folder.path()), FileError);
}

TEST(ImageIo, PngWithoutColourIsRefused) {
  const TemporaryFolder folder;
  const std::vector<std::string> names = {"Z"};
  EXPECT_THROW(save_image(folder / "a.png", Image(2, 2, names)), ValueError);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

TEST(DecodeImage, RefusesWhatIsNeitherPngNorJpeg) {
  EXPECT_THAT([] { (void)decode_image("BM....", "a.bmp"); },
              ThrowsMessage<FileError>(HasSubstr("a.bmp: is neither a PNG nor a JPEG image")));
  EXPECT_THAT([] { (void)decode_image("", "a.bmp"); },
              ThrowsMessage<FileError>(HasSubstr("empty")));
}

}  // namespace
}  // namespace relumbre
