#include "relumbre/stats/distributions.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>

namespace relumbre {

namespace {

// Errors as values (NaN, infinity, 0), since arguments are checked by whoever calls.
using Policy = boost::math::policies::policy<
    boost::math::policies::domain_error<boost::math::policies::ignore_error>,
    boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
    boost::math::policies::underflow_error<boost::math::policies::ignore_error>,
    boost::math::policies::promote_double<false>>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Below this a double soon loses digits.
constexpr double kSmall = 1e-290;

/// log Γ(a, x) / Γ(a), for x well above a: Legendre's continued fraction by Lentz's method
/// (Press et al., Numerical Recipes, §6.2).
double log_gamma_q(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1 - a, c = 1 / kTiny, d = 1 / b, h = d;
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    const double factor = d * c;
    h *= factor;
    if (std::abs(factor - 1) < 1e-16) break;
  }
  return a * std::log(x) - x - std::lgamma(a) + std::log(h);
}

/// log I_x(a, b) for small x: x^a (1−x)^b / (a B(a, b)) · Σ_n x^n Π_{k<n} (a+b+k) / (a+1+k), whose
/// terms are all positive (DLMF 8.17.8).
double log_beta_i(double a, double b, double x, double one_minus_x) {
  double term = 1, sum = 1;
  for (int k = 0; k < 100000 && term > 1e-17 * sum; ++k) {
    term *= x * (a + b + k) / (a + 1 + k);
    sum += term;
  }
  const double log_beta = std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b);
  return a * std::log(x) + b * std::log(one_minus_x) - std::log(a) - log_beta + std::log(sum);
}

}  // namespace

TailProbability fisher_tail(double f, double df1, double df2) {
  if (f == kInfinity) return {0, -kInfinity};
  // P(F ≥ f) = I_x(df2/2, df1/2), x = df2 / (df2 + df1 f).
  const double a = df2 / 2, b = df1 / 2, x = df2 / (df2 + df1 * f), y = df1 * f / (df2 + df1 * f);
  const double p =
      x < 0.5 ? boost::math::ibeta(a, b, x, Policy()) : boost::math::ibetac(b, a, y, Policy());
  if (p > 0.5) return {p, std::log1p(-boost::math::ibeta(b, a, y, Policy()))};
  return {p, p > kSmall ? std::log(p) : log_beta_i(a, b, x, y)};
}

TailProbability chi_squared_tail(double x, double df) {
  if (x == kInfinity) return {0, -kInfinity};
  const double p = boost::math::gamma_q(df / 2, x / 2, Policy());
  if (p > 0.5) return {p, std::log1p(-boost::math::gamma_p(df / 2, x / 2, Policy()))};
  return {p, p > kSmall ? std::log(p) : log_gamma_q(df / 2, x / 2)};
}

TailProbability normal_two_sided(double z) { return chi_squared_tail(z * z, 1); }

TailProbability normal_upper(double z) {
  const double p = boost::math::erfc(z / std::numbers::sqrt2, Policy()) / 2;
  return {p, p > kSmall ? std::log(p) : log_gamma_q(0.5, z * z / 2) - std::numbers::ln2};
}

double normal_quantile(double p) {
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * p, Policy());
}

}  // namespace relumbre
