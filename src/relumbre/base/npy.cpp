#include "relumbre/base/npy.h"

#include <bit>
#include <cctype>
#include <cstring>
#include <limits>
#include <string>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"

namespace relumbre {

static_assert(std::endian::native == std::endian::little, ".npy is written as it lies in memory");

namespace {

// Layout of a .npy file (NumPy format specification):
//   0      6        8            10 (version 1) or 12
//   +------+--------+------------+----------------------------+--------------
//   |magic |maj, min| header len | python dict, space-padded  | raw elements
constexpr std::string_view kMagic = "\x93NUMPY";

struct Header {
  std::string dict;
  std::size_t data_offset;
};

Header parse_header(const std::string& file, std::string_view bytes) {
  if (bytes.size() < 10 || !bytes.starts_with(kMagic)) {
    throw FileError(file, "is not a NumPy .npy file");
  }
  const int major = static_cast<unsigned char>(bytes[6]);
  const std::size_t width = major == 1 ? 2 : 4;
  if (major < 1 || major > 3) throw FileError(file, "has an unknown .npy version");
  if (bytes.size() < 8 + width) throw FileError(file, "is truncated");
  std::size_t size = 0;
  for (std::size_t i = 0; i < width; ++i) {
    size |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[8 + i])) << (8 * i);
  }
  const std::size_t begin = 8 + width;
  if (size > bytes.size() - begin) throw FileError(file, "is truncated");
  return {std::string(bytes.substr(begin, size)), begin + size};
}

/// The text that follows 'key': in the header's Python dictionary.
std::string value_of(const std::string& file, const std::string& dict, const std::string& key) {
  const std::size_t at = dict.find("'" + key + "'");
  const std::size_t colon = at == std::string::npos ? at : dict.find(':', at);
  if (colon == std::string::npos) throw FileError(file, "has no '" + key + "' in its header");
  const std::size_t begin = dict.find_first_not_of(' ', colon + 1);
  return begin == std::string::npos ? std::string() : dict.substr(begin);
}

std::vector<std::size_t> parse_shape(const std::string& file, const std::string& text) {
  const std::size_t close = text.find(')');
  if (text.empty() || text[0] != '(' || close == std::string::npos) {
    throw FileError(file, "has no shape tuple in its header");
  }
  std::vector<std::size_t> shape;
  for (std::size_t i = 1; i < close;) {
    if (text[i] == ' ' || text[i] == ',') {
      ++i;
      continue;
    }
    std::size_t value = 0;
    if (std::isdigit(static_cast<unsigned char>(text[i])) == 0) {
      throw FileError(file, "has a shape that is not made of sizes");
    }
    while (i < close && std::isdigit(static_cast<unsigned char>(text[i])) != 0) {
      if (value > (std::size_t{1} << 40)) throw FileError(file, "has an impossible shape");
      value = value * 10 + static_cast<std::size_t>(text[i++] - '0');
    }
    shape.push_back(value);
  }
  return shape;
}

std::size_t count_of(const std::string& file, std::span<const std::size_t> shape,
                     std::size_t limit) {
  std::size_t count = 1;
  for (const std::size_t extent : shape) {
    if (extent != 0 && count > limit / extent) throw FileError(file, "is truncated");
    count *= extent;
  }
  return count;
}

/// Messages are one line of plain text whatever the file holds.
std::string printable(std::string text) {
  for (char& c : text) {
    if (std::isprint(static_cast<unsigned char>(c)) == 0) c = '?';
  }
  return text;
}

/// '<f4' or '<f8' elements by `width`; a double beyond float's range becomes infinite.
void copy_elements(std::string_view source, std::size_t width, std::span<float> target) {
  for (std::size_t i = 0; i < target.size(); ++i) {
    if (width == 4) {
      std::memcpy(&target[i], source.data() + 4 * i, 4);
    } else {
      double value = 0;
      std::memcpy(&value, source.data() + 8 * i, 8);
      target[i] = static_cast<float>(value);
    }
  }
}

}  // namespace

FloatArray parse_npy(std::string_view bytes, const std::string& name) {
  const Header header = parse_header(name, bytes);
  const std::string type = value_of(name, header.dict, "descr").substr(0, 5);
  const std::size_t width = type == "'<f4'" ? 4 : type == "'<f8'" ? 8 : 0;
  if (width == 0) throw FileError(name, "must hold float32 or float64, not " + printable(type));
  if (value_of(name, header.dict, "fortran_order").starts_with("True")) {
    throw FileError(name, "is in Fortran order; save it with numpy.ascontiguousarray");
  }
  FloatArray array{parse_shape(name, value_of(name, header.dict, "shape")), {}};
  const std::size_t stored = (bytes.size() - header.data_offset) / width;
  const std::size_t count = count_of(name, array.shape, stored);
  if (count > stored) throw FileError(name, "is truncated");
  array.data.resize(count);
  copy_elements(bytes.substr(header.data_offset), width, array.data);
  return array;
}

FloatArray read_npy(const std::filesystem::path& file) {
  return parse_npy(read_file(file), file.string());
}

void write_npy(const std::filesystem::path& file, std::span<const std::size_t> shape,
               std::span<const float> data) {
  std::size_t count = 1;
  std::string tuple = "(";
  for (const std::size_t extent : shape) {
    count *= extent;
    tuple += std::to_string(extent) + ", ";
  }
  if (count != data.size()) {
    throw ShapeError("write_npy: " + std::to_string(data.size()) + " values for shape " + tuple +
                     ")");
  }
  std::string dict = "{'descr': '<f4', 'fortran_order': False, 'shape': " + tuple + "), }";
  dict.append(63 - (kMagic.size() + 4 + dict.size()) % 64, ' ');
  dict += '\n';
  std::string bytes(kMagic);
  bytes += {1, 0, static_cast<char>(dict.size() & 255U), static_cast<char>(dict.size() >> 8)};
  bytes += dict;
  bytes.append(reinterpret_cast<const char*>(data.data()), data.size_bytes());
  write_file(file, bytes);
}

}  // namespace relumbre
