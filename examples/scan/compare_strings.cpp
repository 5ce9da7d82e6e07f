// Which of two strings comes first: the first difference decides, which is the fold of all the
// letters' differences under "the left one, unless it is none". Its twin is std::string's.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "relumbre/scan/scan.h"

namespace {

struct FirstDifference {
  using value_type = std::int8_t;
  static constexpr bool exact = true;
  [[nodiscard]] std::int8_t identity() const { return 0; }
  std::int8_t operator()(std::int8_t a, std::int8_t b) const { return a != 0 ? a : b; }
};

int sign(int v) { return (v > 0) - (v < 0); }

/// Negative, zero or positive, as a comes before, is or comes after b.
int compare(const std::string& a, const std::string& b) {
  const std::size_t common = std::min(a.size(), b.size());
  std::vector<std::int8_t> difference(common);
  for (std::size_t i = 0; i < common; ++i) {
    const auto x = static_cast<unsigned char>(a[i]), y = static_cast<unsigned char>(b[i]);
    difference[i] = static_cast<std::int8_t>((x > y) - (x < y));
  }
  const int first = relumbre::inclusive_scan(difference, difference, FirstDifference());
  return first != 0 ? first : (a.size() > b.size()) - (a.size() < b.size());
}

}  // namespace

int main() {
  std::mt19937 random(1);
  for (const std::size_t size : {0UL, 1UL, 2UL, 65UL, 300'007UL}) {
    for (int round = 0; round < 20; ++round) {
      std::string a(size, 'a');
      for (char& c : a) c = static_cast<char>(random());
      std::string b = a;
      if (size > 0 && round % 4 != 0) b[random() % size] = static_cast<char>(random());
      if (size > 0 && round % 4 == 2) b.resize(random() % size);
      if (compare(a, b) != sign(a.compare(b)) || compare(b, a) != sign(b.compare(a))) {
        std::printf("compare_strings: wrong for %zu letters\n", size);
        return 1;
      }
    }
  }
  std::puts("compare_strings: as std::string");
}
