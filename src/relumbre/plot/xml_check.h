/// Is a text well-formed XML? For tests.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace relumbre {

/// What is wrong with elements, attributes and entities of `xml`; empty if nothing is. Knows what
/// this library writes: no comments, no declarations, no CDATA.
inline std::string xml_fault(std::string_view xml) {
  std::vector<std::string> open;
  bool has_root = false;
  const auto bad_text = [](std::string_view text) {
    for (std::size_t i = text.find('&'); i != text.npos; i = text.find('&', i + 1)) {
      const std::string_view rest = text.substr(i);
      if (!rest.starts_with("&amp;") && !rest.starts_with("&lt;") && !rest.starts_with("&gt;") &&
          !rest.starts_with("&quot;"))
        return true;
    }
    return text.find('>') != text.npos;
  };
  for (std::size_t at = 0; at < xml.size();) {
    const std::size_t tag = xml.find('<', at);
    const std::string_view text = xml.substr(at, tag == xml.npos ? tag : tag - at);
    if (bad_text(text)) return "bad text: " + std::string(text);
    if (open.empty() && text.find_first_not_of(" \n") != text.npos) return "text outside the root";
    if (tag == xml.npos) break;
    const std::size_t end = xml.find('>', tag);
    if (end == xml.npos) return "a tag that does not end";
    std::string_view inner = xml.substr(tag + 1, end - tag - 1);
    at = end + 1;
    if (inner.starts_with('/')) {
      if (open.empty() || open.back() != inner.substr(1)) return "ends: " + std::string(inner);
      open.pop_back();
      continue;
    }
    const bool alone = inner.ends_with('/');
    if (alone) inner.remove_suffix(1);
    if (open.empty() && has_root) return "two roots";
    has_root = true;
    const std::size_t name = inner.find(' ');
    if (!alone) open.emplace_back(inner.substr(0, name));
    std::string_view attributes = name == inner.npos ? "" : inner.substr(name);
    while (!attributes.empty()) {  // ' name="value"' each
      const std::size_t equals = attributes.find("=\"");
      if (attributes[0] != ' ' || equals == attributes.npos || equals < 2)
        return "attributes: " + std::string(inner);
      const std::size_t close = attributes.find('"', equals + 2);
      if (close == attributes.npos) return "attributes: " + std::string(inner);
      if (bad_text(attributes.substr(equals + 2, close - equals - 2)))
        return "attributes: " + std::string(inner);
      attributes.remove_prefix(close + 1);
    }
  }
  return open.empty() ? (has_root ? "" : "no root") : "not ended: " + open.back();
}

}  // namespace relumbre
