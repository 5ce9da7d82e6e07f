/// toml++ with its assertions as exceptions, in every build. Some depend on the text alone, such as
/// that a table's name begins with a letter, and toml++ 3.3 would otherwise end the program or,
/// with NDEBUG, assume that they hold. Every file that uses toml++ includes it from here.
#pragma once

#include <stdexcept>

namespace relumbre {

constexpr void check_toml(bool holds, const char* condition) {
  if (!holds) throw std::logic_error(condition);
}

}  // namespace relumbre

#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) ::relumbre::check_toml(static_cast<bool>(condition), #condition)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
