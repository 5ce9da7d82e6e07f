#include "relumbre/image/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Image, PlanesAreNamedZeroAndRowMajor) {
  const std::vector<std::string> names = {"R", "G", "B", "Z"};
  Image image(3, 2, names);
  EXPECT_EQ(image.pixels(), 6);
  ASSERT_EQ(image.channels().size(), 4);
  EXPECT_THAT(image.channel("Z"), Each(0.0F));
  image.set_rgb(4, {1, 2, 3});
  EXPECT_EQ(image.channel("G")[1 * 3 + 1], 2);
  EXPECT_EQ(image.rgb(4), (Rgb{1, 2, 3}));
}

TEST(Image, AddKeepsAPlaneThatIsThere) {
  Image image = rgb_image(2, 2);
  image.set_rgb(0, {1, 2, 3});
  EXPECT_EQ(image.add("G")[0], 2);
  EXPECT_EQ(image.channels().size(), 3);
  EXPECT_EQ(image.add("albedo.R").size(), 4);
  EXPECT_TRUE(image.has("albedo.R"));
  EXPECT_EQ(image.rgb(0), (Rgb{1, 2, 3}));
}

TEST(Image, MissingChannelIsNamed) {
  const std::vector<std::string> names = {"R", "G"};
  Image image(1, 1, names);
  EXPECT_FALSE(image.has_rgb());
  EXPECT_THAT([&] { (void)image.channel("Z"); }, ThrowsMessage<ValueError>(HasSubstr("'Z'")));
  EXPECT_THAT([&] { (void)image.rgb(0); }, ThrowsMessage<ValueError>(HasSubstr("'B'")));
  EXPECT_THROW(image.set_rgb(0, {}), ValueError);
  image.add("B");
  EXPECT_TRUE(image.has_rgb());
}

TEST(Image, EmptyAndAbsurdSizesAreRefused) {
  EXPECT_THROW(rgb_image(0, 5), ValueError);
  EXPECT_THROW(rgb_image(5, 0), ValueError);
  EXPECT_THROW(rgb_image(std::size_t{1} << 17, std::size_t{1} << 16), ValueError);
  EXPECT_THROW(rgb_image(std::size_t{1} << 32, std::size_t{1} << 32), ValueError);
  EXPECT_THROW(Image().add("R"), ValueError);
}

}  // namespace
}  // namespace relumbre
