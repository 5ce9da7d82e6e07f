/// Stands in for {fmt} on machines without it: what error messages need, without format
/// specifications. Only the GPU check is built with it.
#pragma once

#include <sstream>
#include <string>
#include <string_view>

namespace fmt {

template <class... Arguments>
std::string format(std::string_view pattern, const Arguments&... arguments) {
  std::ostringstream text;
  [[maybe_unused]] const auto up_to_field = [&] {
    const std::size_t open = pattern.find('{');
    text << pattern.substr(0, open);
    if (open == std::string_view::npos) return pattern = {}, void();
    const std::size_t close = pattern.find('}', open);
    pattern = close == std::string_view::npos ? std::string_view{} : pattern.substr(close + 1);
  };
  (..., (up_to_field(), text << arguments));
  text << pattern;
  return text.str();
}

}  // namespace fmt
