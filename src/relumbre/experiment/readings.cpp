#include "relumbre/experiment/readings.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "relumbre/experiment/html.h"

namespace relumbre {

namespace {

constexpr double kLarge = 0.14, kMedium = 0.06, kSmall = 0.01;  // Cohen 1988, §8.2
constexpr double kAlpha = 0.05;

const char* size_of_effect(double eta2) {
  if (eta2 >= kLarge) return "a large effect";
  if (eta2 >= kMedium) return "a medium effect";
  return eta2 >= kSmall ? "a small effect" : "it hardly matters here";
}

std::string alone_reading(const Outcome<AllElseEqual>& alone) {
  if (!alone.value) return "";
  if (alone.value->largest == 0) return " All else equal, changing it changes nothing.";
  return fmt::format(
      " All else equal, changing it changes the response by {} in the median and by {} at most.",
      html::change(alone.value->median), html::change(alone.value->largest));
}

std::string factor_reading(const ResponseAnalysis& analysis, std::size_t f) {
  const FactorAnalysis& factor = analysis.factors[f];
  std::string sentence = "<b>" + html::text(analysis.table.factors[f].name) + "</b>";
  if (analysis.main.value) {
    const double eta2 = analysis.main.value->terms[f].eta2;
    sentence += fmt::format(" explains {} of the variance of {}: {}.", html::percent(eta2),
                            html::text(analysis.table.response), size_of_effect(eta2));
  }
  if (factor.kruskal.value)
    sentence += fmt::format(" By ranks ε² = {}.", html::number(factor.kruskal.value->epsilon2));
  return sentence + alone_reading(factor.alone);
}

/// Factors, the one that explains most first.
std::vector<std::size_t> by_effect(const ResponseAnalysis& analysis) {
  std::vector<std::size_t> order(analysis.factors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (analysis.main.value)
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](std::size_t f) { return analysis.main.value->terms[f].eta2; });
  return order;
}

std::string interaction_reading(const Anova& pairs, std::size_t factors) {
  const auto largest =
      std::ranges::max_element(pairs.terms.begin() + static_cast<std::ptrdiff_t>(factors),
                               pairs.terms.end(), {}, &AnovaTerm::eta2);
  if (largest == pairs.terms.end()) return "";
  return fmt::format("The strongest interaction is {}, {} of the variance: {}.",
                     html::text(largest->name), html::percent(largest->eta2),
                     largest->eta2 >= kSmall ? "the effect of one depends on the other"
                                             : "factors act nearly independently");
}

/// What tests of an assumption of the analysis of variance say together.
enum class Verdict { kNotTested, kNoDeparture, kDeparture };

template <class Test>
Verdict verdict_of(const Outcome<Test>& test) {
  if (!test.value) return Verdict::kNotTested;
  return test.value->p.p >= kAlpha ? Verdict::kNoDeparture : Verdict::kDeparture;
}

/// By Shapiro and Wilk, or where there are too many residuals for them by D'Agostino and Pearson.
Verdict normality(const ResponseAnalysis& analysis) {
  const Verdict shapiro = verdict_of(analysis.shapiro);
  return shapiro == Verdict::kNotTested ? verdict_of(analysis.dagostino) : shapiro;
}

/// One factor whose variances differ is enough.
Verdict equal_variances(const ResponseAnalysis& analysis) {
  Verdict all = Verdict::kNotTested;
  for (const FactorAnalysis& factor : analysis.factors)
    all = std::max(all, verdict_of(factor.brown_forsythe));
  return all;
}

std::string assumption_reading(const ResponseAnalysis& analysis) {
  constexpr const char* kNormal[] = {
      "Whether the residuals are normal was not tested",
      "No departure of the residuals from a normal distribution was found",
      "The residuals are not normal"};
  constexpr const char* kEqual[] = {"whether their variances are equal was not tested",
                                    "no difference between their variances was found",
                                    "their variances are not equal"};
  const Verdict normal = normality(analysis), equal = equal_variances(analysis);
  const bool clean = normal == Verdict::kNoDeparture && equal == Verdict::kNoDeparture;
  return fmt::format("{}, and {}{}.", kNormal[static_cast<int>(normal)],
                     kEqual[static_cast<int>(equal)],
                     clean ? ""
                           : ": take F and its p as description, and rely on the tests by ranks "
                             "and on the sizes of the effects");
}

}  // namespace

std::vector<std::string> readings(const ResponseAnalysis& analysis) {
  std::vector<std::string> sentences;
  for (const std::size_t f : by_effect(analysis)) sentences.push_back(factor_reading(analysis, f));
  if (analysis.main.value)
    sentences.push_back(fmt::format(
        "Together the factors, each by itself, explain {} of the variance.",
        html::percent(1 - analysis.main.value->residual_ss / analysis.main.value->total_ss)));
  if (analysis.pairs.value && analysis.factors.size() > 1)
    sentences.push_back(interaction_reading(*analysis.pairs.value, analysis.factors.size()));
  if (analysis.main.value) sentences.push_back(assumption_reading(analysis));
  return sentences;
}

}  // namespace relumbre
