#include "relumbre/experiment/analysis.h"

#include <algorithm>
#include <map>

#include "relumbre/base/error.h"
#include "relumbre/stats/median.h"

namespace relumbre {

namespace {

template <class Compute>
auto outcome_of(const Progress& progress, Compute compute) -> Outcome<decltype(compute())> {
  progress.check();
  try {
    return {compute(), ""};
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    return {std::nullopt, error.what()};
  }
}

struct NamedFactor {
  const char* name;
  std::string (*level)(const ExperimentCell&);
};

constexpr NamedFactor kFactors[] = {
    {"scene", [](const ExperimentCell& c) { return c.scene; }},
    {"depth", [](const ExperimentCell& c) { return std::to_string(c.depth); }},
    {"resolution", cell_resolution},
    {"traversal", [](const ExperimentCell& c) { return c.traversal; }},
    {"gts", [](const ExperimentCell& c) { return std::to_string(c.gts); }},
    {"tile", [](const ExperimentCell& c) { return std::to_string(c.tile); }},
    {"lines", [](const ExperimentCell& c) { return std::to_string(c.lines); }},
};

/// The ranges of the response over the rows that agree in all factors but `varied`.
AllElseEqual all_else_equal(const Table& table, std::size_t varied) {
  std::map<std::vector<std::uint32_t>, std::pair<double, double>> extremes;
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    std::vector<std::uint32_t> others;
    for (std::size_t f = 0; f < table.factors.size(); ++f)
      if (f != varied) others.push_back(table.factors[f].rows[i]);
    const double v = table.values[i];
    const auto [place, is_new] = extremes.try_emplace(std::move(others), v, v);
    place->second = {std::min(place->second.first, v), std::max(place->second.second, v)};
  }
  std::vector<double> changes;
  for (const auto& [key, range] : extremes) {
    if (!(range.first > 0)) throw ValueError("a response is not positive");
    changes.push_back(range.second / range.first - 1);
  }
  return {median_of(changes), std::ranges::max(changes)};
}

FactorAnalysis analyse_factor(const ResponseAnalysis& analysis, std::size_t f,
                              const Progress& progress) {
  const Table& table = analysis.table;
  const Factor& factor = table.factors[f];
  FactorAnalysis result;
  if (analysis.main.value) {
    const std::vector<double>& residuals = analysis.main.value->residuals;
    result.brown_forsythe = outcome_of(progress, [&] { return brown_forsythe(residuals, factor); });
    result.bartlett = outcome_of(progress, [&] { return bartlett(residuals, factor); });
  }
  result.kruskal = outcome_of(progress, [&] { return kruskal_wallis(table.values, factor); });
  progress.check();
  if (result.kruskal.value) result.pairs = dunn(table.values, factor);
  result.alone = outcome_of(progress, [&] { return all_else_equal(table, f); });
  return result;
}

}  // namespace

Table response_table(std::span<const ExperimentCell> cells, const std::string& name,
                     double (*response)(const ExperimentCell&)) {
  if (cells.empty()) throw ValueError("the experiment has no cells");
  Table table{name, {}, {}};
  for (const ExperimentCell& cell : cells) table.values.push_back(response(cell));
  for (const NamedFactor& named : kFactors) {
    std::vector<std::string> labels;
    for (const ExperimentCell& cell : cells) labels.push_back(named.level(cell));
    Factor factor = make_factor(named.name, labels);
    if (factor.levels.size() > 1) table.factors.push_back(std::move(factor));
  }
  return table;
}

ResponseAnalysis analyse_response(Table table, const Progress& progress) {
  ResponseAnalysis result;
  result.table = std::move(table);
  result.main = outcome_of(progress, [&] { return anova(result.table, {}, progress); });
  result.pairs =
      outcome_of(progress, [&] { return anova(result.table, {.interactions = true}, progress); });
  if (result.main.value) {
    const std::vector<double>& residuals = result.main.value->residuals;
    result.shapiro = outcome_of(progress, [&] { return shapiro_wilk(residuals); });
    result.dagostino = outcome_of(progress, [&] { return dagostino_pearson(residuals); });
  }
  for (std::size_t f = 0; f < result.table.factors.size(); ++f)
    result.factors.push_back(analyse_factor(result, f, progress));
  return result;
}

}  // namespace relumbre
