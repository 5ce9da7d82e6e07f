// What SciPy, statsmodels and R say of the same tables: tests/reference/make_statistics.{py,R}.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/stats/anova.h"
#include "relumbre/stats/kruskal_wallis.h"
#include "relumbre/stats/normality.h"
#include "relumbre/stats/variances.h"

namespace relumbre {
namespace {

using Quantities = std::map<std::string, double>;

std::vector<std::vector<std::string>> read_csv(const std::string& name) {
  std::istringstream text(read_file(std::string(RELUMBRE_REFERENCE) + "/" + name));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(text, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

/// One table a response; every other column is a factor.
std::vector<Table> read_tables(const std::string& name, const std::vector<std::string>& responses) {
  const auto rows = read_csv(name + ".csv");
  std::vector<Factor> factors;
  std::vector<Table> tables;
  for (std::size_t c = 0; c < rows[0].size(); ++c) {
    std::vector<std::string> column;
    for (std::size_t r = 1; r < rows.size(); ++r) column.push_back(rows[r][c]);
    if (std::ranges::find(responses, rows[0][c]) == responses.end()) {
      factors.push_back(make_factor(rows[0][c], column));
      continue;
    }
    tables.push_back({rows[0][c]});
    for (const std::string& cell : column) tables.back().values.push_back(std::stod(cell));
  }
  for (Table& table : tables) table.factors = factors;
  return tables;
}

void add_p(const std::string& name, const TailProbability& p, Quantities& out) {
  out[name + "p"] = p.p;
  out[name + "log_p"] = p.log_p;
}

void add_anova(const std::string& kind, const Anova& result, Quantities& out) {
  out[kind + ".residual.df"] = static_cast<double>(result.residual_df);
  out[kind + ".residual.ss"] = result.residual_ss;
  for (const AnovaTerm& term : result.terms) {
    const std::string prefix = kind + "." + term.name + ".";
    out[prefix + "df"] = static_cast<double>(term.df);
    out[prefix + "ss"] = term.ss;
    out[prefix + "f"] = term.f;
    out[prefix + "eta2"] = term.eta2;
    out[prefix + "partial_eta2"] = term.partial_eta2;
    out[prefix + "omega2"] = term.omega2;
    add_p(prefix, term.p, out);
  }
}

void add_factor(const Table& table, const Factor& factor, Quantities& out) {
  const VarianceTest forsythe = brown_forsythe(table.values, factor);
  out[factor.name + ".brown_forsythe"] = forsythe.statistic;
  add_p(factor.name + ".brown_forsythe.", forsythe.p, out);
  const VarianceTest equal = bartlett(table.values, factor);
  out[factor.name + ".bartlett"] = equal.statistic;
  add_p(factor.name + ".bartlett.", equal.p, out);
  const KruskalWallis kruskal = kruskal_wallis(table.values, factor);
  out[factor.name + ".h"] = kruskal.h;
  out[factor.name + ".epsilon2"] = kruskal.epsilon2;
  add_p(factor.name + ".h.", kruskal.p, out);
  for (const DunnPair& pair : dunn(table.values, factor)) {
    const std::string prefix =
        factor.name + "." + factor.levels[pair.a] + "|" + factor.levels[pair.b] + ".";
    out[prefix + "z"] = pair.z;
    out[prefix + "holm"] = pair.adjusted.p;
    out[prefix + "delta"] = pair.cliffs_delta;
    add_p(prefix, pair.p, out);
  }
}

void add_normality(const std::string& prefix, const std::vector<double>& values, Quantities& out) {
  const NormalityTest shapiro = shapiro_wilk(values);
  out[prefix + "shapiro.w"] = shapiro.statistic;
  out[prefix + "shapiro.p"] = shapiro.p.p;
  if (values.size() < 20) return;
  const NormalityTest k2 = dagostino_pearson(values);
  out[prefix + "k2"] = k2.statistic;
  out[prefix + "k2.p"] = k2.p.p;
}

Quantities analyse(const Table& table) {
  Quantities out;
  const Anova main = anova(table);
  for (const char* type : {"main", "main.type1", "main.type3"}) add_anova(type, main, out);
  if (table.factors.size() > 1) {
    const Anova pairs = anova(table, {.interactions = true});
    for (const char* type : {"pairs", "pairs.type1", "pairs.type3"}) add_anova(type, pairs, out);
  }
  add_normality("residuals.", main.residuals, out);
  for (const Factor& factor : table.factors) add_factor(table, factor, out);
  const Factor& first = table.factors[0];
  const auto groups = groups_of(table.values, first);
  for (std::size_t g = 0; g < groups.size(); ++g)
    add_normality(first.name + "." + first.levels[g] + ".", groups[g], out);
  return out;
}

/// Below this a double has lost digits, and log_p is what is compared.
constexpr double kUnderflow = 1e-300;

void expect_same(double ours, double theirs, double tolerance, const std::string& what) {
  if (std::abs(theirs) < kUnderflow)
    EXPECT_LT(std::abs(ours), 2 * kUnderflow) << what;
  else
    EXPECT_NEAR(ours / theirs, 1, tolerance) << what << ": " << ours << " and " << theirs;
}

struct Case {
  const char* name;
  std::vector<std::string> responses;
};
void PrintTo(const Case& data, std::ostream* out) { *out << data.name; }

class Reference : public testing::TestWithParam<Case> {};

/// What a program prints of a table, and how far it may be from ours.
struct Yardstick {
  const char* program;
  std::function<double(const std::string& quantity)> tolerance;
  double logs_below = 0;  ///< probabilities below this are compared by their logarithms
};

void compare(const Case& data, const Yardstick& yardstick) {
  std::map<std::string, Quantities> ours;
  for (const Table& table : read_tables(data.name, data.responses))
    ours[table.response] = analyse(table);
  const auto rows = read_csv(std::string(data.name) + "." + yardstick.program + ".csv");
  ASSERT_GT(rows.size(), 20u);
  for (const auto& row : rows) {
    const Quantities& quantities = ours[row[0]];
    const auto found = quantities.find(row[1]);
    ASSERT_NE(found, quantities.end()) << row[1];
    const std::string what = std::string(data.name) + " " + row[0] + " " + row[1];
    const double theirs = std::strtod(row[2].c_str(), nullptr);
    const double tolerance = yardstick.tolerance(row[1]);
    if (row[1].ends_with(".p") && theirs > kUnderflow && theirs < yardstick.logs_below)
      expect_same(std::log(found->second), std::log(theirs), tolerance, what);
    else
      expect_same(found->second, theirs, tolerance, what);
  }
}

TEST_P(Reference, StatisticsAreThoseOfR) {
  compare(GetParam(), {"r", [](const std::string&) { return 1e-10; }});
}

/// SciPy 1.10 computes Shapiro-Wilk in single precision, so that there only R can say much. And a
/// far tail magnifies what rounding leaves in its F, which statsmodels has a little more of.
TEST_P(Reference, StatisticsAreThoseOfPython) {
  const auto tolerance = [](const std::string& quantity) {
    if (quantity == "residuals.shapiro.w") return 1e-5;
    return quantity == "residuals.shapiro.p" ? 2e-4 : 1e-10;
  };
  compare(GetParam(), {"python", tolerance, 1e-20});
}

INSTANTIATE_TEST_SUITE_P(Tables, Reference,
                         testing::Values(Case{"balanced", {"y"}}, Case{"unbalanced", {"y"}},
                                         Case{"ties", {"y"}}, Case{"tiny", {"y"}},
                                         Case{"machine", {"M", "L"}}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace relumbre
