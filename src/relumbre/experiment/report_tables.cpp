#include "relumbre/experiment/report_tables.h"

#include <algorithm>

#include <fmt/format.h>

#include "relumbre/archsim/metrics.h"
#include "relumbre/experiment/html.h"

namespace relumbre {

namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string whole(double value) { return fmt::format("{:.0f}", value); }

/// 1920 as "1 920", with narrow spaces that do not break.
std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value), out;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) out += "\u202F";
    out += digits[i];
  }
  return out;
}

/// Whole MB from 100 on, four digits below.
std::string megabytes(std::uint64_t count, std::uint64_t bytes_each) {
  constexpr std::uint64_t kMega = 1'000'000;
  const std::uint64_t bytes = count * bytes_each;
  return bytes < 100 * kMega ? html::number(static_cast<double>(bytes) / kMega)
                             : grouped((bytes + kMega / 2) / kMega);
}

std::string anova_table(const Anova& result, const std::string& caption) {
  Rows rows;
  for (const AnovaTerm& term : result.terms)
    rows.push_back({html::text(term.name), std::to_string(term.df), html::number(term.ss),
                    html::number(term.ms), html::number(term.f), html::probability(term.p),
                    html::number(term.eta2), html::number(term.partial_eta2),
                    html::number(term.omega2)});
  rows.push_back({"residual", std::to_string(result.residual_df), html::number(result.residual_ss),
                  html::number(result.residual_ms), "", "",
                  html::number(result.residual_ss / result.total_ss), "", ""});
  rows.push_back({"total", std::to_string(result.total_df), html::number(result.total_ss), "", "",
                  "", "", "", ""});
  return html::table(caption, {"", "df", "SS", "MS", "F", "p", "η²", "partial η²", "ω²"}, rows);
}

std::string normality_row(const char* name, const Outcome<NormalityTest>& test, Rows& rows) {
  if (!test.value) return html::paragraph(fmt::format("{}: {}.", name, html::text(test.refusal)));
  rows.push_back({name, html::number(test.value->statistic), html::probability(test.value->p)});
  return "";
}

std::vector<std::string> variance_cells(const Outcome<VarianceTest>& test) {
  if (!test.value) return {"—", "—"};
  return {html::number(test.value->statistic), html::probability(test.value->p)};
}

std::string pairs_table(const Factor& factor, const std::vector<DunnPair>& pairs) {
  Rows rows;
  for (const DunnPair& pair : pairs)
    rows.push_back({html::text(factor.levels[pair.a] + " – " + factor.levels[pair.b]),
                    html::number(pair.z), html::probability(pair.p),
                    html::probability(pair.adjusted), html::number(pair.cliffs_delta)});
  return html::table("Dunn's pairs of " + html::text(factor.name),
                     {"pair", "z", "p", "p by Holm", "Cliff's δ"}, rows);
}

/// One scene's cells, summed.
struct SceneSums {
  std::string scene;
  std::uint64_t cells = 0, reads = 0, fetches = 0, tasks = 0;
};

std::vector<SceneSums> sums_by_scene(std::span<const ExperimentCell> cells) {
  std::vector<SceneSums> sums;
  for (const ExperimentCell& cell : cells) {
    auto found = std::ranges::find(sums, cell.scene, &SceneSums::scene);
    if (found == sums.end()) found = sums.insert(sums.end(), SceneSums{cell.scene});
    found->cells += 1;
    found->reads += cell_reads(cell);
    found->fetches += cell_fetches(cell);
    found->tasks += cell.tasks;
  }
  return sums;
}

}  // namespace

std::string facts_table(const std::vector<std::pair<std::string, std::string>>& facts,
                        std::span<const ExperimentCell> cells) {
  std::string out;
  for (const auto& [name, value] : facts)
    out += "<tr><td>" + html::text(name) + "</td><td style=\"text-align:left\">" +
           html::text(value) + "</td></tr>\n";
  const Table table = response_table(cells, "cells", cell_hit_rate);
  for (const Factor& factor : table.factors) {
    std::string levels;
    for (const std::string& level : factor.levels)
      levels += (levels.empty() ? "" : ", ") + html::text(level);
    out += "<tr><td>" + html::text(factor.name) + "</td><td style=\"text-align:left\">" + levels +
           "</td></tr>\n";
  }
  return "<table>\n" + out + "<tr><td>cells</td><td style=\"text-align:left\">" +
         grouped(cells.size()) + "</td></tr>\n</table>\n";
}

std::string machines_table(std::span<const ExperimentCell> cells) {
  Rows rows;
  for (const SceneSums& sums : sums_by_scene(cells)) {
    const double rate = hit_rate(sums.reads - sums.fetches, sums.reads);
    rows.push_back({html::text(sums.scene), grouped(sums.cells), html::number(rate),
                    grouped(sums.fetches), grouped(sums.reads), grouped(sums.tasks),
                    megabytes(sums.fetches, kWordBytes), megabytes(sums.reads, kWordBytes),
                    megabytes(sums.tasks, kRecordBytes)});
  }
  return html::table("Fetches from the memory of the octree, summed over the cells of a scene",
                     {"scene", "cells", "L", "M, proposed", "M, naive words", "M, naive pointers",
                      "MB, proposed", "MB, naive words", "MB, naive pointers"},
                     rows);
}

std::string anova_tables(const ResponseAnalysis& analysis) {
  if (!analysis.main.value) return html::paragraph(html::text(analysis.main.refusal) + ".");
  std::string out = anova_table(*analysis.main.value, "Factors alone, type II sums of squares");
  if (analysis.factors.size() < 2) return out;
  return out + html::folded("With the interactions of every two factors",
                            analysis.pairs.value
                                ? anova_table(*analysis.pairs.value, "Factors and interactions")
                                : html::paragraph(html::text(analysis.pairs.refusal) + "."));
}

std::string assumption_tables(const ResponseAnalysis& analysis) {
  if (!analysis.main.value) return "";
  Rows normality;
  std::string refusals = normality_row("Shapiro-Wilk W", analysis.shapiro, normality);
  refusals += normality_row("D'Agostino-Pearson K²", analysis.dagostino, normality);
  Rows variances;
  for (std::size_t f = 0; f < analysis.factors.size(); ++f) {
    std::vector<std::string>& row =
        variances.emplace_back(1, html::text(analysis.table.factors[f].name));
    for (const auto* test : {&analysis.factors[f].brown_forsythe, &analysis.factors[f].bartlett})
      for (std::string& cell : variance_cells(*test)) row.push_back(std::move(cell));
  }
  return html::table("Are the residuals normal?", {"test", "statistic", "p"}, normality) +
         refusals +
         html::table("Have they equal variances?",
                     {"factor", "Brown-Forsythe F", "p", "Bartlett χ²", "p"}, variances);
}

std::string kruskal_tables(const ResponseAnalysis& analysis) {
  Rows rows;
  std::string refusals, pairs;
  for (std::size_t f = 0; f < analysis.factors.size(); ++f) {
    const Factor& factor = analysis.table.factors[f];
    const Outcome<KruskalWallis>& test = analysis.factors[f].kruskal;
    if (!test.value) {
      refusals += html::paragraph(html::text(test.refusal) + ".");
      continue;
    }
    rows.push_back({html::text(factor.name), html::number(test.value->h), whole(test.value->df),
                    html::probability(test.value->p), html::number(test.value->epsilon2)});
    pairs += pairs_table(factor, analysis.factors[f].pairs);
  }
  return html::table("By ranks, corrected for ties", {"factor", "H", "df", "p", "ε²"}, rows) +
         refusals + html::folded("Which levels differ: Dunn's pairs with Holm's correction", pairs);
}

}  // namespace relumbre
