/// Text in ASCII alone, and back: for a parser that is only safe with ASCII.
#pragma once

#include <string>
#include <string_view>

namespace relumbre {

/// Every byte beyond ASCII, and '~', becomes "~" and its two hexadecimal digits. Lines stay lines,
/// quotes stay quotes.
std::string ascii_form(std::string_view text);

/// The inverse. A '~' without two lowercase hexadecimal digits stays as it is.
std::string from_ascii_form(std::string_view text);

}  // namespace relumbre
