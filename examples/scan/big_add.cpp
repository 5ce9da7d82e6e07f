// Sums of numbers of many digits: whether a digit (of 32 bits) gets a carry is a scan over what
// each digit does with one (Ladner and Fischer 1980). Its twin adds from the right, as at school.

#include <cstdint>
#include <cstdio>
#include <random>
#include <vector>

#include "relumbre/base/parallel.h"
#include "relumbre/scan/scan.h"

namespace {

using Number = std::vector<std::uint32_t>;  // the lowest digit first

/// What a run of digits makes of the carry that comes in.
enum class Carry : std::uint8_t { kStops, kPasses, kMakes };
struct ThenCarry {
  using value_type = Carry;
  static constexpr bool exact = true;
  [[nodiscard]] Carry identity() const { return Carry::kPasses; }
  Carry operator()(Carry low, Carry high) const { return high == Carry::kPasses ? low : high; }
};

/// a + b of equally many digits; the result has one more.
Number add(const Number& a, const Number& b) {
  constexpr std::size_t kGrain = 1 << 14;
  std::vector<Carry> carry(a.size());
  relumbre::parallel_for(0, a.size(), kGrain, [&](std::size_t i) {
    const std::uint64_t sum = std::uint64_t{a[i]} + b[i];
    carry[i] = sum > UINT32_MAX    ? Carry::kMakes
               : sum == UINT32_MAX ? Carry::kPasses
                                   : Carry::kStops;
  });
  const Carry last = relumbre::exclusive_scan(carry, carry, ThenCarry());
  Number sum(a.size() + 1);
  relumbre::parallel_for(0, a.size(), kGrain, [&](std::size_t i) {
    sum[i] = a[i] + b[i] + (carry[i] == Carry::kMakes ? 1 : 0);
  });
  sum.back() = last == Carry::kMakes ? 1 : 0;
  return sum;
}

Number add_slowly(const Number& a, const Number& b) {
  Number sum;
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    carry += std::uint64_t{a[i]} + b[i];
    sum.push_back(static_cast<std::uint32_t>(carry));
    carry >>= 32;
  }
  sum.push_back(static_cast<std::uint32_t>(carry));
  return sum;
}

}  // namespace

int main() {
  std::mt19937 random(1);
  for (const std::size_t digits : {0UL, 1UL, 2UL, 63UL, 200'003UL}) {
    for (const bool long_carries : {false, true}) {
      Number a(digits), b(digits);
      for (std::size_t i = 0; i < digits; ++i) {
        a[i] = static_cast<std::uint32_t>(random());
        b[i] = long_carries ? ~a[i] : static_cast<std::uint32_t>(random());
      }
      if (long_carries && digits > 0) b[0] = a[0] == 0 ? 0 : ~a[0] + 1;  // runs through to the end
      if (add(a, b) != add_slowly(a, b)) {
        std::printf("big_add: wrong for %zu digits\n", digits);
        return 1;
      }
    }
  }
  std::puts("big_add: as at school");
}
