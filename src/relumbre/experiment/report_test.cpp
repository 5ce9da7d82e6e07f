#include "relumbre/experiment/report.h"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/experiment/analysis.h"
#include "relumbre/experiment/cells_csv.h"
#include "relumbre/experiment/cells_testing.h"
#include "relumbre/experiment/html.h"
#include "relumbre/experiment/readings.h"
#include "relumbre/experiment/report_tables.h"
#include "relumbre/plot/svg.h"
#include "relumbre/plot/xml_check.h"

namespace relumbre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

double fetches(const ExperimentCell& cell) { return static_cast<double>(cell_fetches(cell)); }

const CellGrid kSmall{
    {"teapot", "a, \"quoted\" <scene>"}, {5, 7}, {2, 20}, {512, 4096}, {{64, 48}, {80, 60}}};

std::string refusal(const std::string& csv) {
  try {
    (void)parse_cells_csv(csv, "cells.csv");
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(ExperimentCell, SumsByHand) {
  const ExperimentCell cell{"s", "gt", 2, 4, 3, 1, 2, 512, 40, {{10, 9, 0, 1}, {30, 21, 3, 6}}};
  EXPECT_EQ(cell_reads(cell), 40u);
  EXPECT_EQ(cell_fetches(cell), 10u);
  EXPECT_EQ(cell_hit_rate(cell), 0.75);
  EXPECT_EQ(cell_hit_rate(ExperimentCell{}), 0);
  EXPECT_EQ(cell_resolution(cell), "4x3");
}

TEST(CellsCsv, ReadsBackExactly) {
  const std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  const std::string csv = cells_to_csv(cells);
  EXPECT_EQ(parse_cells_csv(csv, "cells.csv"), cells);
  EXPECT_EQ(cells_to_csv(parse_cells_csv(csv, "cells.csv")), csv);
  EXPECT_THAT(
      csv,
      StartsWith("scene,depth,width,height,traversal,gts,tile,lines,tasks,reads,M,L,reads_0,"));
  const TemporaryFolder folder;
  write_file(folder / "cells.csv", csv);
  EXPECT_EQ(read_cells_csv(folder / "cells.csv"), cells);
}

TEST(CellsCsv, OfNoCellsIsAHeader) {
  EXPECT_TRUE(parse_cells_csv(cells_to_csv({}), "cells.csv").empty());
}

TEST(CellsCsv, RefusesDamage) {
  const std::string head =
      "scene,depth,width,height,traversal,gts,tile,lines,tasks,reads,M,L,reads_0,hits_0,"
      "replacements_0,lines_used_0\n";
  EXPECT_EQ(refusal(head + "s,1,4,3,gt,1,2,512,40,8,2,0.75,8,6,0,2\n"), "no error");
  EXPECT_THAT(refusal(""), HasSubstr("cells.csv:1: this is no table of cells"));
  EXPECT_THAT(refusal("scene,depth\n"), HasSubstr("this is no table of cells"));
  EXPECT_EQ(refusal(head + "s,1,4,3,gt,1,2,512,40\n"), "cells.csv:2: the line is too short");
  EXPECT_THAT(refusal(head + "s,1,4,3,gt,1,2,512,x,8,2,0.75,8,6,0,2\n"),
              HasSubstr("tasks: \"x\" is no number"));
  EXPECT_THAT(refusal(head + "s,1,4,3,gt,1,2,512,-4,8,2,0.75,8,6,0,2\n"),
              HasSubstr("tasks: \"-4\""));
  EXPECT_THAT(refusal(head + "s,1,4,3,gt,1,2,512,40,8,3,0.75,8,6,0,2\n"),
              HasSubstr("not those of the levels"));
  EXPECT_THAT(refusal(head + "s,1,4,3,gt,1,2,512,40,8,2,0.76,8,6,0,2\n"),
              HasSubstr("not those of the levels"));
  EXPECT_THAT(refusal(head + "s,1,4,3,gt,1,2,512,40,6,0,1,6,8,0,2\n"),
              HasSubstr("more hits than reads"));
  EXPECT_THAT(refusal(head + "s,2,4,3,gt,1,2,512,40,8,2,0.75,8,6,0,2\n"),
              HasSubstr("depth 2 without its levels"));
  EXPECT_THAT(refusal(head + "s,0,4,3,gt,1,2,512,40,0,0,0,8,,,\n"), HasSubstr("does not have"));
  EXPECT_THAT(refusal(head + "\"s,1,4\n"), HasSubstr("a quote does not end"));
  EXPECT_THAT(refusal(head + "\"s\"t,1,4\n"), HasSubstr("text after a quote"));
  EXPECT_THAT(refusal(head + "\n"), HasSubstr("cells.csv:2: "));
}

TEST(ResponseTable, HasTheFactorsThatVary) {
  const std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  const Table table = response_table(cells, "M", fetches);
  std::vector<std::string> names;
  for (const Factor& factor : table.factors) names.push_back(factor.name);
  EXPECT_THAT(names, ElementsAre("scene", "depth", "resolution", "tile", "lines"));
  EXPECT_THAT(table.factors[2].levels, ElementsAre("64x48", "80x60"));
  EXPECT_EQ(table.values[5], fetches(cells[5]));
  EXPECT_THROW((void)response_table({}, "M", fetches), ValueError);
}

TEST(Analysis, AFactorThatChangesNothingSaysSo) {
  std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  for (ExperimentCell& cell : cells) {  // as if tiles were all of one size
    ExperimentCell same{cell.scene, cell.traversal, cell.depth, cell.width, cell.height, cell.gts,
                        2,          cell.lines,     0,          {}};
    cell.levels = made_up_cell(same, 0.3).levels;
  }
  const ResponseAnalysis analysis = analyse_response(response_table(cells, "M", fetches));
  EXPECT_EQ(analysis.factors[3].alone.value->largest, 0);
  const std::vector<std::string> sentences = readings(analysis);
  const auto tile = std::ranges::find_if(
      sentences, [](const std::string& s) { return s.starts_with("<b>tile"); });
  ASSERT_NE(tile, sentences.end());
  EXPECT_THAT(*tile, HasSubstr("it hardly matters here"));
  EXPECT_THAT(*tile, HasSubstr("changes nothing"));
}

TEST(Analysis, AllElseEqualByHand) {
  const Table table{"M",
                    {10, 12, 20, 30, 5, 5},
                    {make_factor("a", std::vector<std::string>{"x", "y", "x", "y", "x", "y"}),
                     make_factor("b", std::vector<std::string>{"1", "1", "2", "2", "3", "3"})}};
  const FactorAnalysis a = analyse_response(table).factors[0];
  EXPECT_NEAR(a.alone.value->median, 0.2, 1e-15);
  EXPECT_NEAR(a.alone.value->largest, 0.5, 1e-15);
}

/// The medians over one, two, ... sets of cells that differ in factor a alone.
TEST(Analysis, TheMedianOfEvenlyManySetsIsBetweenTheTwoInTheMiddle) {
  const std::vector<double> larger{1.1, 1.7, 1.3, 1.2};
  const std::vector<double> medians{0.1, 0.4, 0.3, 0.25};
  Table table{"M", {}, {}};
  std::vector<std::string> a, b;
  for (std::size_t set = 0; set < larger.size(); ++set) {
    table.values.insert(table.values.end(), {10, 10 * larger[set]});
    a.insert(a.end(), {"x", "y"});
    b.insert(b.end(), 2, std::to_string(set));
    table.factors = {make_factor("a", a), make_factor("b", b)};
    EXPECT_NEAR(analyse_response(table).factors[0].alone.value->median, medians[set], 1e-12);
  }
}

class StopAtQuestion : public Progress {
 public:
  explicit StopAtQuestion(int questions) : left_(questions) {}
  [[nodiscard]] bool cancelled() const override { return --left_ <= 0; }
  [[nodiscard]] int left() const { return left_; }

 private:
  mutable int left_;
};

TEST(ExperimentReport, HearsThatItShouldStopWhereverItIs) {
  const std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  const StopAtQuestion never(1'000'000);
  (void)make_report({"t", {}, cells, {}}, never);
  const int questions = 1'000'000 - never.left();
  EXPECT_GT(questions, 50);
  for (int question = 1; question <= questions; question += 7)
    EXPECT_THROW((void)make_report({"t", {}, cells, {}}, StopAtQuestion(question)), Cancelled)
        << question << " of " << questions;
}

/// What readings say of these p of Shapiro-Wilk, D'Agostino-Pearson and Brown-Forsythe; below 0:
/// the test was refused.
std::string said_of_assumptions(double shapiro, double dagostino, double brown_forsythe) {
  ResponseAnalysis analysis = analyse_response(response_table(made_up_cells(kSmall), "M", fetches));
  const auto set = [](auto& outcome, double p) {
    outcome.value.reset();
    if (p >= 0) outcome.value.emplace().p.p = p;
  };
  set(analysis.shapiro, shapiro);
  set(analysis.dagostino, dagostino);
  for (FactorAnalysis& factor : analysis.factors) set(factor.brown_forsythe, brown_forsythe);
  return readings(analysis).back();
}

TEST(Readings, ARefusedTestIsNoFinding) {
  constexpr double kNo = -1;
  EXPECT_THAT(said_of_assumptions(kNo, 0.5, 0.5), StartsWith("No departure"));
  EXPECT_THAT(said_of_assumptions(kNo, 0.01, 0.5), StartsWith("The residuals are not normal"));
  EXPECT_THAT(said_of_assumptions(0.01, 0.5, 0.5), StartsWith("The residuals are not normal"));
  EXPECT_THAT(said_of_assumptions(kNo, kNo, 0.5), HasSubstr("normal was not tested"));
  EXPECT_THAT(said_of_assumptions(0.5, 0.5, kNo), HasSubstr("are equal was not tested"));
  EXPECT_THAT(said_of_assumptions(0.5, 0.5, 0.01), HasSubstr("variances are not equal"));
  for (const char* claim : {"take F", "rests on", "not tested"})
    EXPECT_THAT(said_of_assumptions(0.5, 0.5, 0.5), Not(HasSubstr(claim)));
  for (const double equal : {kNo, 0.01})
    EXPECT_THAT(said_of_assumptions(0.5, 0.5, equal), HasSubstr("take F"));
}

TEST(Readings, MoreResidualsThanShapiroAndWilkAllowAreTestedAllTheSame) {
  Table table{"M", {}, {}};
  std::vector<std::string> a;
  for (const double z : normal_scores(5001)) {  // an exact normal distribution, in two levels
    a.push_back(a.size() % 2 ? "x" : "y");
    table.values.push_back(z + (a.size() % 2 ? 20 : 10));
  }
  table.factors = {make_factor("a", a)};
  const ResponseAnalysis analysis = analyse_response(table);
  EXPECT_FALSE(analysis.shapiro.value.has_value());
  EXPECT_THAT(readings(analysis).back(), StartsWith("No departure"));
}

TEST(Readings, NameTheShareThatTheTableHas) {
  const ResponseAnalysis analysis = analyse_response(response_table(made_up_cells(), "M", fetches));
  const std::vector<std::string> sentences = readings(analysis);
  double largest = 0;
  for (const AnovaTerm& term : analysis.main.value->terms) largest = std::max(largest, term.eta2);
  EXPECT_THAT(sentences[0], StartsWith("<b>depth</b> explains " + html::percent(largest)));
}

TEST(Html, NumbersAreShort) {
  EXPECT_EQ(html::number(0), "0");
  EXPECT_EQ(html::number(12.3456), "12.35");
  EXPECT_EQ(html::number(1.23456e7), "1.235·10<sup>7</sup>");
  EXPECT_EQ(html::number(-1.5e-9), "-1.500·10<sup>−9</sup>");
  EXPECT_EQ(html::percent(0.6214), "62.1 %");
  EXPECT_EQ(html::change(13.2), "a factor of 14.20");
  EXPECT_EQ(html::probability({0.0423, std::log(0.0423)}), "0.042");
  EXPECT_EQ(html::probability({0, -1000}), "5.1·10<sup>−435</sup>");
  EXPECT_EQ(html::text("<&>"), "&lt;&amp;&gt;");
}

TEST(ExperimentReport, IsWellFormedAndLoadsNothing) {
  const std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  const ExperimentReport report = make_report({"A <title>", {{"plan", "a&b.toml"}}, cells, {}});
  std::string xml = report.html.substr(report.html.find('\n') + 1);  // without the doctype
  const std::size_t style = xml.find("<style>"), end = xml.find("</style>");
  for (std::size_t at = xml.find("> *", style); at < end; at = xml.find("> *", at + 1))
    xml[at] = ' ';
  for (std::size_t at = xml.find("&ldquo;"); at != xml.npos; at = xml.find("&ldquo;"))
    xml.erase(at, 7);
  for (std::size_t at = xml.find("&rdquo;"); at != xml.npos; at = xml.find("&rdquo;"))
    xml.erase(at, 7);
  EXPECT_EQ(xml_fault(xml), "");
  for (const char* unwanted : {"<script", "href", "src=", "url(", "@import", "nan", "inf<"})
    EXPECT_THAT(report.html, Not(HasSubstr(unwanted))) << unwanted;
  for (const char* wanted : {"A &lt;title&gt;", "a&amp;b.toml",
                             "a, &quot;quoted&quot; &lt;scene&gt;", "Analysis of variance",
                             "Kruskal-Wallis", "Shapiro-Wilk", "Bartlett", "Holm", "deterministic"})
    EXPECT_THAT(report.html, HasSubstr(wanted));
  EXPECT_EQ(count_of(report.html, "<svg"), report.figures.size());
}

TEST(ExperimentReport, IsTheSameForTheSameCells) {
  const std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  EXPECT_EQ(make_report({"t", {}, cells, {}}).html, make_report({"t", {}, cells, {}}).html);
}

TEST(ExperimentReport, SaysWhyWhereStatisticsAreNotPossible) {
  const CellGrid one{{"teapot"}, {5}, {2}, {512}, {{64, 48}}};
  EXPECT_THAT(make_report({"t", {}, made_up_cells(one), {}}).html, HasSubstr("nothing to compare"));
  const CellGrid two{{"teapot"}, {5, 6}, {2}, {512}, {{64, 48}}};
  EXPECT_THAT(make_report({"t", {}, made_up_cells(two), {}}).html,
              HasSubstr("too few for a model"));
  std::vector<ExperimentCell> nothing = made_up_cells(kSmall);
  for (ExperimentCell& cell : nothing)
    for (CellLevel& level : cell.levels) level = {};
  EXPECT_THAT(make_report({"t", {}, nothing, {}}).html, HasSubstr("all 32 rows are 0"));
}

TEST(ExperimentReport, TheMachinesBytesAreTheirWordsAndRecords) {
  const auto table_of = [](std::uint64_t reads, std::uint64_t hits, std::uint64_t tasks) {
    const ExperimentCell cell{"s", "gt", 1, 4, 3, 1, 2, 512, tasks, {{reads, hits, 0, 1}}};
    return machines_table(std::vector{cell});
  };
  // 2 bytes a word, 32 a record; whole MB in groups of digits from 100 MB on.
  EXPECT_THAT(table_of(3'000'000'000, 2'999'383'000, 200'000'000),
              HasSubstr("<td>1.234</td><td>6\u202F000</td><td>6\u202F400</td>"));
  EXPECT_THAT(table_of(50'000'000, 0, 49), HasSubstr("<td>100</td><td>100</td><td>0.001568</td>"));
  EXPECT_THAT(table_of(12'345'000, 0, 0), HasSubstr("<td>24.69</td><td>24.69</td><td>0</td>"));
}

TEST(ExperimentReport, HasFurtherFigures) {
  const std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  NamedFigure extra{"reads-per-address", {"Reads per address"}};
  extra.figure.panels = {Panel{"p", {"x"}, {"y"}, {{"", {{1, 2}}}}}};
  const ExperimentReport report = make_report({"t", {}, cells, {extra}});
  EXPECT_EQ(report.figures.back().name, "reads-per-address");
  EXPECT_THAT(report.html, HasSubstr("Reads per address"));
}

TEST(ExperimentReport, RefusesNoCellsAndCellsWithoutTheirLevels) {
  EXPECT_THROW((void)make_report({"t", {}, {}, {}}), ValueError);
  std::vector<ExperimentCell> cells = made_up_cells(kSmall);
  cells[3].levels.pop_back();
  EXPECT_THROW((void)make_report({"t", {}, cells, {}}), ValueError);
}

TEST(CacheSize, InUseIsAWordALineOfEachUnit) {
  ExperimentCell cell{.depth = 2};
  cell.gts = 2, cell.levels = {{.lines_used = 2}, {.lines_used = 10}};
  EXPECT_EQ(used_cache_bytes(cell), 12);
}

TEST(CacheSize, ByHand) {
  EXPECT_EQ(unit_cache_bytes(2, 512), 2 * (8 + 64));
  EXPECT_EQ(unit_cache_bytes(5, 4096), 2 * (8 + 64 + 512 + 2 * 4096));
}

}  // namespace
}  // namespace relumbre
