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

std::string assumption_reading(const ResponseAnalysis& analysis) {
  const bool normal = analysis.shapiro.value && analysis.shapiro.value->p.p >= kAlpha;
  const bool equal = std::ranges::all_of(analysis.factors, [](const FactorAnalysis& factor) {
    return factor.brown_forsythe.value && factor.brown_forsythe.value->p.p >= kAlpha;
  });
  if (normal && equal)
    return "Residuals pass as normal and of equal variance: the analysis of variance rests on what "
           "it assumes.";
  return fmt::format(
      "Residuals are {} and {}: take F and its p as description, and rely on the "
      "tests by ranks and on the sizes of the effects.",
      normal ? "normal" : "not normal", equal ? "of equal variance" : "not of equal variance");
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
