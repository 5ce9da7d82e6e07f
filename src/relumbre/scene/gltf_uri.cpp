#include "relumbre/scene/gltf_uri.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace relumbre {
namespace {

bool is_base64(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' ||
         c == '/';
}

std::optional<std::string> percent_decode(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    unsigned code = 0;
    const std::string_view digits = text.substr(i + 1, 2);
    const char* const end = digits.data() + digits.size();
    if (digits.size() < 2 || std::from_chars(digits.data(), end, code, 16).ptr != end) return {};
    out.push_back(static_cast<char>(code));
    i += 2;
  }
  return out;
}

}  // namespace

std::optional<std::size_t> data_uri_size(std::string_view uri) {
  constexpr std::string_view marker = ";base64,";
  if (!uri.starts_with("data:")) return std::nullopt;
  const std::size_t comma = uri.find(marker);
  if (comma == std::string_view::npos || comma > 200) return std::nullopt;
  std::string_view data = uri.substr(comma + marker.size());
  if (data.size() % 4 != 0) return std::nullopt;
  std::size_t padding = 0;
  while (padding < 2 && data.ends_with('=')) {
    data.remove_suffix(1);
    ++padding;
  }
  if (!std::ranges::all_of(data, is_base64)) return std::nullopt;
  return (data.size() + padding) / 4 * 3 - padding;
}

std::optional<std::string> decode_relative_uri(std::string_view uri) {
  std::optional<std::string> name = percent_decode(uri);
  if (!name || name->empty() || name->find("://") != std::string::npos) return std::nullopt;
  if (name->starts_with("data:")) return std::nullopt;
  if (std::ranges::any_of(*name, [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
    return std::nullopt;
  }
  const std::filesystem::path path = std::filesystem::path(*name).lexically_normal();
  if (path.is_absolute() || *path.begin() == "..") return std::nullopt;
  return path.string();
}

}  // namespace relumbre
