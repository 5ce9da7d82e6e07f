#include "relumbre/experiment/toml_fields.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/experiment/ascii_form.h"

namespace relumbre::toml_fields {

namespace {

constexpr std::size_t kMostLevels = 1000;

std::size_t line_of(const toml::source_region& source) { return source.begin.line; }

std::string type_of(const toml::node& node) {
  std::ostringstream name;
  name << node.type();
  return name.str();
}

}  // namespace

std::string printable(std::string_view text) {
  constexpr std::size_t kMost = 80;
  std::string out(text.substr(0, kMost));
  std::ranges::replace_if(
      out, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text.size() > kMost ? out + "…" : out;
}

toml::table parse(std::string_view text, const std::string& file) {
  // Outside of strings, toml++ 3.3 runs into undefined behaviour over letters beyond ASCII.
  try {
    return toml::parse(ascii_form(text), file);
  } catch (const toml::parse_error& error) {
    throw FileError(file, line_of(error.source()), printable(from_ascii_form(error.description())));
  } catch (const std::logic_error&) {  // see checked_toml.h
    throw FileError(file, "this is no TOML: a key or a value begins with what none can begin with");
  }
}

void Fields::fail(const toml::node& at, const std::string& reason) const {
  throw FileError(file, line_of(at.source()), reason);
}

void Fields::allow_only(std::span<const std::string_view> keys) const {
  for (const auto& [key, node] : table)
    if (std::ranges::find(keys, key.str()) == keys.end())
      throw FileError(
          file, line_of(key.source()),
          fmt::format("unknown key {}{}", prefix, printable(from_ascii_form(key.str()))));
}

const toml::node* Fields::find(std::string_view key) const { return table.get(key); }

const toml::node& Fields::require(std::string_view key) const {
  if (const toml::node* node = find(key)) return *node;
  throw FileError(file, line_of(table.source()), fmt::format("{}{} is missing", prefix, key));
}

std::int64_t Fields::integer(std::string_view key, const toml::node& node, std::int64_t low,
                             std::int64_t high) const {
  const auto value = node.value_exact<std::int64_t>();
  if (!value)
    fail(node, fmt::format("{}{}: expected an integer, found {}", prefix, key, type_of(node)));
  if (*value < low || *value > high)
    fail(node, fmt::format("{}{}: {} is not from {} to {}", prefix, key, *value, low, high));
  return *value;
}

std::string Fields::text(std::string_view key, const toml::node& node) const {
  const auto value = node.value_exact<std::string>();
  if (!value)
    fail(node, fmt::format("{}{}: expected a string, found {}", prefix, key, type_of(node)));
  return from_ascii_form(*value);
}

void Fields::for_each(std::string_view key, const toml::node& node,
                      const std::function<void(const toml::node&)>& level) const {
  const toml::array* list = node.as_array();
  if (list == nullptr) {
    level(node);
    return;
  }
  if (list->empty()) fail(node, fmt::format("{}{}: the list is empty", prefix, key));
  if (list->size() > kMostLevels)
    fail(node, fmt::format("{}{}: {} levels, at most {}", prefix, key, list->size(), kMostLevels));
  for (const toml::node& element : *list) level(element);
}

}  // namespace relumbre::toml_fields
