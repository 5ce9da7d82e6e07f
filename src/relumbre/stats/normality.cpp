#include "relumbre/stats/normality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr std::size_t kShapiroMin = 3, kShapiroMax = 5000, kPearsonMin = 20;

void check(std::span<const double> values, std::size_t least, std::size_t most, const char* test) {
  if (values.size() < least || values.size() > most)
    throw ValueError(fmt::format("{}: {} values, it needs {} or more{}", test, values.size(), least,
                                 values.size() > most ? fmt::format(" and at most {}", most) : ""));
  for (const double v : values)
    if (!std::isfinite(v)) throw ValueError(fmt::format("{}: a value is {}", test, v));
  const auto [low, high] = std::ranges::minmax(values);
  if (low == high) throw ValueError(fmt::format("{}: all values are {}", test, low));
}

/// Σ c[i] x^i.
template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
  double sum = 0;
  for (std::size_t i = N; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

/// Royston's weights of the n/2 largest values, largest first; the smallest have the negatives.
std::vector<double> royston_weights(std::size_t n) {
  constexpr std::array c1{0.0, .221157, -.147981, -2.07119, 4.434685, -2.706056};
  constexpr std::array c2{0.0, .042981, -.293762, -1.752461, 5.682633, -3.582633};
  if (n == 3) return {std::numbers::sqrt2 / 2};
  const std::vector<double> scores = normal_scores(n);
  std::vector<double> weights(n / 2);
  double squares = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = scores[n - 1 - i];
    squares += 2 * weights[i] * weights[i];
  }
  const double size = std::sqrt(squares), u = 1 / std::sqrt(static_cast<double>(n));
  // The outermost one or two by polynomials, the others scaled so that all squares sum to 1.
  std::array<double, 2> outer{weights[0] / size + polynomial(c1, u),
                              weights[1] / size + polynomial(c2, u)};
  const std::size_t fitted = n > 5 ? 2 : 1;
  double rest = 1;
  for (std::size_t i = 0; i < fitted; ++i) {
    squares -= 2 * weights[i] * weights[i];
    rest -= 2 * outer[i] * outer[i];
  }
  const double scale = std::sqrt(squares / rest);
  for (std::size_t i = 0; i < weights.size(); ++i)
    weights[i] = i < fitted ? outer[i] : weights[i] / scale;
  return weights;
}

/// 1 − W, exact also where W is near 1; x is sorted.
double one_minus_w(std::span<const double> x, std::span<const double> weights) {
  const std::size_t n = x.size();
  const double range = x.back() - x.front();
  double mean = 0;
  for (const double v : x) mean += (v - x.front()) / range;
  mean /= static_cast<double>(n);
  double aa = 0, xx = 0, ax = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t mirror = n - 1 - i;
    const double a = i == mirror ? 0 : i < mirror ? -weights[i] : weights[mirror];
    const double v = (x[i] - x.front()) / range - mean;
    aa += a * a;
    xx += v * v;
    ax += a * v;
  }
  const double both = std::sqrt(aa * xx);
  return (both - ax) * (both + ax) / (aa * xx);
}

TailProbability royston_p(double w1, std::size_t n) {
  constexpr std::array g{-2.273, .459};
  constexpr std::array c3{.544, -.39978, .025054, -6.714e-4};
  constexpr std::array c4{1.3822, -.77857, .062767, -.0020322};
  constexpr std::array c5{-1.5861, -.31082, -.083751, .0038915};
  constexpr std::array c6{-.4803, -.082676, .0030302};
  const auto size = static_cast<double>(n);
  if (n == 3) {
    const double p =
        6 / std::numbers::pi * (std::asin(std::sqrt(1 - w1)) - std::asin(std::sqrt(0.75)));
    return {std::max(p, 0.0), std::log(std::max(p, 0.0))};
  }
  double y = std::log(w1), mean = 0, deviation = 0;
  if (n <= 11) {
    const double gamma = polynomial(g, size);
    if (y >= gamma) return {1e-99, std::log(1e-99)};  // beyond the approximation's range
    y = -std::log(gamma - y);
    mean = polynomial(c3, size);
    deviation = std::exp(polynomial(c4, size));
  } else {
    mean = polynomial(c5, std::log(size));
    deviation = std::exp(polynomial(c6, std::log(size)));
  }
  return normal_upper((y - mean) / deviation);
}

struct Moments {
  double skewness = 0, kurtosis = 0;
};

Moments moments(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double m2 = 0, m3 = 0, m4 = 0;
  for (const double v : values) {
    const double d = v - mean, dd = d * d;
    m2 += dd / n;
    m3 += dd * d / n;
    m4 += dd * dd / n;
  }
  return {m3 / std::pow(m2, 1.5), m4 / (m2 * m2)};
}

/// D'Agostino 1970.
double skewness_score(double skewness, double n) {
  const double y = skewness * std::sqrt((n + 1) * (n + 3) / (6 * (n - 2)));
  const double beta2 =
      3 * (n * n + 27 * n - 70) * (n + 1) * (n + 3) / ((n - 2) * (n + 5) * (n + 7) * (n + 9));
  const double w2 = std::sqrt(2 * (beta2 - 1)) - 1;
  return std::asinh(y / std::sqrt(2 / (w2 - 1))) / std::sqrt(std::log(w2) / 2);
}

/// Anscombe and Glynn 1983.
double kurtosis_score(double kurtosis, double n) {
  const double expected = 3 * (n - 1) / (n + 1);
  const double variance = 24 * n * (n - 2) * (n - 3) / ((n + 1) * (n + 1) * (n + 3) * (n + 5));
  const double x = (kurtosis - expected) / std::sqrt(variance);
  const double beta1 = 6 * (n * n - 5 * n + 2) / ((n + 7) * (n + 9)) *
                       std::sqrt(6 * (n + 3) * (n + 5) / (n * (n - 2) * (n - 3)));
  const double a = 6 + 8 / beta1 * (2 / beta1 + std::sqrt(1 + 4 / (beta1 * beta1)));
  const double root = std::cbrt((1 - 2 / a) / (1 + x * std::sqrt(2 / (a - 4))));
  return (1 - 2 / (9 * a) - root) / std::sqrt(2 / (9 * a));
}

}  // namespace

std::vector<double> normal_scores(std::size_t n) {
  std::vector<double> scores(n);
  for (std::size_t i = 0; i < n; ++i)
    scores[i] = normal_quantile((static_cast<double>(i) + 0.625) / (static_cast<double>(n) + 0.25));
  return scores;
}

NormalityTest shapiro_wilk(std::span<const double> values) {
  check(values, kShapiroMin, kShapiroMax, "Shapiro-Wilk");
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  const double w1 = one_minus_w(sorted, royston_weights(sorted.size()));
  return {1 - w1, royston_p(w1, sorted.size())};
}

NormalityTest dagostino_pearson(std::span<const double> values) {
  check(values, kPearsonMin, values.size(), "D'Agostino-Pearson");
  const Moments shape = moments(values);
  const auto n = static_cast<double>(values.size());
  const double skewed = skewness_score(shape.skewness, n);
  const double tailed = kurtosis_score(shape.kurtosis, n);
  const double k2 = skewed * skewed + tailed * tailed;
  return {k2, chi_squared_tail(k2, 2)};
}

}  // namespace relumbre
