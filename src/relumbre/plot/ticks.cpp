#include "relumbre/plot/ticks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

namespace relumbre {

namespace {

/// 10^e, correctly rounded for |e| ≤ 22 and nearly so beyond.
double power_of_ten(int e) { return e < 0 ? 1 / std::pow(10.0, -e) : std::pow(10.0, e); }

struct Step {
  int digit = 1, exponent = 0;
  [[nodiscard]] double value() const { return digit * power_of_ten(exponent); }
  [[nodiscard]] Step next() const {
    if (digit == 1) return {2, exponent};
    return digit == 2 ? Step{5, exponent} : Step{1, exponent + 1};
  }
};

/// Multiples k·step within [low, high] are those with first ≤ k ≤ last.
struct Multiples {
  double first = 0, last = 0;
  [[nodiscard]] double count() const { return last - first + 1; }
};

/// Ends that are a multiple but for rounding count as one.
Multiples multiples_within(double low, double high, double step) {
  constexpr double kSlack = 1e-9;
  return {std::ceil(low / step - kSlack), std::floor(high / step + kSlack)};
}

/// 10^exponent is written as a letter.
struct Unit {
  int exponent;
  const char* letter;
};

std::string linear_label(double value, const Step& step, double largest) {
  constexpr std::array<Unit, 4> units{{{12, "T"}, {9, "G"}, {6, "M"}, {3, "k"}}};
  if (value == 0) return "0";
  if (largest >= 1e15 || step.exponent < -6) return fmt::format("{:.6g}", value);
  for (const Unit& unit : units) {
    const bool fine = step.exponent < unit.exponent - 1 && unit.exponent > 3;
    if (largest < power_of_ten(std::max(4, unit.exponent)) || fine) continue;
    return fmt::format("{:.{}f}{}", value / power_of_ten(unit.exponent),
                       std::max(0, unit.exponent - step.exponent), unit.letter);
  }
  return fmt::format("{:.{}f}", value, std::max(0, -step.exponent));
}

std::string superscript(int number) {
  constexpr std::array digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number)))
    text += digits[static_cast<std::size_t>(c - '0')];
  return text;
}

std::string log_label(int digit, int exponent) {
  if (exponent >= -2 && exponent <= 3)
    return fmt::format("{:.{}f}", digit * power_of_ten(exponent), std::max(0, -exponent));
  const std::string power = "10" + superscript(exponent);
  return digit == 1 ? power : fmt::format("{}·{}", digit, power);
}

bool within(double value, double low, double high) {
  constexpr double kSlack = 1e-9;
  return value >= low * (1 - kSlack) && value <= high * (1 + kSlack);
}

/// The products of these digits and every `stride`-th power of ten.
std::vector<Tick> powers(double low, double high, std::span<const int> digits, int stride) {
  const int first = static_cast<int>(std::floor(std::log10(low))) - 1;
  const int last = static_cast<int>(std::ceil(std::log10(high)));
  std::vector<Tick> ticks;
  for (int e = first; e <= last; ++e)
    for (const int digit : digits) {
      const double value = digit * power_of_ten(e);
      if (within(value, low, high) && e % stride == 0)
        ticks.push_back({value, log_label(digit, e)});
    }
  return ticks;
}

constexpr std::array kAllDigits{1, 2, 3, 4, 5, 6, 7, 8, 9};

/// Adds the ticks between powers, without labels.
std::vector<Tick> with_minor(std::vector<Tick> ticks, double low, double high) {
  for (Tick& minor : powers(low, high, kAllDigits, 1)) {
    const auto same = [&](const Tick& t) { return std::abs(t.value / minor.value - 1) < 1e-9; };
    if (std::ranges::none_of(ticks, same)) ticks.push_back({minor.value, ""});
  }
  std::ranges::sort(ticks, {}, &Tick::value);
  return ticks;
}

}  // namespace

std::vector<Tick> linear_ticks(double low, double high, int most) {
  Step step{1, static_cast<int>(std::floor(std::log10((high - low) / most))) - 1};
  Multiples multiples = multiples_within(low, high, step.value());
  while (multiples.count() > most) {
    step = step.next();
    multiples = multiples_within(low, high, step.value());
  }
  const double largest = std::max(std::abs(low), std::abs(high));
  std::vector<Tick> ticks;
  for (int i = 0; i < static_cast<int>(multiples.count()); ++i) {
    const double k = (multiples.first + i) * step.digit;
    const double value =
        step.exponent < 0 ? k / power_of_ten(-step.exponent) : k * power_of_ten(step.exponent);
    ticks.push_back({value, linear_label(value, step, largest)});
  }
  return ticks;
}

std::vector<Tick> log_ticks(double low, double high, int most) {
  constexpr std::array one{1};
  constexpr std::array few{1, 2, 5};
  const double decades = std::log10(high) - std::log10(low);
  const int stride = std::max(1, static_cast<int>(std::ceil(decades / most)));
  std::vector<Tick> ticks = powers(low, high, one, stride);
  if (ticks.size() < 3) ticks = powers(low, high, few, 1);
  if (ticks.size() < 3) ticks = powers(low, high, kAllDigits, 1);
  if (ticks.size() < 2) return linear_ticks(low, high, most);
  return decades <= 6 ? with_minor(std::move(ticks), low, high) : ticks;
}

}  // namespace relumbre
