/// Checked access to JSON that somebody else wrote: every error names the file and the key.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// The parsed text. Nesting deeper than 64 is refused, so that no reader downstream can run out of
/// stack. Throws FileError with the parser's reason on one line.
nlohmann::json parse_json(std::string_view text, const std::string& file_name);

/// One object of a JSON file. Every accessor throws FileError "FILE: WHERE: key 'k' ..." where the
/// value is missing or not what is asked for. Refers to the object: keep it alive.
class JsonFields {
 public:
  /// `where` names the object in error messages and may be empty. Throws unless it is an object.
  JsonFields(const nlohmann::json& object, std::string file_name, std::string where);

  /// Throws FileError naming the first key that is not in the list.
  void allow_only(std::initializer_list<std::string_view> keys) const;

  [[nodiscard]] bool has(std::string_view key) const { return object_.contains(key); }
  /// Finite and within the range of float.
  [[nodiscard]] float number(std::string_view key) const;
  [[nodiscard]] float number(std::string_view key, float fallback) const;
  /// A whole number in [0, limit).
  [[nodiscard]] std::size_t index(std::string_view key, std::size_t limit) const;
  [[nodiscard]] std::size_t index(std::string_view key, std::size_t limit,
                                  std::size_t fallback) const;
  /// An array of `count` finite numbers.
  [[nodiscard]] std::vector<float> numbers(std::string_view key, std::size_t count) const;
  /// Three finite numbers.
  [[nodiscard]] Vec3f vec3(std::string_view key) const;
  [[nodiscard]] Vec3f vec3(std::string_view key, const Vec3f& fallback) const;
  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] std::string text(std::string_view key, std::string fallback) const;
  [[nodiscard]] bool boolean(std::string_view key, bool fallback) const;

  /// The value behind the key, whatever it is.
  [[nodiscard]] const nlohmann::json& at(std::string_view key) const;
  /// The object behind the key.
  [[nodiscard]] JsonFields object(std::string_view key) const;

  [[noreturn]] void fail(std::string_view reason) const;
  [[noreturn]] void fail(std::string_view key, std::string_view reason) const;

 private:
  const nlohmann::json& object_;
  std::string file_name_, where_;
};

}  // namespace relumbre
