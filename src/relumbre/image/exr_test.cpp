#include "relumbre/image/exr.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/base/temporary_folder.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr float kInf = std::numeric_limits<float>::infinity();

Image noise(std::size_t width, std::size_t height, std::span<const std::string> names) {
  Image image(width, height, names);
  RandomStream random(width * 1000 + height);
  for (const Image::Channel& channel : image.channels()) {
    for (float& v : image.channel(channel.name)) v = random.uniform() * 100 - 20;
  }
  return image;
}

const std::vector<std::string> kLayers = {"A", "B", "G", "N.X", "R", "Z"};

/// Values of a plane counted up from 0, with the window's corner first.
struct Ramp {
  Imath::Box2i window;
  std::vector<float> values;

  Ramp(int x, int y, int width, int height)
      : window({x, y}, {x + width - 1, y + height - 1}),
        values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  }
  [[nodiscard]] Imf::Header header() const {
    Imf::Header h(Imath::Box2i({0, 0}, {99, 99}), window);
    h.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    return h;
  }
  [[nodiscard]] Imf::FrameBuffer buffer() const {
    Imf::FrameBuffer b;
    b.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), window));
    return b;
  }
};

void expect_ramp(const fs::path& file, const Ramp& ramp) {
  const Image image = read_exr(file);
  EXPECT_EQ(image.width(), static_cast<std::size_t>(ramp.window.max.x - ramp.window.min.x + 1));
  EXPECT_THAT(image.channel("Y"), ElementsAreArray(ramp.values));
}

TEST(Exr, FloatRoundTripIsBitExact) {
  const TemporaryFolder folder;
  for (const std::size_t width : {1UL, 2UL, 17UL, 131UL}) {
    for (const std::size_t height : {1UL, 15UL, 16UL, 33UL}) {
      Image image = noise(width, height, kLayers);
      image.channel("Z")[0] = kInf;
      image.channel("A")[0] = std::numeric_limits<float>::quiet_NaN();
      write_exr(folder / "a.exr", image);
      const Image read = read_exr(folder / "a.exr");
      ASSERT_EQ(read.channels().size(), kLayers.size());
      for (const Image::Channel& channel : image.channels()) {
        const std::span<const float> got = read.channel(channel.name);
        EXPECT_TRUE(
            std::equal(got.begin(), got.end(), channel.values.begin(), [](float a, float b) {
              return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
            }));
      }
    }
  }
}

TEST(Exr, HalfChannelsKeepElevenBitsAndTheOthersAll) {
  const TemporaryFolder folder;
  Image image = noise(40, 30, kLayers);
  image.channel("R")[0] = 1e6F;
  write_exr(folder / "a.exr", image, {.half_channels = {"R", "G", "B"}});
  const Image read = read_exr(folder / "a.exr");
  EXPECT_EQ(read.channel("R")[0], kInf);
  for (std::size_t i = 1; i < image.pixels(); ++i) {
    const float exact = image.channel("R")[i];
    EXPECT_NEAR(read.channel("R")[i], exact, std::abs(exact) / 2048 + 1e-7);
  }
  EXPECT_THAT(read.channel("Z"), ElementsAreArray(image.channel("Z")));
  write_exr(folder / "b.exr", image);
  EXPECT_LT(fs::file_size(folder / "a.exr"), fs::file_size(folder / "b.exr"));
}

TEST(Exr, UnknownHalfChannelAndNoChannelAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_exr(folder / "a.exr", rgb_image(2, 2), {.half_channels = {"Q"}}), ValueError);
  EXPECT_THROW(write_exr(folder / "a.exr", Image()), ValueError);
  EXPECT_FALSE(fs::exists(folder / "a.exr"));
}

TEST(Exr, DataWindowOffsetIsHandled) {
  const TemporaryFolder folder;
  for (const auto& [x, y] : {std::pair{0, 0}, {5, 3}, {-7, -1000}, {100000, 200000}}) {
    const Ramp ramp(x, y, 23, 37);
    {
      Imf::OutputFile file((folder / "a.exr").c_str(), ramp.header());
      file.setFrameBuffer(ramp.buffer());
      file.writePixels(37);
    }
    expect_ramp(folder / "a.exr", ramp);
  }
}

TEST(Exr, TilesAndMipmapsGiveTheFullResolution) {
  const TemporaryFolder folder;
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
    const Ramp ramp(-3, 4, 50, 41);
    {
      Imf::Header header = ramp.header();
      header.setTileDescription(Imf::TileDescription(16, 8, mode));
      Imf::TiledOutputFile file((folder / "a.exr").c_str(), header);
      file.setFrameBuffer(ramp.buffer());  // the smaller levels' windows lie inside this one
      for (int level = 0; level < file.numLevels(); ++level) {
        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
      }
    }
    expect_ramp(folder / "a.exr", ramp);
  }
}

TEST(Exr, MultiPartFileGivesPartZero) {
  const TemporaryFolder folder;
  const Ramp first(0, 0, 20, 10), second(0, 0, 5, 5);
  {
    std::array<Imf::Header, 2> headers = {first.header(), second.header()};
    for (std::size_t i = 0; i < 2; ++i) {
      headers[i].setName(i == 0 ? "one" : "two");
      headers[i].setType(Imf::SCANLINEIMAGE);
    }
    Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 2);
    Imf::OutputPart one(file, 0), two(file, 1);
    one.setFrameBuffer(first.buffer());
    one.writePixels(10);
    two.setFrameBuffer(second.buffer());
    two.writePixels(5);
  }
  expect_ramp(folder / "a.exr", first);
}

TEST(Exr, DeepImageIsRefusedByName) {
  const TemporaryFolder folder;
  {
    Imf::Header header(4, 4);
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    const Imf::DeepScanLineOutputFile file((folder / "a.exr").c_str(), header);
  }
  EXPECT_THAT([&] { (void)read_exr(folder / "a.exr"); },
              ThrowsMessage<FileError>(HasSubstr("a.exr: is a deep image")));
}

TEST(Exr, UintChannelsBecomeFloat) {
  const TemporaryFolder folder;
  const std::vector<std::uint32_t> ids = {0, 1, 70000, 16777216};
  {
    Imf::Header header(2, 2);
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    Imf::FrameBuffer buffer;
    buffer.insert("id", Imf::Slice::Make(Imf::UINT, ids.data(), header.dataWindow()));
    Imf::OutputFile file((folder / "a.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  EXPECT_THAT(read_exr(folder / "a.exr").channel("id"), ElementsAreArray(ids));
}

TEST(Exr, SubsampledChannelIsRefusedByName) {
  const TemporaryFolder folder;
  const Ramp ramp(0, 0, 8, 8);
  {
    Imf::Header header = ramp.header();
    header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
    Imf::OutputFile file((folder / "a.exr").c_str(), header);
    file.setFrameBuffer(ramp.buffer());
    file.writePixels(8);
  }
  EXPECT_THAT([&] { (void)read_exr(folder / "a.exr"); },
              ThrowsMessage<FileError>(HasSubstr("subsampled channel 'RY'")));
}

/// A constant image is what packs densest: the size bound must let it pass.
TEST(Exr, EveryCompressionOfAConstantImageIsRead) {
  const TemporaryFolder folder;
  const int side = 1024;
  const std::vector<float> row(static_cast<std::size_t>(side));
  for (int c = 0; c < Imf::NUM_COMPRESSION_METHODS; ++c) {
    {
      Imf::Header header(side, side);
      header.compression() = static_cast<Imf::Compression>(c);
      header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
      Imf::FrameBuffer buffer;
      char* start = const_cast<char*>(reinterpret_cast<const char*>(row.data()));
      buffer.insert("Y", Imf::Slice(Imf::FLOAT, start, sizeof(float), 0));
      Imf::OutputFile file((folder / "a.exr").c_str(), header);
      file.setFrameBuffer(buffer);
      file.writePixels(side);
    }
    RecordProperty("bytes_" + std::to_string(c), std::to_string(fs::file_size(folder / "a.exr")));
    EXPECT_NO_THROW((void)read_exr(folder / "a.exr")) << "compression " << c;
  }
}

void expect_refused(std::string_view bytes, const std::string& reason) {
  EXPECT_THAT([&] { (void)parse_exr(bytes, "bad.exr"); },
              ThrowsMessage<FileError>(AllOf(HasSubstr("bad.exr: "), HasSubstr(reason))));
}

TEST(Exr, MissingEmptyAndForeignFilesAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { (void)read_exr(folder / "none.exr"); },
              ThrowsMessage<FileError>(HasSubstr("none.exr: no such file")));
  expect_refused("", "is empty");
  expect_refused(std::string(1000, 'x'), "is not an OpenEXR image");
  expect_refused("\x76\x2F\x31\x01", "damaged");
  expect_refused("\x76\x2F\x31\x01" + std::string(1000, '\xFF'), "damaged");
}

std::string small_file(const TemporaryFolder& folder) {
  write_exr(folder / "small.exr", noise(9, 20, kLayers), {.half_channels = {"A"}});
  return read_file(folder / "small.exr");
}

TEST(Exr, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = small_file(folder);
  EXPECT_NO_THROW((void)parse_exr(whole, "whole"));
  for (std::size_t size = 0; size < whole.size(); size += size < 600 ? 1 : 41) {
    EXPECT_THROW((void)parse_exr(std::string_view(whole).substr(0, size), "cut"), FileError)
        << size;
  }
}

TEST(Exr, FlippedBytesGiveAnImageOrAFileError) {
  const TemporaryFolder folder;
  const std::string whole = small_file(folder);
  RandomStream random(5);
  for (int i = 0; i < 1000; ++i) {
    std::string bytes = whole;
    const std::size_t range = i % 2 == 0 ? 600 : bytes.size();  // headers matter most
    for (int k = 0; k < 1 + i % 4; ++k) {
      bytes[4 + random.bits() % (range - 4)] = static_cast<char>(random.bits());
    }
    try {
      (void)parse_exr(bytes, "flipped");
    } catch (const FileError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

/// The file with the maximum corner of its data window overwritten.
std::string with_window(std::string bytes, std::int32_t max_x, std::int32_t max_y) {
  const std::size_t at = bytes.find(std::string("dataWindow\0box2i\0", 17)) + 17 + 4 + 8;
  std::memcpy(bytes.data() + at, &max_x, 4);
  std::memcpy(bytes.data() + at + 4, &max_y, 4);
  return bytes;
}

TEST(Exr, AbsurdSizesAreRefusedBeforeAllocating) {
  const TemporaryFolder folder;
  const std::string whole = small_file(folder);
  EXPECT_NO_THROW((void)parse_exr(with_window(whole, 8, 19), "same"));
  for (const auto& [x, y] : {std::pair{1 << 29, 19},
                             {8, 1 << 29},
                             {20000, 20000},
                             {1 << 20, 1 << 20},
                             {0x7FFFFFFF, 0x7FFFFFFF},
                             {-5, -5}}) {
    EXPECT_THROW((void)parse_exr(with_window(whole, x, y), "huge"), FileError) << x << " " << y;
  }
  expect_refused(with_window(whole, 40000, 4000), "more than its");
}

TEST(Exr, UnwritableTargetsAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { write_exr(folder / "none/a.exr", rgb_image(2, 2)); },
              ThrowsMessage<FileError>(HasSubstr("none/a.exr: ")));
  EXPECT_THROW(write_exr(folder.path(), rgb_image(2, 2)), FileError);
}

TEST(Exr, ImpossibleChannelNameLeavesNoFile) {
  const TemporaryFolder folder;
  Image image = rgb_image(2, 2);
  image.add("");
  EXPECT_THROW(write_exr(folder / "a.exr", image), FileError);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

fs::path data_file(const std::string& name) {
  const char* set = std::getenv("RELUMBRE_DATA");
  const fs::path root = fs::path(__FILE__).parent_path() / "../../..";
  return (set != nullptr ? fs::path(set) : root / "../shared/data") / "images" / name;
}

TEST(Exr, ReadsRealColourAndDepth) {
  const fs::path file = data_file("beachball_rgbaz.exr");
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  const Image image = read_exr(file);
  EXPECT_EQ(image.width(), 911);
  EXPECT_EQ(image.height(), 876);
  for (const char* name : {"R", "G", "B", "A", "Z"}) EXPECT_TRUE(image.has(name)) << name;
  const std::span<const float> depth = image.channel("Z");
  EXPECT_GT(*std::max_element(depth.begin(), depth.end()), 0);
}

TEST(Exr, RealEnvironmentSurvivesARoundTrip) {
  const fs::path file = data_file("KernerEnvLatLong.exr");
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  const Image image = read_exr(file);
  EXPECT_EQ(image.width(), 1024);
  EXPECT_EQ(image.height(), 512);
  ASSERT_TRUE(image.has_rgb());
  const TemporaryFolder folder;
  write_exr(folder / "a.exr", image, {.half_channels = {"R", "G", "B"}});  // as it is stored
  const Image again = read_exr(folder / "a.exr");
  for (std::size_t i = 0; i < image.pixels(); ++i) ASSERT_EQ(again.rgb(i), image.rgb(i));
}

}  // namespace
}  // namespace relumbre
