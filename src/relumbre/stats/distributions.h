/// Tails of the distributions that tests need, also where a double would be 0.
#pragma once

namespace relumbre {

/// The probability of a statistic at least as extreme. `p` is 0 where it is below what a double
/// holds; `log_p` is its natural logarithm and stays exact to about 12 digits there.
struct TailProbability {
  double p = 1, log_p = 0;
};

/// P(F ≥ f) of Fisher's F. df1, df2 > 0; f ≥ 0, also infinity.
TailProbability fisher_tail(double f, double df1, double df2);

/// P(X ≥ x) of χ². df > 0; x ≥ 0, also infinity.
TailProbability chi_squared_tail(double x, double df);

/// P(|Z| ≥ |z|) of the standard normal distribution.
TailProbability normal_two_sided(double z);

/// P(Z ≥ z) of the standard normal distribution.
TailProbability normal_upper(double z);

/// The z with P(Z ≤ z) = p, 0 < p < 1.
double normal_quantile(double p);

}  // namespace relumbre
