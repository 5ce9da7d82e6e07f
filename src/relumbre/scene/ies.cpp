#include "relumbre/scene/ies.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"

namespace relumbre {
namespace {

constexpr std::size_t kMaxAngles = 10'000;
constexpr std::size_t kMaxValues = 10'000'000;
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 28;

/// Walks over the text, first by lines (the header), then by numbers (the rest).
class IesText {
 public:
  IesText(std::string_view text, std::string file_name)
      : text_(text), file_name_(std::move(file_name)) {}

  [[nodiscard]] bool at_end() const { return position_ >= text_.size(); }

  std::string_view next_line() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", position_), text_.size());
    const std::string_view line = text_.substr(position_, end - position_);
    position_ = end;
    skip_line_break();
    return line;
  }

  double next_number(std::string_view what) {
    skip_separators();
    std::size_t end = position_;
    while (end < text_.size() && !is_separator(text_[end])) ++end;
    std::string_view token = text_.substr(position_, end - position_);
    if (token.empty()) fail("the file ends before the " + std::string(what));
    position_ = end;
    return to_number(token, what);
  }

  /// A whole number in [1, limit].
  std::size_t next_count(std::string_view what, std::size_t limit) {
    const double value = next_number(what);
    if (!(value >= 1 && value <= static_cast<double>(limit)) || value != std::floor(value)) {
      fail("the " + std::string(what) + " must be a whole number from 1 to " +
           std::to_string(limit));
    }
    return static_cast<std::size_t>(value);
  }

  /// A finite number in [low, high].
  float next_in(std::string_view what, float low, float high) {
    const double value = next_number(what);
    if (!(value >= static_cast<double>(low) && value <= static_cast<double>(high))) {
      fail("a value of the " + std::string(what) + " is out of range");
    }
    return static_cast<float>(value);
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file_name_, line_, reason);
  }

 private:
  static bool is_separator(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == '\f' || c == '\v';
  }

  void skip_line_break() {
    if (at_end()) return;
    if (text_[position_] == '\r' && position_ + 1 < text_.size() && text_[position_ + 1] == '\n') {
      ++position_;
    }
    ++position_;
    ++line_;
  }

  void skip_separators() {
    while (!at_end() && is_separator(text_[position_])) {
      if (text_[position_] == '\n' || text_[position_] == '\r') {
        skip_line_break();
      } else {
        ++position_;
      }
    }
  }

  double to_number(std::string_view token, std::string_view what) const {
    if (token.starts_with('+')) token.remove_prefix(1);
    double value = 0;
    const char* const end = token.data() + token.size();
    const auto [stopped, error] = std::from_chars(token.data(), end, value);
    if (error != std::errc{} || stopped != end || !std::isfinite(value)) {
      fail("expected a number for the " + std::string(what));
    }
    return value;
  }

  std::string_view text_;
  std::string file_name_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
};

/// Leaves the text behind the TILT line. The 1986 edition has no first line of its own, so the
/// header is whatever comes before TILT.
void skip_header(IesText& text) {
  while (!text.at_end()) {
    std::string_view line = text.next_line();
    while (line.starts_with(' ')) line.remove_prefix(1);
    if (!line.starts_with("TILT=")) continue;
    const std::size_t last = line.find_last_not_of(" \t");
    const std::string_view tilt = line.substr(0, last + 1);
    if (tilt != "TILT=NONE") {
      text.fail(std::string(tilt.substr(0, 40)) + " is not handled, only TILT=NONE");
    }
    return;
  }
  text.fail("not an IES LM-63 file: it has no TILT line");
}

void require_type_c(IesText& text) {
  const double type = text.next_number("photometric type");
  if (type == 1) return;
  if (type == 2) text.fail("photometry of type B is not handled, only type C");
  if (type == 3) text.fail("photometry of type A is not handled, only type C");
  text.fail("the photometric type must be 1 (type C)");
}

std::vector<float> read_angles(IesText& text, std::size_t count, std::string_view what, float low,
                               float high) {
  std::vector<float> angles;
  for (std::size_t i = 0; i < count; ++i) {
    angles.push_back(text.next_in(what, low, high));
    if (i > 0 && !(angles[i] > angles[i - 1])) {
      text.fail("the " + std::string(what) + " are not ascending");
    }
  }
  return angles;
}

/// Which symmetries LM-63 knows: about the axis, quadrants, either vertical plane, none.
void check_symmetry(const IesText& text, const std::vector<float>& horizontal) {
  const float first = horizontal.front(), last = horizontal.back();
  if (horizontal.size() == 1) return;
  if (first == 0 && (last == 90 || last == 180 || last == 360)) return;
  if (first == 90 && last == 270) return;
  text.fail("the horizontal angles must run 0 to 0, 90, 180 or 360, or 90 to 270");
}

/// Folds an azimuth in [0, 360) into the measured range.
float fold(float azimuth, const std::vector<float>& horizontal) {
  const float first = horizontal.front(), last = horizontal.back();
  if (first == last) return first;
  if (first == 90 && (azimuth < 90 || azimuth > 270)) {
    return azimuth < 90 ? 180 - azimuth : 540 - azimuth;
  }
  if (first == 0 && last <= 180 && azimuth > 180) azimuth = 360 - azimuth;
  if (first == 0 && last <= 90 && azimuth > 90) azimuth = 180 - azimuth;
  return std::clamp(azimuth, first, last);
}

struct Bracket {
  std::size_t low, high;
  float weight;  ///< of high
};

Bracket bracket(const std::vector<float>& angles, float angle) {
  const auto above = std::ranges::upper_bound(angles, angle);
  if (above == angles.begin()) return {0, 0, 0};
  const auto high = static_cast<std::size_t>(above - angles.begin());
  if (above == angles.end()) return {high - 1, high - 1, 0};
  return {high - 1, high, (angle - angles[high - 1]) / (angles[high] - angles[high - 1])};
}

}  // namespace

float IesProfile::relative(const Vec3f& local_direction) const {
  constexpr float to_degrees = 180 / std::numbers::pi_v<float>;
  constexpr float rounding = 1e-3F;  // degrees; a horizontal ray is still at 90
  const float vertical = to_degrees * std::acos(std::clamp(local_direction.z, -1.0F, 1.0F));
  if (!(vertical >= vertical_deg.front() - rounding)) return 0;
  if (!(vertical <= vertical_deg.back() + rounding)) return 0;
  float azimuth = to_degrees * std::atan2(local_direction.y, local_direction.x);
  if (azimuth < 0) azimuth += 360;

  const Bracket v = bracket(vertical_deg, vertical);
  const Bracket h = bracket(horizontal_deg, fold(azimuth, horizontal_deg));
  const auto along = [&](std::size_t row) {
    const float* values = candela.data() + row * vertical_deg.size();
    return std::lerp(values[v.low], values[v.high], v.weight);
  };
  return std::clamp(std::lerp(along(h.low), along(h.high), h.weight) / peak(), 0.0F, 1.0F);
}

float IesProfile::peak() const {
  return peak_candela > 0 ? peak_candela : std::ranges::max(candela);
}

IesProfile parse_ies(std::string_view text, const std::string& file_name) {
  IesText input(text, file_name);
  skip_header(input);

  input.next_number("number of lamps");
  input.next_number("lumens per lamp");
  float multiplier = input.next_in("candela multiplier", 1e-6F, 1e6F);
  const std::size_t verticals = input.next_count("number of vertical angles", kMaxAngles);
  const std::size_t horizontals = input.next_count("number of horizontal angles", kMaxAngles);
  if (verticals * horizontals > kMaxValues) input.fail("too many candela values");
  require_type_c(input);
  for (const char* what : {"units", "width", "length", "height"}) input.next_number(what);
  multiplier *= input.next_in("ballast factor", 1e-6F, 1e3F);
  multiplier *= input.next_in("ballast-lamp photometric factor", 1e-6F, 1e3F);
  input.next_number("input watts");

  IesProfile profile;
  profile.vertical_deg = read_angles(input, verticals, "vertical angles", 0, 180);
  profile.horizontal_deg = read_angles(input, horizontals, "horizontal angles", 0, 360);
  check_symmetry(input, profile.horizontal_deg);
  for (std::size_t i = 0; i < verticals * horizontals; ++i) {
    profile.candela.push_back(multiplier * input.next_in("candela values", 0, 1e12F));
  }
  profile.peak_candela = std::ranges::max(profile.candela);
  if (!(profile.peak_candela > 0)) input.fail("every candela value is 0");
  return profile;
}

IesProfile read_ies(const std::filesystem::path& file) {
  return parse_ies(read_file(file, kMaxBytes), file.string());
}

}  // namespace relumbre
