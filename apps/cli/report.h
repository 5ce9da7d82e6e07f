/// The figures a subcommand prints, once for people and once as JSON.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace relumbre::cli {

class Report {
 public:
  /// `json_file`: empty for none, "-" for standard output (people's lines then go to standard
  /// error).
  void open(const std::string& json_file);
  /// Writes the JSON.
  void close();

  /// A titled group: later figures belong to it, in JSON under `key`.
  void section(std::string_view key, std::string_view title);
  /// One figure: "  label   text", and json[section][key] = value.
  template <class T>
  void figure(std::string_view key, std::string_view label, const T& value, std::string_view text) {
    group()[std::string(key)] = value;
    print(fmt::format("  {:<28} {}", label, text));
  }
  template <class T>
  void figure(std::string_view key, std::string_view label, const T& value) {
    figure(key, label, value, fmt::format("{}", value));
  }
  /// A sentence for people only.
  void note(std::string_view text) { print(text); }
  /// "warning: ..." to standard error, and json["warnings"].
  void warn(const std::string& text);
  nlohmann::json& json() { return json_; }

 private:
  nlohmann::json& group() { return section_.empty() ? json_ : json_[section_]; }
  void print(std::string_view line) const;

  nlohmann::json json_ = nlohmann::json::object();
  std::string json_file_, section_;
};

/// Seconds since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// 1234567 -> "1,234,567".
std::string grouped(std::uint64_t value);
/// 1234567 -> "1.2 MB".
std::string bytes_text(std::uint64_t bytes);
/// 0.00123 -> "1.23 ms"; 75 -> "1 min 15 s".
std::string seconds_text(double seconds);
std::string percent_text(double fraction);

}  // namespace relumbre::cli
