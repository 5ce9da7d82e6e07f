#include <algorithm>
#include <clocale>
#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/plot/charts.h"
#include "relumbre/plot/palette.h"
#include "relumbre/plot/svg.h"
#include "relumbre/plot/svg_writer.h"
#include "relumbre/plot/ticks.h"
#include "relumbre/plot/xml_check.h"

namespace relumbre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> labels_of(const std::vector<Tick>& ticks) {
  std::vector<std::string> labels;
  for (const Tick& tick : ticks)
    if (!tick.label.empty()) labels.push_back(tick.label);
  return labels;
}

std::vector<double> random_values(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& v : values) v = normal(random);
  return values;
}

/// The value of an attribute of every element of this name.
std::vector<double> attributes(const std::string& svg, const std::string& element,
                               const std::string& name) {
  std::vector<double> values;
  for (std::size_t at = svg.find("<" + element); at != svg.npos;
       at = svg.find("<" + element, at + 1))
    values.push_back(std::stod(svg.substr(svg.find(" " + name + "=\"", at) + name.size() + 3)));
  return values;
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++count;
  return count;
}

Panel line_panel(const std::string& title, std::initializer_list<Point> points) {
  return Panel{title, {"x"}, {"y"}, {Series{"s", points}}, {}, {}};
}

Figure figure_of(Panel panel) {
  Figure figure;
  figure.title = "t";
  figure.panels = {std::move(panel)};
  return figure;
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Ticks, StepsAreOneTwoOrFiveTimesAPowerOfTen) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-9, 12), sign(-1, 1);
  for (int trial = 0; trial < 3000; ++trial) {
    const double low = sign(random) * std::pow(10, exponent(random));
    const double high = low + std::pow(10, exponent(random));
    if (!(high - low > 1e-9 * std::abs(low))) continue;
    const int most = 2 + trial % 10;
    const std::vector<Tick> ticks = linear_ticks(low, high, most);
    ASSERT_GE(ticks.size(), 1u) << low << " " << high;
    ASSERT_LE(ticks.size(), static_cast<std::size_t>(most));
    // The next finer of the steps 1, 2, 5 would have too many: at most 2.5 times as many.
    ASSERT_GE(static_cast<double>(ticks.size()) * 2.5 + 2.5, most);
    const double slack = 1e-9 * std::max(std::abs(low), std::abs(high));
    for (const Tick& tick : ticks) {
      ASSERT_GE(tick.value, low - slack);
      ASSERT_LE(tick.value, high + slack);
    }
    if (ticks.size() < 2) continue;
    const double step = ticks[1].value - ticks[0].value;
    const double digit = step / std::pow(10, std::floor(std::log10(step * 1.0001)));
    const double off = std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)});
    ASSERT_LT(off, 1e-4) << step;
  }
}

TEST(Ticks, LabelsTellNeighboursApart) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponent(-5, 12);
  for (int trial = 0; trial < 1000; ++trial) {
    const double low = std::pow(10, exponent(random));
    std::vector<std::string> labels = labels_of(linear_ticks(low, low * 1.4, 6));
    const std::size_t count = labels.size();
    std::ranges::sort(labels);
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    ASSERT_EQ(labels.size(), count) << low;
  }
}

TEST(Ticks, LabelsHaveTheDecimalsOfTheStep) {
  EXPECT_THAT(labels_of(linear_ticks(0, 1, 6)),
              ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_THAT(labels_of(linear_ticks(-3.3, 3.3, 7)),
              ElementsAre("-3", "-2", "-1", "0", "1", "2", "3"));
  EXPECT_THAT(labels_of(linear_ticks(0, 2.3e7, 5)), ElementsAre("0", "5M", "10M", "15M", "20M"));
  EXPECT_THAT(labels_of(linear_ticks(-1.1e6, 1.1e6, 5)),
              ElementsAre("-1.0M", "-0.5M", "0", "0.5M", "1.0M"));
  EXPECT_THAT(labels_of(linear_ticks(0, 31000, 4)), ElementsAre("0", "10k", "20k", "30k"));
  EXPECT_THAT(labels_of(linear_ticks(0, 3100, 4)), ElementsAre("0", "1000", "2000", "3000"));
}

TEST(LogTicks, ArePowersOfTenOverDecades) {
  EXPECT_THAT(labels_of(log_ticks(0.5, 2e5, 8)),
              ElementsAre("1", "10", "100", "1000", "10⁴", "10⁵"));
  EXPECT_THAT(labels_of(log_ticks(1e-12, 1e12, 4)),
              ElementsAre("10⁻¹²", "10⁻⁶", "1", "10⁶", "10¹²"));
}

TEST(LogTicks, TakeMoreDigitsWithinADecadeOrTwo) {
  EXPECT_THAT(labels_of(log_ticks(1.5e4, 4e5, 8)), ElementsAre("2·10⁴", "5·10⁴", "10⁵", "2·10⁵"));
  EXPECT_THAT(labels_of(log_ticks(2.5, 4.5, 8)), ElementsAre("3", "4"));
  EXPECT_GE(labels_of(log_ticks(2.5, 2.6, 8)).size(), 2u);
}

TEST(SeriesColors, StylesDiffer) {
  for (const SeriesColors palette : {SeriesColors::kDistinct, SeriesColors::kOrdered})
    for (std::size_t i = 0; i < 7; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_NE(series_style(palette, i, 7).color, series_style(palette, j, 7).color);
        EXPECT_NE(series_style(palette, i, 7).mark, series_style(palette, j, 7).mark);
      }
  EXPECT_NE(series_style(SeriesColors::kDistinct, 7, 9).dashes,
            series_style(SeriesColors::kDistinct, 0, 9).dashes);
}

TEST(EscapeXml, KeepsTextAndNeutralisesTheRest) {
  EXPECT_EQ(escape_xml("a<b>&\"ñ€😀"), "a&lt;b&gt;&amp;&quot;ñ€😀");
  EXPECT_EQ(escape_xml(std::string("\0\x01\n", 3)), "\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(escape_xml("\xc3"), "\uFFFD");                      // cut short
  EXPECT_EQ(escape_xml("\xc0\xaf"), "\uFFFD\uFFFD");            // overlong
  EXPECT_EQ(escape_xml("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD");  // a surrogate
  EXPECT_EQ(escape_xml("\xff\xbfx"), "\uFFFD\uFFFDx");
}

TEST(Svg, IsWellFormedAndLoadsNothing) {
  Figure figure;
  figure.title = "a <title> with \"quotes\" & \x01";
  figure.columns = 2;
  figure.palette = SeriesColors::kOrdered;
  Panel lines = line_panel("lines & more", {{1, 2}, {2, 3}, {3, 1}});
  lines.series.push_back({"<second>", {{1, 1}, {3, 3}}, true, false});
  const std::vector<double> values = random_values(500, 1);
  figure.panels = {
      lines,
      box_panel("boxes", {"a", "a category of a long name"}, std::vector{values, values}, {"y"}),
      histogram_panel("histogram", values, {"value"}),
      qq_panel("Q-Q", values, values, {"expected"}, {"found"})};
  const std::string svg = to_svg(figure);
  EXPECT_EQ(xml_fault(svg), "");
  for (const char* unwanted :
       {"<script", "href", "url(", "@import", "<image", " id=", "nan", "inf"})
    EXPECT_THAT(svg, testing::Not(HasSubstr(unwanted)));
  EXPECT_EQ(count_of(svg, "http"), 1u);  // the name space
}

TEST(XmlCheck, FindsFaults) {
  EXPECT_EQ(xml_fault("<a b=\"1\"><c/>x</a>\n"), "");
  for (const char* bad :
       {"", "<a>", "<a></b>", "<a b=1/>", "<a/><b/>", "<a>&x;</a>", "<a>x > y</a>", "<a/>text"})
    EXPECT_NE(xml_fault(bad), "") << bad;
}

TEST(Svg, MarksLieWithinTheAxes) {
  for (const Scale scale : {Scale::kLinear, Scale::kLog10}) {
    Panel panel{"p", {"x", scale}, {"y", scale}, {{"", {}, false, true}}, {}, {}};
    for (const double v : random_values(300, 7))
      panel.series[0].points.push_back({std::exp(3 * v), std::exp(-2 * v) + 1});
    const std::string svg = to_svg(figure_of(panel));
    const double left = attributes(svg, "rect", "x").back(),
                 top = attributes(svg, "rect", "y").back();
    const std::vector<double> xs = attributes(svg, "circle", "cx"),
                              ys = attributes(svg, "circle", "cy");
    ASSERT_EQ(xs.size(), 300u);
    EXPECT_GE(std::ranges::min(xs), left);
    EXPECT_LE(std::ranges::max(xs), left + 420);
    EXPECT_GE(std::ranges::min(ys), top);
    EXPECT_LE(std::ranges::max(ys), top + 260);
  }
}

TEST(Svg, PlacesFollowTheScale) {
  Panel panel{"p", {"x"}, {"y", Scale::kLog10}, {{"", {{0, 1}, {5, 10}, {10, 100}}, false, true}},
              {},  {}};
  const std::string svg = to_svg(figure_of(panel));
  const std::vector<double> xs = attributes(svg, "circle", "cx"),
                            ys = attributes(svg, "circle", "cy");
  EXPECT_NEAR(xs[2] - xs[1], xs[1] - xs[0], 0.02);
  EXPECT_NEAR(ys[2] - ys[1], ys[1] - ys[0], 0.02);
  EXPECT_LT(ys[2], ys[0]);
}

TEST(Svg, SharedRangesPutEqualValuesAtEqualHeights) {
  Figure figure;
  figure.columns = 2;
  figure.share_y = true;
  figure.panels = {line_panel("a", {{0, 5}, {1, 6}}), line_panel("b", {{0, 5}, {1, 90}})};
  for (Panel& panel : figure.panels) panel.series[0].line = false;
  const std::vector<double> ys = attributes(to_svg(figure), "circle", "cy");
  EXPECT_EQ(ys[ys.size() - 4], ys[ys.size() - 2]);
}

TEST(Svg, LegendNamesEachSeriesOnce) {
  Figure figure;
  figure.panels = {line_panel("a", {{0, 5}, {1, 6}}), line_panel("b", {{0, 5}, {1, 90}})};
  for (Panel& panel : figure.panels) panel.series[0].name = "depth 5";
  EXPECT_EQ(count_of(to_svg(figure), ">depth 5<"), 1u);
}

TEST(Svg, IsTheSameWhateverTheLocale) {
  const Figure figure = figure_of(line_panel("p", {{0.5, 1.25}, {1.75, 1e7}}));
  const std::string before = to_svg(figure);
  const std::string old = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "es_ES.UTF-8", "C.UTF-8"})
    std::setlocale(LC_ALL, locale);
  const std::string after = to_svg(figure);
  std::setlocale(LC_ALL, old.c_str());
  EXPECT_EQ(before, after);
}

TEST(Svg, DrawsDataWithoutAnExtent) {
  for (const double v : {0.0, 1.0, -1e12, 1e-200})
    EXPECT_EQ(xml_fault(to_svg(figure_of(line_panel("p", {{v, v}})))), "");
  EXPECT_EQ(xml_fault(to_svg(figure_of(line_panel("p", {{1, 1}, {1 + 1e-15, 1}})))), "");
  EXPECT_EQ(xml_fault(to_svg(figure_of(line_panel("p", {{-1e300, 0}, {1e300, 1}})))), "");
  EXPECT_EQ(xml_fault(to_svg(figure_of(line_panel("p", {{1e-290, 0}, {2e-290, 1}})))), "");
  Panel log{"p",
            {"x", Scale::kLog10},
            {"y", Scale::kLog10},
            {{"", {{1e-290, 1e300}, {1e300, 1e300}}}},
            {},
            {}};
  EXPECT_EQ(xml_fault(to_svg(figure_of(log))), "");
}

TEST(Svg, RefusesWhatCannotBeDrawn) {
  const auto refusal = [](const Panel& panel) {
    return message_of([&] { to_svg(figure_of(panel)); });
  };
  EXPECT_THAT(message_of([] { to_svg({}); }), HasSubstr("no panels"));
  EXPECT_THAT(refusal(line_panel("empty", {})), HasSubstr("\"empty\": there is nothing to draw"));
  EXPECT_THAT(refusal(line_panel("p", {{1, NAN}})), HasSubstr("nan cannot be drawn"));
  EXPECT_THAT(refusal(line_panel("p", {{INFINITY, 1}})), HasSubstr("inf cannot be drawn"));
  Panel log = line_panel("p", {{1, 0}, {2, 1}});
  log.y.scale = Scale::kLog10;
  EXPECT_THAT(refusal(log), HasSubstr("axis \"y\": 0 on a logarithmic axis"));
  Panel fixed = line_panel("p", {{1, 0}, {2, 1}});
  fixed.x.high = 1.5;
  EXPECT_THAT(refusal(fixed), HasSubstr("values from 1 to 2 on a range from"));
  Panel named = line_panel("p", {{0, 0}, {2, 1}});
  named.x = {"x", Scale::kCategories, {"a", "b"}};
  EXPECT_THAT(refusal(named), HasSubstr("2 is none of its 2 categories"));
  Figure narrow = figure_of(line_panel("p", {{1, 0}, {2, 1}}));
  narrow.width = 10;
  EXPECT_THAT(message_of([&] { to_svg(narrow); }), HasSubstr("10 x 260 pixels"));
  Panel crowded = line_panel("p", {});
  crowded.series[0].points.resize(1'000'001);
  EXPECT_THAT(refusal(crowded), HasSubstr("1000001 marks"));
}

TEST(BoxPlot, QuartilesAndWhiskersByHand) {
  const BoxPlot box = box_of(std::vector<double>{1, 2, 3, 4, 100}, 3);
  EXPECT_EQ(box.q1, 2);
  EXPECT_EQ(box.median, 3);
  EXPECT_EQ(box.q3, 4);
  EXPECT_EQ(box.low, 1);
  EXPECT_EQ(box.high, 4);
  EXPECT_THAT(box.outliers, ElementsAre(100));
  EXPECT_THAT(message_of([] { box_of({}, 0); }), HasSubstr("no values"));
  EXPECT_THAT(message_of([] { box_of(std::vector<double>{NAN}, 0); }), HasSubstr("nan"));
}

TEST(Histogram, CountsEveryValueOnce) {
  for (const std::size_t bins : {0u, 1u, 7u, 1000u}) {
    double sum = 0;
    for (const Bar& bar : histogram_panel("h", random_values(997, 2), {"x"}, bins).bars)
      sum += bar.y;
    EXPECT_EQ(sum, 997);
  }
  EXPECT_EQ(histogram_panel("h", std::vector<double>(5, 2.5), {"x"}).bars.size(), 1u);
  EXPECT_THAT(message_of([] { histogram_panel("h", std::vector<double>{1}, {"x"}, 1001); }),
              HasSubstr("1001 bins"));
}

TEST(QqPanel, LineGoesThroughTheQuartiles) {
  std::vector<double> expected, values;
  for (int i = 0; i <= 100; ++i) {
    expected.push_back(i);
    values.push_back(3 * i + 7);
  }
  const Panel panel = qq_panel("q", expected, values, {"x"}, {"y"});
  EXPECT_EQ(panel.series[1].points[0].y, 7);
  EXPECT_EQ(panel.series[1].points[1].y, 307);
  EXPECT_THAT(message_of([&] { qq_panel("q", {}, values, {"x"}, {"y"}); }),
              HasSubstr("101 values, 0"));
}

}  // namespace
}  // namespace relumbre
