#include "relumbre/archsim/trace_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <zstd.h>

#include "relumbre/base/atomic_stream.h"
#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/base/mapped_file.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

constexpr std::array<char, 8> kMagic{'R', 'L', 'T', '\r', '\n', '\x1A', '\n', '\0'};
constexpr std::uint32_t kVersion = 1, kByteOrder = 0x01020304;
constexpr std::uint32_t kRowsPerBand = 16;  // of the writer: some 2 MB of reads at 1080 lines
constexpr int kEffort = 3;                  // zstd's own default

/// The file's first bytes, as they are in memory; little-endian.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = kByteOrder;
  std::uint32_t width = 0, height = 0;
  std::uint32_t levels = 0;
  std::uint32_t rows_per_band = kRowsPerBand;  // fewer in the last band
  std::uint64_t reads = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t table_hash = 0;  // of the bands' entries
  std::uint64_t hash = 0;        // of all before it

  [[nodiscard]] std::uint64_t computed_hash() const {
    return content_hash(std::as_bytes(std::span(this, 1)).first(offsetof(Header, hash)));
  }
  [[nodiscard]] std::uint32_t bands() const { return (height - 1) / rows_per_band + 1; }
};
static_assert(sizeof(Header) == 64, "no padding: it is the file's layout");

/// What the table behind the header says of a band of rows. Bands follow each other.
struct Band {
  std::uint64_t compressed_bytes = 0;
  std::uint64_t reads = 0;
  std::uint64_t hash = 0;  // of the compressed bytes
};

/// The rows of a band, and where its pixels and reads begin.
struct BandPlace {
  std::size_t first_pixel = 0, pixels = 0;
};

BandPlace place_of(const Header& header, std::size_t band) {
  const std::size_t first = band * header.rows_per_band;
  const std::size_t rows = std::min<std::size_t>(header.rows_per_band, header.height - first);
  return {first * header.width, rows * header.width};
}

// --- writing ---------------------------------------------------------------------------------

/// Tasks and counts of reads of the band's pixels, then the reads.
std::vector<std::byte> content_of(const Trace& trace, const BandPlace& place, std::uint32_t row) {
  const auto tasks = std::as_bytes(trace.tasks().subspan(place.first_pixel, place.pixels));
  const auto counts = trace.read_counts().subspan(place.first_pixel, place.pixels);
  const std::uint64_t count = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  const auto reads = std::as_bytes(trace.reads_from_row(row).first(count));
  std::vector<std::byte> content;
  content.reserve(2 * tasks.size() + count);
  for (const auto part : {tasks, std::as_bytes(counts), reads})
    content.insert(content.end(), part.begin(), part.end());
  return content;
}

std::vector<std::byte> compressed(const std::vector<std::byte>& content, const std::string& name) {
  std::vector<std::byte> bytes(ZSTD_compressBound(content.size()));
  const std::size_t size =
      ZSTD_compress(bytes.data(), bytes.size(), content.data(), content.size(), kEffort);
  if (ZSTD_isError(size) != 0)
    throw FileError(name, fmt::format("cannot be compressed: {}", ZSTD_getErrorName(size)));
  bytes.resize(size);
  bytes.shrink_to_fit();
  return bytes;
}

void write_all(const std::filesystem::path& file, std::span<const std::byte> header,
               std::span<const std::byte> table, const std::vector<std::vector<std::byte>>& bands) {
  AtomicStream out(file);
  out.write(header);
  out.write(table);
  for (const auto& band : bands) out.write(std::span(band));
  out.commit();
}

// --- reading ---------------------------------------------------------------------------------

/// Decompresses one frame piece by piece to where it belongs, so that memory is touched only for
/// bytes that are really there, whatever the file claims.
class FrameReader {
 public:
  explicit FrameReader(std::span<const std::byte> frame)
      : context_(ZSTD_createDCtx(), ZSTD_freeDCtx), input_{frame.data(), frame.size(), 0} {
    if (!context_) throw std::bad_alloc();
    (void)ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, kMaxWindowLog);
  }
  /// False if the frame is damaged or ends before.
  bool fill(std::span<std::byte> bytes) {
    ZSTD_outBuffer output{bytes.data(), bytes.size(), 0};
    while (output.pos < output.size)
      if (!step(output)) return false;
    return true;
  }
  /// Whether there is nothing more, in the frame and behind it.
  bool is_at_end() {
    std::byte more{};
    ZSTD_outBuffer output{&more, 1, 0};
    while (!is_done_)
      if (!step(output) || output.pos > 0) return false;
    return input_.pos == input_.size;
  }

 private:
  static constexpr int kMaxWindowLog = 23;  // the writer's are below

  /// False where there is no progress.
  bool step(ZSTD_outBuffer& output) {
    const std::size_t in = input_.pos, out = output.pos;
    if (is_done_) return false;
    const std::size_t result = ZSTD_decompressStream(context_.get(), &output, &input_);
    is_done_ = result == 0;
    return ZSTD_isError(result) == 0 && (is_done_ || input_.pos > in || output.pos > out);
  }

  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context_;
  ZSTD_inBuffer input_;
  bool is_done_ = false;
};

class TraceReader {
 public:
  TraceReader(std::span<const std::byte> bytes, const std::string& name, std::uint64_t max_bytes)
      : bytes_(bytes), name_(name), max_bytes_(max_bytes) {}

  Trace read() {
    read_header();
    read_table();
    const std::size_t pixels = shape_.pixels();
    Trace::Parts parts{shape_, HugeArray<std::uint32_t>(pixels), HugeArray<std::uint32_t>(pixels),
                       HugeArray<std::uint8_t>(header_.reads)};
    parallel_for(0, bands_.size(), 1, [&](std::size_t band) { read_band(band, parts); });
    try {
      return Trace(std::move(parts));
    } catch (const ShapeError& error) {
      fail(fmt::format("is damaged: {}", error.what()));
    }
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw FileError(name_, reason); }

  void read_header() {
    if (bytes_.size() < sizeof(Header) ||
        std::memcmp(bytes_.data(), kMagic.data(), kMagic.size()) != 0)
      fail("is not a Relumbre trace (.rlt)");
    std::memcpy(&header_, bytes_.data(), sizeof header_);
    if (header_.byte_order != kByteOrder) fail("has another byte order than this machine");
    if (header_.version != kVersion)
      fail(fmt::format("has version {} of the format; this program reads {}", header_.version,
                       kVersion));
    if (header_.hash != header_.computed_hash()) fail("is damaged: the header's hash is wrong");
    if (header_.file_bytes != bytes_.size())
      fail(fmt::format("is truncated or altered: it has {} bytes instead of {}", bytes_.size(),
                       header_.file_bytes));
    check_shape();
  }

  void check_shape() {
    shape_ = {header_.width, header_.height,
              static_cast<int>(std::min<std::uint32_t>(header_.levels, 255))};
    try {
      shape_.check();
    } catch (const ValueError& error) {
      fail(error.what());
    }
    if (header_.rows_per_band == 0) fail("has bands without rows");
    const std::uint64_t of_pixels = 8 * std::uint64_t{shape_.pixels()};
    if (header_.reads > max_bytes_ || of_pixels > max_bytes_ - header_.reads)
      fail(fmt::format("holds {} pixels and {} reads, which need more than the {} bytes allowed",
                       shape_.pixels(), header_.reads, max_bytes_));
  }

  /// Where each band is; all that it says is checked but its content.
  void read_table() {
    const std::uint64_t table_bytes = header_.bands() * std::uint64_t{sizeof(Band)};
    std::uint64_t at = sizeof(Header) + table_bytes;
    if (at > bytes_.size()) fail("is damaged: it has more bands than bytes");
    const auto table = bytes_.subspan(sizeof(Header), table_bytes);
    if (content_hash(table) != header_.table_hash) fail("is damaged: the table's hash is wrong");
    bands_.resize(header_.bands());
    std::memcpy(bands_.data(), table.data(), table_bytes);
    std::uint64_t reads = 0;
    for (const Band& band : bands_) {
      if (band.compressed_bytes > bytes_.size() - at || band.reads > header_.reads - reads)
        fail("is damaged: its bands are larger than it");
      places_.push_back({at, reads});
      at += band.compressed_bytes;
      reads += band.reads;
    }
    if (at != bytes_.size() || reads != header_.reads) fail("is damaged: its bands do not add up");
  }

  void read_band(std::size_t index, Trace::Parts& parts) const {
    const Band& band = bands_[index];
    const BandPlace place = place_of(header_, index);
    const auto source = bytes_.subspan(places_[index].offset, band.compressed_bytes);
    const auto bad = [&](std::string_view reason) {
      fail(fmt::format("is damaged: band {} {}", index, reason));
    };
    if (content_hash(source) != band.hash) bad("has a wrong hash");
    const auto pixels = [&](HugeArray<std::uint32_t>& values) {
      return std::as_writable_bytes(values.span().subspan(place.first_pixel, place.pixels));
    };
    const auto reads = parts.reads.span().subspan(places_[index].first_read, band.reads);
    FrameReader frame(source);
    if (!frame.fill(pixels(parts.tasks)) || !frame.fill(pixels(parts.read_counts)) ||
        !frame.fill(std::as_writable_bytes(reads)) || !frame.is_at_end())
      bad("cannot be decompressed to what it should be");
  }

  struct Place {
    std::uint64_t offset = 0, first_read = 0;
  };

  std::span<const std::byte> bytes_;
  std::string name_;
  std::uint64_t max_bytes_;
  Header header_;
  TraceShape shape_;
  std::vector<Band> bands_;
  std::vector<Place> places_;
};

}  // namespace

void write_trace(const std::filesystem::path& file, const Trace& trace) {
  const TraceShape& shape = trace.shape();
  Header header;
  header.width = shape.width;
  header.height = shape.height;
  header.levels = static_cast<std::uint32_t>(shape.levels);
  header.reads = trace.reads().size();
  std::vector<Band> table(header.bands());
  std::vector<std::vector<std::byte>> bands(table.size());
  parallel_for(0, bands.size(), 1, [&](std::size_t i) {
    const BandPlace place = place_of(header, i);
    const auto content = content_of(trace, place, static_cast<std::uint32_t>(i) * kRowsPerBand);
    bands[i] = compressed(content, file.string());
    table[i] = {bands[i].size(), content.size() - 8 * place.pixels, content_hash(bands[i])};
  });
  const auto table_bytes = std::as_bytes(std::span(table));
  header.file_bytes = sizeof(Header) + table_bytes.size();
  for (const Band& band : table) header.file_bytes += band.compressed_bytes;
  header.table_hash = content_hash(table_bytes);
  header.hash = header.computed_hash();
  write_all(file, std::as_bytes(std::span(&header, 1)), table_bytes, bands);
}

Trace read_trace(const std::filesystem::path& file, std::uint64_t max_bytes) {
  const MappedFile mapped(file);
  return parse_trace(mapped.bytes(), file.string(), max_bytes);
}

Trace parse_trace(std::span<const std::byte> bytes, const std::string& name,
                  std::uint64_t max_bytes) {
  return TraceReader(bytes, name, max_bytes).read();
}

}  // namespace relumbre
