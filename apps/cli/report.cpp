#include "cli/report.h"

#include <cmath>
#include <cstdio>

#include "relumbre/base/atomic_file.h"

namespace relumbre::cli {

void Report::open(const std::string& json_file) { json_file_ = json_file; }

void Report::close() {
  if (json_file_.empty()) return;
  const std::string text = json_.dump(2) + "\n";
  if (json_file_ == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
  } else {
    write_file(json_file_, text);
  }
}

void Report::section(std::string_view key, std::string_view title) {
  section_ = key;
  print(title);
}

void Report::warn(const std::string& text) {
  json_["warnings"].push_back(text);
  fmt::print(stderr, "warning: {}\n", text);
}

void Report::print(std::string_view line) const {
  fmt::print(json_file_ == "-" ? stderr : stdout, "{}\n", line);
}

std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, ",");
  return text;
}

std::string bytes_text(std::uint64_t bytes) {
  const char* const units[] = {"B", "kB", "MB", "GB", "TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1000 && unit < 4) value /= 1000, ++unit;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, units[unit]);
}

std::string seconds_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.1f} µs", seconds * 1e6);
  if (seconds < 1) return fmt::format("{:.2f} ms", seconds * 1e3);
  if (seconds < 60) return fmt::format("{:.1f} s", seconds);
  const double whole = std::floor(seconds + 0.5);
  return fmt::format("{:.0f} min {:02.0f} s", std::floor(whole / 60), std::fmod(whole, 60));
}

std::string percent_text(double fraction) { return fmt::format("{:.3g} %", fraction * 100); }

}  // namespace relumbre::cli
