#include "relumbre/octree/rlo_file.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "relumbre/base/atomic_stream.h"
#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"
#include "relumbre/base/mapped_file.h"
#include "relumbre/octree/voxel_tree_builder.h"

namespace relumbre {

namespace {

constexpr std::array<char, 8> kMagic{'R', 'L', 'O', '\r', '\n', '\x1A', '\n', '\0'};
constexpr std::uint32_t kVersion = 2, kByteOrder = 0x01020304;
constexpr std::uint64_t kAlignment = 4096;  // of sections: a page

enum Section : std::size_t { kNodes, kLeaves, kFirstVoxel, kValues, kNodeValues, kSections };

struct SectionEntry {
  std::uint64_t offset = 0, bytes = 0, hash = 0;
};

/// The file's first bytes, as they are in memory; little-endian.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = kByteOrder;
  std::uint32_t depth = 0;
  std::uint32_t separating = 0;  // 6 or 26
  std::array<double, 3> corner{};
  double edge = 0;
  double build_seconds = 0;
  std::array<std::uint64_t, VoxelTree::kMaxLevels> nodes{};  // of each level, leaves included
  std::uint64_t voxels = 0;
  std::uint64_t content = 0;  // 0: geometry alone, 1: reflectance, 2: radiosity
  std::array<SectionEntry, kSections> section{};
  std::uint64_t file_bytes = 0;
  std::uint64_t hash = 0;  // of all before it

  [[nodiscard]] std::uint64_t computed_hash() const {
    ContentHash digest;
    digest.add(std::as_bytes(std::span(this, 1)).first(offsetof(Header, hash)));
    return digest.digest();
  }
};
static_assert(sizeof(Header) == 280, "no padding: it is the file's layout");
static_assert(offsetof(Header, nodes) == 64 && offsetof(Header, section) == 144 &&
                  offsetof(Header, file_bytes) == 264 && offsetof(Header, hash) == 272,
              "docs/rlo.md");
static_assert(sizeof(VoxelTree::Node) == 16 && sizeof(VoxelValue) == 12);

std::uint64_t hash_of(std::span<const std::byte> bytes) {
  ContentHash digest;
  digest.add(bytes);
  return digest.digest();
}

// --- writing ---------------------------------------------------------------------------------

/// Sections one behind the other, each hashed, and at last the header before them.
class SectionWriter {
 public:
  explicit SectionWriter(const std::filesystem::path& file) : out_(file) { skip_to(kAlignment); }
  void begin(Section section) {
    skip_to((at_ + kAlignment - 1) / kAlignment * kAlignment);
    section_ = section;
    header_.section[section].offset = at_;
    digest_ = {};
  }
  template <class T>
  void add(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    write(bytes);
    digest_.add(bytes);
    header_.section[section_].bytes += bytes.size();
    header_.section[section_].hash = digest_.digest();
  }
  void finish(const Header& header) {
    const auto sections = header_.section;
    header_ = header;
    header_.section = sections;
    header_.file_bytes = at_;
    header_.hash = header_.computed_hash();
    out_.seek(0);
    write(std::as_bytes(std::span(&header_, 1)));
    out_.commit();
  }

 private:
  void write(std::span<const std::byte> bytes) {
    out_.write(bytes);
    at_ += bytes.size();
  }
  void skip_to(std::uint64_t offset) {
    const std::vector<std::byte> zeros(offset - at_);
    write(zeros);
  }

  AtomicStream out_;
  std::uint64_t at_ = 0;
  Section section_ = kNodes;
  Header header_;
  ContentHash digest_;
};

Header header_of(const VoxelTree& tree, VoxelTree::Content content, std::uint64_t voxels,
                 double build_seconds) {
  const VoxelTree::Parts& parts = tree.parts();
  Header header;
  header.depth = parts.depth;
  header.separating = parts.separating == Separating::k6 ? 6 : 26;
  header.corner = {parts.cube.corner.x, parts.cube.corner.y, parts.cube.corner.z};
  header.edge = parts.cube.edge;
  header.build_seconds = build_seconds;
  for (unsigned level = 0; level < tree.levels(); ++level) header.nodes[level] = tree.size(level);
  header.voxels = voxels;
  if (!parts.first_voxel.empty())
    header.content = content == VoxelTree::Content::kRadiosity ? 2 : 1;
  return header;
}

// --- reading ---------------------------------------------------------------------------------

class RloReader {
 public:
  RloReader(std::span<const std::byte> bytes, const std::string& name)
      : bytes_(bytes), name_(name) {}

  RloFile read(std::shared_ptr<const void> owner) {
    read_header();
    VoxelTree::Parts parts{
        .cube = {{header_.corner[0], header_.corner[1], header_.corner[2]}, header_.edge},
        .depth = header_.depth,
        .separating = header_.separating == 6 ? Separating::k6 : Separating::k26};
    take_sections(parts);
    parts.owner = std::move(owner);
    VoxelTree tree(std::move(parts));
    try {
      check_tree(tree);
    } catch (const ShapeError& error) {
      fail(error.what());
    }
    if (tree.voxels() != header_.voxels) fail("the number of voxels is not the header's");
    return {std::move(tree), header_.build_seconds};
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw FileError(name_, reason); }

  void read_header() {
    if (bytes_.size() < sizeof(Header) ||
        std::memcmp(bytes_.data(), kMagic.data(), kMagic.size()) != 0)
      fail("is not a Relumbre octree (.rlo)");
    std::memcpy(&header_, bytes_.data(), sizeof header_);
    if (header_.byte_order != kByteOrder) fail("has another byte order than this machine");
    if (header_.version != kVersion)
      fail("has version " + std::to_string(header_.version) +
           " of the format; this program reads " + std::to_string(kVersion));
    if (header_.hash != header_.computed_hash()) fail("is damaged: the header's hash is wrong");
    check_header();
    if (header_.file_bytes != bytes_.size())
      fail("is truncated or altered: it has " + std::to_string(bytes_.size()) +
           " bytes instead of " + std::to_string(header_.file_bytes));
  }

  void check_header() const {
    if (VoxelTree::levels_of(header_.depth) > VoxelTree::kMaxLevels || header_.depth > kGridBits)
      fail("has a depth of " + std::to_string(header_.depth) + ", which is too large");
    if (header_.separating != 6 && header_.separating != 26)
      fail("separates neither 6 nor 26 neighbours");
    if (header_.content > 2) fail("has values of an unknown kind");
    for (const double c : header_.corner)
      if (!std::isfinite(c)) fail("has a cube that is not finite");
    if (!(header_.edge > 0) || !std::isfinite(header_.edge)) fail("has a cube without extent");
    if (!(header_.build_seconds >= 0) || !std::isfinite(header_.build_seconds))
      fail("was built in a time that cannot be");
    for (unsigned level = VoxelTree::levels_of(header_.depth); level < VoxelTree::kMaxLevels;
         ++level)
      if (header_.nodes[level] != 0) fail("has nodes behind its last level");
  }

  /// The section's bytes, which must be `count` values of T.
  template <class T>
  std::span<const T> section(Section which, std::uint64_t count) const {
    const SectionEntry& entry = header_.section[which];
    if (entry.offset % kAlignment != 0 || entry.offset > bytes_.size() ||
        entry.bytes > bytes_.size() - entry.offset || entry.bytes % sizeof(T) != 0 ||
        entry.bytes / sizeof(T) != count)
      fail("is damaged: section " + std::to_string(which) + " is not where or what it should be");
    const auto content = bytes_.subspan(entry.offset, entry.bytes);
    if (hash_of(content) != entry.hash)
      fail("is damaged: the hash of section " + std::to_string(which) + " is wrong");
    return {reinterpret_cast<const T*>(content.data()), count};
  }

  /// Of levels [0, end). Bounded, so that a sum cannot overflow.
  [[nodiscard]] std::uint64_t count_nodes(unsigned end) const {
    std::uint64_t sum = 0;
    for (unsigned level = 0; level < end; ++level) {
      if (header_.nodes[level] > bytes_.size()) fail("has more nodes than bytes");
      sum += header_.nodes[level];
    }
    return sum;
  }

  void take_sections(VoxelTree::Parts& parts) const {
    const unsigned levels = VoxelTree::levels_of(header_.depth);
    auto nodes = section<VoxelTree::Node>(kNodes, count_nodes(levels - 1));
    for (unsigned level = 0; level + 1 < levels; ++level) {
      parts.nodes[level] = nodes.first(header_.nodes[level]);
      nodes = nodes.subspan(header_.nodes[level]);
    }
    parts.leaves = section<std::uint64_t>(kLeaves, header_.nodes[levels - 1]);
    const bool values = header_.content != 0;
    parts.content =
        header_.content == 2 ? VoxelTree::Content::kRadiosity : VoxelTree::Content::kReflectance;
    parts.first_voxel = section<std::uint64_t>(kFirstVoxel, values ? parts.leaves.size() : 0);
    parts.values = section<VoxelValue>(kValues, values ? header_.voxels : 0);
    auto node_values = section<VoxelValue>(kNodeValues, values ? count_nodes(levels) : 0);
    for (unsigned level = 0; values && level < levels; ++level) {
      parts.node_values[level] = node_values.first(header_.nodes[level]);
      node_values = node_values.subspan(header_.nodes[level]);
    }
  }

  std::span<const std::byte> bytes_;
  std::string name_;
  Header header_;
};

}  // namespace

struct RloWriter::State {
  State(const std::filesystem::path& file, const Cube& cube, unsigned depth, Separating separating,
        VoxelTree::Content kind)
      : out(file),
        content(kind),
        builder(cube, depth, separating, [this](auto values) { out.add(values); }) {
    out.begin(kValues);
  }
  SectionWriter out;
  VoxelTree::Content content;
  VoxelTreeBuilder builder;
  std::uint64_t voxels = 0;
};

RloWriter::RloWriter(const std::filesystem::path& file, const Cube& cube, unsigned depth,
                     Separating separating, VoxelTree::Content content)
    : state_(std::make_unique<State>(file, cube, depth, separating, content)) {}

RloWriter::~RloWriter() = default;

void RloWriter::add(const VoxelBlocks& blocks) {
  state_->builder.add(blocks);
  state_->voxels += blocks.voxels();
}

void RloWriter::finish(double build_seconds) {
  const VoxelTree tree = state_->builder.finish();
  const VoxelTree::Parts& parts = tree.parts();
  SectionWriter& out = state_->out;
  out.begin(kNodes);
  for (const auto& nodes : parts.nodes) out.add(nodes);
  out.begin(kLeaves);
  out.add(parts.leaves);
  out.begin(kFirstVoxel);
  out.add(parts.first_voxel);
  out.begin(kNodeValues);
  for (const auto& values : parts.node_values) out.add(values);
  out.finish(header_of(tree, state_->content, state_->voxels, build_seconds));
}

RloFile read_rlo(const std::filesystem::path& file) {
  auto mapped = std::make_shared<MappedFile>(file);
  const auto bytes = mapped->bytes();
  return view_rlo(bytes, std::move(mapped), file.string());
}

RloFile view_rlo(std::span<const std::byte> bytes, std::shared_ptr<const void> owner,
                 const std::string& name) {
  return RloReader(bytes, name).read(std::move(owner));
}

}  // namespace relumbre
