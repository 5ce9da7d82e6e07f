#include "relumbre/experiment/ascii_form.h"

#include <cstddef>

namespace relumbre {

namespace {

constexpr std::string_view kDigits = "0123456789abcdef";

}  // namespace

std::string ascii_form(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && c != '~') {
      out += c;
    } else {
      out += '~';
      out += kDigits[byte >> 4];
      out += kDigits[byte & 15];
    }
  }
  return out;
}

std::string from_ascii_form(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool room = text[at] == '~' && text.size() - at > 2;
    const std::size_t high = room ? kDigits.find(text[at + 1]) : kDigits.npos;
    const std::size_t low = room ? kDigits.find(text[at + 2]) : kDigits.npos;
    if (high == kDigits.npos || low == kDigits.npos) {
      out += text[at];
    } else {
      out += static_cast<char>(high << 4 | low);
      at += 2;
    }
  }
  return out;
}

}  // namespace relumbre
