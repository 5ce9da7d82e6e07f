/// Values of a TOML table, checked; errors name the file, the line and the key. For .cpp files
/// only: toml++ stays out of public interfaces.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "relumbre/experiment/checked_toml.h"

namespace relumbre::toml_fields {

/// Text of others for a message: control characters and what is long are left out.
std::string printable(std::string_view text);

/// Throws FileError: parse errors with their line.
toml::table parse(std::string_view text, const std::string& file);

/// A table, what errors call it ("" or "factors."), and the file they name.
struct Fields {
  const toml::table& table;
  std::string prefix;
  const std::string& file;

  /// Throws FileError "FILE:LINE: reason".
  [[noreturn]] void fail(const toml::node& at, const std::string& reason) const;
  /// Throws FileError for a key that is not among these, naming it.
  void allow_only(std::span<const std::string_view> keys) const;
  /// None if there is none; throws FileError if it is no table.
  [[nodiscard]] const toml::node* find(std::string_view key) const;
  /// Throws FileError, at the table's line, if there is none.
  [[nodiscard]] const toml::node& require(std::string_view key) const;

  [[nodiscard]] std::int64_t integer(std::string_view key, const toml::node& node, std::int64_t low,
                                     std::int64_t high) const;
  [[nodiscard]] std::string text(std::string_view key, const toml::node& node) const;
  /// Calls level(node) for each element of a list of 1 to 1,000, or for the node itself.
  void for_each(std::string_view key, const toml::node& node,
                const std::function<void(const toml::node&)>& level) const;
};

}  // namespace relumbre::toml_fields
