// The value of a polynomial in two ways: by Horner's rule, which is a linear recurrence, and by the
// powers of x, which are a scan under multiplication. Their twin sums term by term in long double.

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "relumbre/scan/recurrence.h"

namespace {

struct Times {
  using value_type = double;
  [[nodiscard]] double identity() const { return 1; }
  double operator()(double a, double b) const { return a * b; }
};

/// c[0] + c[1]·x + c[2]·x² + ..., from the highest down: y ← x·y + c[i].
double by_horner(const std::vector<double>& c, double x) {
  std::vector<double> y(c.size());
  return relumbre::linear_recurrence(std::vector<double>(c.size(), x), c, y, 0.0,
                                     relumbre::Direction::kBackward);
}

double by_powers(const std::vector<double>& c, double x) {
  std::vector<double> terms(c.size(), x);
  relumbre::exclusive_scan(terms, terms, Times());  // 1, x, x², ...
  for (std::size_t i = 0; i < c.size(); ++i) terms[i] *= c[i];
  return relumbre::inclusive_scan(terms, terms);
}

double slowly(const std::vector<double>& c, double x) {
  long double sum = 0, power = 1;
  for (const double coefficient : c) {
    sum += static_cast<long double>(coefficient) * power;
    power *= static_cast<long double>(x);
  }
  return static_cast<double>(sum);
}

}  // namespace

int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coefficient(-1, 1);
  for (const std::size_t size : {0UL, 1UL, 2UL, 9UL, 100'003UL}) {
    std::vector<double> c(size);
    for (double& v : c) v = coefficient(random);
    for (const double x : {-1.0, -0.7, 0.0, 0.5, 0.9999, 1.0}) {
      const double expected = slowly(c, x);
      if (!(std::abs(by_horner(c, x) - expected) < 1e-9) ||
          !(std::abs(by_powers(c, x) - expected) < 1e-9)) {
        std::printf("polynomial: wrong for %zu coefficients at %g\n", size, x);
        return 1;
      }
    }
  }
  std::puts("polynomial: as term by term");
}
