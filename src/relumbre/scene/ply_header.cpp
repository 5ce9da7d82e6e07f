#include "relumbre/scene/ply_header.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "relumbre/base/error.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMaxCount = std::uintmax_t{1} << 32;
constexpr std::uintmax_t kMaxHeader = std::uintmax_t{1} << 16;

/// What the elements after the header take at least.
struct PlyNeeds {
  bool text = false;
  std::uintmax_t bytes = 0, lines = 0;
};

std::uintmax_t size_of_type(const std::string& type) {
  constexpr std::array<std::pair<std::string_view, std::uintmax_t>, 16> sizes = {{
      {"char", 1},
      {"uchar", 1},
      {"int8", 1},
      {"uint8", 1},
      {"short", 2},
      {"ushort", 2},
      {"int16", 2},
      {"uint16", 2},
      {"int", 4},
      {"uint", 4},
      {"int32", 4},
      {"uint32", 4},
      {"float", 4},
      {"double", 8},
      {"float32", 4},
      {"float64", 8},
  }};
  const auto found = std::ranges::find(sizes, std::string_view(type),
                                       &std::pair<std::string_view, std::uintmax_t>::first);
  return found == sizes.end() ? 0 : found->second;
}

/// Adds up the header's elements.
class PlyHeader {
 public:
  explicit PlyHeader(std::string file_name) : file_name_(std::move(file_name)) {}

  PlyNeeds read(std::istream& in) {
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
      std::istringstream words(line);
      std::string key;
      words >> key;
      if (number == 1 && key != "ply") fail("is not a PLY file");
      if (key == "format") read_format(words);
      if (key == "element") begin_element(words);
      if (key == "property") add_property(words);
      if (key == "end_header") return finish();
    }
    fail("the PLY header is truncated");
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw FileError(file_name_, reason); }

  void read_format(std::istream& words) {
    std::string format;
    words >> format;
    needs_.text = format == "ascii";
    if (!needs_.text && format != "binary_little_endian" && format != "binary_big_endian") {
      fail("the PLY format is unknown");
    }
    has_format_ = true;
  }

  void begin_element(std::istream& words) {
    end_element();
    std::string name;
    if (!(words >> name >> count_) || count_ > kMaxCount) fail("a PLY element count is unusable");
  }

  void add_property(std::istream& words) {
    std::string type, count_type, item_type, name;
    words >> type;
    if (type != "list") {
      element_bytes_ += checked_size(type);
      return;
    }
    words >> count_type >> item_type >> name;
    const bool is_face = name == "vertex_indices" || name == "vertex_index";
    element_bytes_ += checked_size(count_type) + (is_face ? 3 : 0) * checked_size(item_type);
  }

  [[nodiscard]] std::uintmax_t checked_size(const std::string& type) const {
    const std::uintmax_t size = size_of_type(type);
    if (size == 0) fail("a PLY property has an unknown type");
    return size;
  }

  void end_element() {
    needs_.bytes += count_ * element_bytes_;
    needs_.lines += element_bytes_ > 0 ? count_ : 0;
    count_ = element_bytes_ = 0;
  }

  PlyNeeds finish() {
    end_element();
    if (!has_format_) fail("the PLY header names no format");
    return needs_;
  }

  std::string file_name_;
  PlyNeeds needs_;
  bool has_format_ = false;
  std::uintmax_t count_ = 0, element_bytes_ = 0;
};

/// Lines that hold anything, until there are `enough`.
std::uintmax_t count_lines(std::istream& in, std::uintmax_t enough) {
  std::uintmax_t lines = 0;
  std::string line;
  while (lines < enough && std::getline(in, line)) {
    lines += line.find_first_not_of(" \t\r") != std::string::npos ? 1 : 0;
  }
  return lines;
}

}  // namespace

void check_ply(const fs::path& file, std::uintmax_t size) {
  std::ifstream in(file, std::ios::binary);
  std::string head(static_cast<std::size_t>(std::min(size, kMaxHeader)), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  std::istringstream header(head);
  const PlyNeeds needs = PlyHeader(file.string()).read(header);
  const std::uintmax_t begin =
      header.eof() ? head.size() : static_cast<std::uintmax_t>(header.tellg());
  in.clear();
  in.seekg(static_cast<std::streamoff>(begin));
  const bool complete =
      needs.text ? count_lines(in, needs.lines) >= needs.lines : size - begin >= needs.bytes;
  if (!complete) throw FileError(file.string(), "is truncated: shorter than its header says");
}

}  // namespace relumbre
