#include "relumbre/image/exr.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 28;
constexpr std::uint64_t kMaxValues = std::uint64_t{1} << 30;
constexpr std::size_t kMaxChannels = 4096;
// DWAB packs densest: runs of up to 128 in two bytes, then deflate at 1032:1. A constant image of
// 65536 x 256 pixels was measured at 7557 values a byte.
constexpr std::uint64_t kMaxValuesPerByte = std::uint64_t{1} << 15;

// Files are read before they are parsed, so that any bytes can be, and encoded before they are
// written, so that a full disk is noticed: OpenEXR writes its last bytes in a destructor.

class ExrReader : public Imf::IStream {
 public:
  explicit ExrReader(std::string_view bytes) : Imf::IStream("memory"), bytes_(bytes) {}

  /// As the base class wants it: true if more bytes follow. Throws at the end.
  bool read(char target[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (count < 0 || position_ > bytes_.size() || size > bytes_.size() - position_) {
      throw Error("the file ends too early");
    }
    std::memcpy(target, bytes_.data() + position_, size);
    position_ += size;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

class ExrWriter : public Imf::OStream {
 public:
  ExrWriter() : Imf::OStream("memory") {}

  void write(const char source[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, source, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::vector<std::string> channel_names(const std::string& file, const Imf::Header& header) {
  std::vector<std::string> names;
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
      throw FileError(file, "has a subsampled channel '" + std::string(channel.name()) +
                                "', which this reader does not take");
    }
    names.emplace_back(channel.name());
  }
  if (names.empty()) throw FileError(file, "has no channels");
  if (names.size() > kMaxChannels) {
    throw FileError(file, "has " + std::to_string(names.size()) + " channels, more than the " +
                              std::to_string(kMaxChannels) + " this reader takes");
  }
  return names;
}

/// Refuses sizes that are absurd by themselves or for a file of so many bytes.
void check_size(const std::string& file, std::uint64_t width, std::uint64_t height,
                std::uint64_t channels, std::size_t file_bytes) {
  const std::string shape = std::to_string(width) + " x " + std::to_string(height) + " pixels, " +
                            std::to_string(channels) + " channels";
  if (width > kMaxPixels / height || width * height > kMaxValues / channels) {
    throw FileError(file, "has " + shape + ", more than this reader takes");
  }
  if (width * height * channels / kMaxValuesPerByte > file_bytes) {
    throw FileError(file, "claims " + shape + ", more than its " + std::to_string(file_bytes) +
                              " bytes can hold");
  }
}

/// A tiled part is read through a buffer of one row of tiles, padding included.
void check_tiles(const std::string& file, const Imf::Header& header, std::uint64_t width,
                 std::uint64_t channels) {
  if (!header.hasTileDescription()) return;
  const Imf::TileDescription& tile = header.tileDescription();
  const std::uint64_t padded = width + tile.xSize;
  if (tile.ySize > kMaxValues / (padded * channels)) {
    throw FileError(file, "has tiles of " + std::to_string(tile.xSize) + " x " +
                              std::to_string(tile.ySize) + " pixels, more than this reader takes");
  }
}

struct Size {
  std::size_t width, height;
};

/// The data window's size, bounded.
Size checked_size(const std::string& file, const Imf::Header& header, std::size_t channels,
                  std::size_t file_bytes) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1) throw FileError(file, "has an empty data window");
  const Size size{static_cast<std::size_t>(width), static_cast<std::size_t>(height)};
  check_size(file, size.width, size.height, channels, file_bytes);
  check_tiles(file, header, size.width, channels);
  return size;
}

Imf::FrameBuffer frame_buffer(Image& image, const Imath::Box2i& window) {
  Imf::FrameBuffer buffer;
  for (const Image::Channel& channel : image.channels()) {
    const std::span<float> plane = image.channel(channel.name);
    buffer.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, plane.data(), window));
  }
  return buffer;
}

Image parse(std::string_view bytes, const std::string& name) {
  ExrReader stream(bytes);
  Imf::MultiPartInputFile file(stream, 0, false);
  const Imf::Header& header = file.header(0);
  if (header.hasType() && !Imf::isImage(header.type())) {
    throw FileError(name,
                    "is a deep image ('" + header.type() + "'), which this reader does not take");
  }
  const std::vector<std::string> names = channel_names(name, header);
  const Size size = checked_size(name, header, names.size(), bytes.size());
  if (!file.partComplete(0)) {
    throw FileError(name, "is incomplete: parts of the picture are missing");
  }
  Image image(size.width, size.height, names);
  const Imath::Box2i window = header.dataWindow();
  Imf::InputPart part(file, 0);
  part.setFrameBuffer(frame_buffer(image, window));
  part.readPixels(window.min.y, window.max.y);
  return image;
}

/// The planes that are stored as half, converted. Stable addresses: one buffer a channel.
using HalfPlanes = std::vector<std::vector<half>>;

void add_channel(const Image::Channel& channel, bool as_half, const Imath::Box2i& window,
                 HalfPlanes& halves, Imf::Header& header, Imf::FrameBuffer& buffer) {
  const Imf::PixelType type = as_half ? Imf::HALF : Imf::FLOAT;
  header.channels().insert(channel.name, Imf::Channel(type));
  const void* data = channel.values.data();
  if (as_half) data = halves.emplace_back(channel.values.begin(), channel.values.end()).data();
  buffer.insert(channel.name, Imf::Slice::Make(type, data, window));
}

std::string encode(const Image& image, const ExrConfig& config) {
  const Imath::Box2i window(
      {0, 0}, {static_cast<int>(image.width()) - 1, static_cast<int>(image.height()) - 1});
  Imf::Header header(window, window);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  HalfPlanes halves;
  for (const Image::Channel& channel : image.channels()) {
    const auto& half_names = config.half_channels;
    const bool as_half =
        std::find(half_names.begin(), half_names.end(), channel.name) != half_names.end();
    add_channel(channel, as_half, window, halves, header, buffer);
  }
  ExrWriter stream;
  {
    Imf::OutputFile file(stream, header, 0);  // its destructor writes the table of offsets
    file.setFrameBuffer(buffer);
    file.writePixels(static_cast<int>(image.height()));
  }
  return stream.bytes();
}

/// Runs `work`, turning whatever OpenEXR throws into a FileError.
template <class Work>
auto as_file_error(const std::string& file, std::string_view what_failed, Work&& work) {
  try {
    return work();
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw FileError(file, "needs more memory than there is");
  } catch (const std::exception& error) {
    throw FileError(file, std::string(what_failed) + ": " + one_line(error.what()));
  }
}

}  // namespace

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2F\x31\x01"); }

Image parse_exr(std::string_view bytes, const std::string& name) {
  if (!is_exr(bytes)) throw FileError(name, bytes.empty() ? "is empty" : "is not an OpenEXR image");
  return as_file_error(name, "is a damaged OpenEXR image", [&] { return parse(bytes, name); });
}

Image read_exr(const std::filesystem::path& file) {
  return parse_exr(read_file(file), file.string());
}

void write_exr(const std::filesystem::path& file, const Image& image, const ExrConfig& config) {
  if (image.channels().empty()) throw ValueError("write_exr: the image has no channel");
  for (const std::string& name : config.half_channels) (void)image.channel(name);
  const std::string name = file.string();
  constexpr std::size_t max_side = std::size_t{1} << 28;
  if (image.width() > max_side || image.height() > max_side) {
    throw FileError(name, "cannot hold an image with a side above 2^28");
  }
  write_file(file, as_file_error(name, "cannot be encoded as OpenEXR",
                                 [&] { return encode(image, config); }));
}

}  // namespace relumbre
