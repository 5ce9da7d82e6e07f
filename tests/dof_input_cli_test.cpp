// What `relumbre dof` reads and what it refuses.

#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include <ImfChannelList.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>

#include "dof_cli_fixture.h"

namespace relumbre {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

using DofInput = DofFixture;

TEST_F(DofInput, FilesWithoutWhatItNeedsAreRefused) {
  const Image whole = noise(17, 13);
  save("bad.exr", renamed(whole, {"R", "G", "B", "A"}));
  expect_refused("bad.exr", 1, {"bad.exr: no depth channel (Z); there are: A, B, G, R"});
  save("bad.exr", renamed(whole, {"Y", "N.X"}));
  expect_refused("bad.exr", 1, {"bad.exr: no channels R, G, B; there are: N.X, Y"});
  expect_refused("small.exr --color fog.", 1, {"small.exr: no channels fog.R"});
  expect_refused("small.exr --depth far", 1, {"small.exr: no channel far"});
  expect_refused("missing.exr", 1, {"missing.exr"});
  save_image(path("eight-bit.png"), whole);
  expect_refused("eight-bit.png", 1, {"eight-bit.png: no depth channel"});
}

TEST_F(DofInput, BadValuesAreRefusedWithTheirPixel) {
  for (const float bad : {std::nanf(""), -1.0F, -kInf}) {
    Image image = noise(17, 13);
    image.channel("Z")[6 * 17 + 4] = bad;
    save("bad.exr", image);
    expect_refused("bad.exr --focus-distance 3", 1, {"bad.exr: depth", "pixel 4,6"});
    image = noise(17, 13);
    image.channel("G")[6 * 17 + 4] = std::abs(bad) == 1 ? kInf : bad;
    save("bad.exr", image);
    expect_refused("bad.exr --focus-distance 3", 1, {"bad.exr: colour at pixel 4,6"});
  }
}

TEST_F(DofInput, NothingToFocusOnIsRefused) {
  Image image = noise(17, 13);
  std::ranges::fill(image.channel("Z"), kInf);
  save("bad.exr", image);
  expect_refused("bad.exr", 1, {"bad.exr: focus"});
  expect_refused("bad.exr --focus-pixel 3,4", 1, {"bad.exr: focus", "pixel 3,4"});
  expect_refused("small.exr --focus-pixel 37,0", 1, {"small.exr: focus", "pixel 37,0"});
  EXPECT_EQ(dof("bad.exr --focus-distance 3 -o a.exr"), 0) << read("err.txt");
}

TEST_F(DofInput, LensesThatAreNoneAreRefused) {
  expect_refused("small.exr --focus-distance 3 --f-number 0", 1, {"f-number is 0"});
  expect_refused("small.exr --f-number -2", 1, {"f-number is -2"});
  expect_refused("small.exr --f-number nan", 1, {"f-number"});
  expect_refused("small.exr --focus-distance 0.05", 1, {"not beyond the focal length of 50 mm"});
  expect_refused("small.exr --focus-distance 0.01", 1, {"not beyond the focal length of 50 mm"});
  expect_refused("small.exr --focus-distance nan", 1, {"focus distance"});
  expect_refused("small.exr --focal-length 20000", 1, {"not beyond the focal length"});
  expect_refused("small.exr --focal-length 0", 1, {"focal length is 0 mm"});
  expect_refused("small.exr --sensor-width 0", 1, {"sensor"});
  expect_refused("small.exr --blades 2", 1, {"2 blades"});
  expect_refused("small.exr --blades 5 --blade-rotation inf", 1, {"rotation"});
}

TEST_F(DofInput, OutputsThatCannotBeWrittenAreFoundFirst) {
  expect_refused("missing.exr", 1, {"a.jpg: cannot be written"}, "-o a.jpg");
  expect_refused("missing.exr", 1, {"a.jpg: cannot be written"}, "-o a.exr -o a.jpg");
  expect_refused("missing.exr", 1, {"b.tiff: cannot be written"}, "-o a.exr --overlay b.tiff");
  expect_refused("missing.exr", 1, {"none/a.exr: the folder does not exist"}, "-o none/a.exr");
  expect_refused("missing.exr", 1, {"none/a.png: the folder"}, "-o b.exr --overlay none/a.png");
  expect_refused("missing.exr", 1, {"small.exr/a.png"}, "-o small.exr/a.png");
}

TEST_F(DofInput, OptionsThatContradictAreMisuse) {
  for (const std::string shape : {"hexagon", "octagon", "box"})
    expect_refused("small.exr --blades 5 --shape " + shape, 2, {"--blades"});
  expect_refused("small.exr --focus-distance 5 --focus-pixel 1,1", 2, {"--focus"});
  expect_refused("small.exr --focus-pixel 1", 2, {"--focus-pixel"});
  expect_refused("small.exr --focus-pixel -1,3", 2, {"--focus-pixel"});
  expect_refused("small.exr --focus-pixel 1,3x", 2, {"--focus-pixel"});
  expect_refused("small.exr --method scatter", 2, {"--method"});
  expect_refused("small.exr --shape heart", 2, {"--shape"});
  expect_refused("small.exr --layers 0", 2, {"--layers"});
  expect_refused("small.exr --layers 257", 2, {"--layers"});
  expect_refused("small.exr --max-blur 0", 2, {"--max-blur"});
  expect_refused("small.exr --max-blur 5000", 2, {"--max-blur"});
  expect_refused("small.exr --max-blur nan", 2, {"--max-blur"});
  expect_refused("small.exr --vfov 60", 2, {"--radial"});
  expect_refused("small.exr --radial --vfov 180", 2, {"--vfov"});
  expect_refused("small.exr --exposure bright", 2, {"--exposure"});
  expect_refused("small.exr", 2, {"--output"}, "");
}

/// The planes of an image as OpenEXR wants them.
Imf::FrameBuffer frame_buffer(const Image& image, Imf::Header& header) {
  Imf::FrameBuffer buffer;
  for (const Image::Channel& channel : image.channels()) {
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
    buffer.insert(channel.name,
                  Imf::Slice::Make(Imf::FLOAT, channel.values.data(), header.dataWindow()));
  }
  return buffer;
}

TEST_F(DofInput, TiledFilesAreRead) {
  const Image small = noise(37, 23);
  {
    Imf::Header header(37, 23);
    const Imf::FrameBuffer buffer = frame_buffer(small, header);
    header.setTileDescription(Imf::TileDescription(16, 8, Imf::ONE_LEVEL));
    Imf::TiledOutputFile file(path("tiled.exr").c_str(), header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  ASSERT_EQ(dof("small.exr --focus-distance 3 -o a.exr"), 0);
  ASSERT_EQ(dof("tiled.exr --focus-distance 3 -o b.exr"), 0) << read("err.txt");
  EXPECT_EQ(read("a.exr"), read("b.exr"));
}

TEST_F(DofInput, OfSeveralPartsTheFirstIsRead) {
  const Image small = noise(37, 23);
  const auto write = [](const Image& first, const Image& second) {
    std::array<Imf::Header, 2> headers{Imf::Header(37, 23), Imf::Header(37, 23)};
    const std::array<Imf::FrameBuffer, 2> buffers{frame_buffer(first, headers[0]),
                                                  frame_buffer(second, headers[1])};
    for (std::size_t i = 0; i < 2; ++i) {
      headers[i].setName(i == 0 ? "one" : "two");
      headers[i].setType(Imf::SCANLINEIMAGE);
    }
    Imf::MultiPartOutputFile file(path("parts.exr").c_str(), headers.data(), 2);
    for (int i = 0; i < 2; ++i) {
      Imf::OutputPart part(file, i);
      part.setFrameBuffer(buffers[static_cast<std::size_t>(i)]);
      part.writePixels(23);
    }
  };
  const Image depth = renamed(small, {"V"});
  write(small, depth);
  ASSERT_EQ(dof("small.exr --focus-distance 3 -o a.exr"), 0);
  ASSERT_EQ(dof("parts.exr --focus-distance 3 -o b.exr"), 0) << read("err.txt");
  EXPECT_EQ(read("a.exr"), read("b.exr"));
  write(depth, small);
  expect_refused("parts.exr", 1, {"parts.exr: no channels R, G, B; there are: V"});
}

TEST_F(DofInput, DeepFilesAreRefusedByName) {
  {
    Imf::Header header(4, 4);
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    const Imf::DeepScanLineOutputFile file(path("deep.exr").c_str(), header);
  }
  expect_refused("deep.exr", 1, {"deep.exr: is a deep image"});
}

TEST_F(DofInput, DamagedFilesAreRefused) {
  const std::string whole = read("small.exr");
  for (const std::size_t size : {0UL, 3UL, 8UL, 200UL, whole.size() / 2, whole.size() - 1}) {
    std::ofstream(path("damaged.exr"), std::ios::binary) << whole.substr(0, size);
    expect_refused("damaged.exr", 1, {"damaged.exr"});
  }
  // A data window without pixels: its corner (x, y) goes beyond its other corner.
  std::string empty = whole;
  const std::size_t window = empty.find("dataWindow");
  ASSERT_NE(window, std::string::npos);
  const std::size_t corner = window + sizeof("dataWindow") + sizeof("box2i") + sizeof(int);
  for (const std::size_t side : {0UL, 4UL}) {
    empty[corner + side] = 100;
    std::ofstream(path("damaged.exr"), std::ios::binary) << empty;
    expect_refused("damaged.exr", 1, {"damaged.exr"});
  }
}

TEST_F(DofInput, AnInterruptLeavesNothingHalfWritten) {
  save("large.exr", noise(1600, 1000));
  const auto before = files();
  EXPECT_EQ(interrupt_after(3,
                            "dof large.exr --f-number 0.01 --max-blur 1500 --layers 256 "
                            "-o stopped.exr"),
            130)
      << read("err.txt");
  EXPECT_FALSE(exists("stopped.exr"));
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace relumbre
