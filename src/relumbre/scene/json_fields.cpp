#include "relumbre/scene/json_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 64;

/// Drops the "[json.exception...] " in front of the library's messages, and control characters.
std::string one_line(std::string message) {
  const auto end = message.find("] ");
  if (message.starts_with('[') && end != std::string::npos) message.erase(0, end + 2);
  std::ranges::replace_if(
      message, [](unsigned char c) { return c < 0x20; }, ' ');
  return message;
}

bool fits_float(const json& value) {
  if (!value.is_number()) return false;
  return std::abs(value.get<double>()) <= static_cast<double>(std::numeric_limits<float>::max());
}

}  // namespace

json parse_json(std::string_view text, const std::string& file_name) {
  const auto limit_depth = [&](int depth, json::parse_event_t, json&) {
    if (depth > kMaxDepth) throw FileError(file_name, "JSON is nested too deeply");
    return true;
  };
  try {
    return json::parse(text, limit_depth);
  } catch (const json::exception& error) {
    throw FileError(file_name, "not valid JSON: " + one_line(error.what()));
  }
}

JsonFields::JsonFields(const json& object, std::string file_name, std::string where)
    : object_(object), file_name_(std::move(file_name)), where_(std::move(where)) {
  if (!object_.is_object()) fail("is not a JSON object");
}

void JsonFields::allow_only(std::initializer_list<std::string_view> keys) const {
  for (const auto& item : object_.items()) {
    if (std::ranges::find(keys, std::string_view(item.key())) == keys.end()) {
      fail(item.key(), "is not known here");
    }
  }
}

float JsonFields::number(std::string_view key) const {
  const json& value = at(key);
  if (!fits_float(value)) fail(key, "must be a finite number");
  return static_cast<float>(value.get<double>());
}

float JsonFields::number(std::string_view key, float fallback) const {
  return has(key) ? number(key) : fallback;
}

std::size_t JsonFields::index(std::string_view key, std::size_t limit) const {
  const json& value = at(key);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= limit) {
    fail(key, "must be a whole number below " + std::to_string(limit));
  }
  return value.get<std::size_t>();
}

std::size_t JsonFields::index(std::string_view key, std::size_t limit, std::size_t fallback) const {
  return has(key) ? index(key, limit) : fallback;
}

std::vector<float> JsonFields::numbers(std::string_view key, std::size_t count) const {
  const json& value = at(key);
  if (!value.is_array() || value.size() != count || !std::ranges::all_of(value, fits_float)) {
    fail(key, "must be an array of " + std::to_string(count) + " finite numbers");
  }
  std::vector<float> numbers;
  for (const json& number : value) numbers.push_back(static_cast<float>(number.get<double>()));
  return numbers;
}

Vec3f JsonFields::vec3(std::string_view key) const {
  const std::vector<float> v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

Vec3f JsonFields::vec3(std::string_view key, const Vec3f& fallback) const {
  return has(key) ? vec3(key) : fallback;
}

std::string JsonFields::text(std::string_view key) const {
  const json& value = at(key);
  if (!value.is_string()) fail(key, "must be a string");
  return value.get<std::string>();
}

std::string JsonFields::text(std::string_view key, std::string fallback) const {
  return has(key) ? text(key) : fallback;
}

bool JsonFields::boolean(std::string_view key, bool fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_boolean()) fail(key, "must be true or false");
  return at(key).get<bool>();
}

void JsonFields::fail(std::string_view reason) const {
  throw FileError(file_name_,
                  where_.empty() ? std::string(reason) : where_ + ": " + std::string(reason));
}

void JsonFields::fail(std::string_view key, std::string_view reason) const {
  fail("key '" + one_line(std::string(key.substr(0, 60))) + "' " + std::string(reason));
}

JsonFields JsonFields::object(std::string_view key) const {
  const json& value = at(key);
  if (!value.is_object()) fail(key, "must be an object");
  return {value, file_name_, where_.empty() ? std::string(key) : where_ + ": " + std::string(key)};
}

const json& JsonFields::at(std::string_view key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) fail(key, "is missing");
  return *found;
}

}  // namespace relumbre
