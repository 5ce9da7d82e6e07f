#include "relumbre/experiment/html.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "relumbre/plot/svg_writer.h"

namespace relumbre::html {

namespace {

constexpr std::string_view kStyle = R"css(
body { max-width: 64rem; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff;
       font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #ddd; }
table { border-collapse: collapse; margin: 1rem 0; font-size: 0.9rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: 0.3rem 0; }
td { white-space: nowrap; } sup { line-height: 0; }
th, td { padding: 0.2rem 0.6rem; text-align: right; border-bottom: 1px solid #e6e6e6; }
th { border-bottom: 1px solid #888; } th:first-child, td:first-child { text-align: left; }
figure { margin: 1.5rem 0; } figure svg { max-width: 100%; height: auto; }
figcaption { font-size: 0.9rem; color: #444; }
.warning { border-left: 4px solid #d55e00; padding: 0.5rem 1rem; background: #fdf3ec; }
details { margin: 0.5rem 0; } summary { cursor: pointer; }
@media print { details > * { display: block; } }
)css";

/// mantissa·10^exponent
std::string scientific(double mantissa, int exponent, int decimals) {
  return fmt::format("{:.{}f}·10<sup>{}{}</sup>", mantissa, decimals, exponent < 0 ? "−" : "",
                     std::abs(exponent));
}

std::string row(const std::vector<std::string>& cells, const char* tag) {
  std::string line = "<tr>";
  for (const std::string& cell : cells) line += fmt::format("<{0}>{1}</{0}>", tag, cell);
  return line + "</tr>\n";
}

}  // namespace

std::string text(std::string_view plain) { return escape_xml(plain); }

std::string number(double value) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return "—";
  const double size = std::abs(value);
  const int exponent = static_cast<int>(std::floor(std::log10(size)));
  if (exponent < -4 || exponent > 6)
    return scientific(value / std::pow(10.0, exponent), exponent, 3);
  return fmt::format("{:.{}f}", value, exponent < 3 ? 3 - exponent : 0);
}

std::string percent(double share) {
  const double value = 100 * share;
  if (value == 0) return "0 %";
  if (std::abs(value) < 0.01) return "&lt; 0.01 %";
  return fmt::format("{:.{}f} %", value, std::abs(value) < 1 ? 2 : 1);
}

std::string change(double share) {
  if (share == 0) return "nothing";
  return share < 1 ? percent(share) : "a factor of " + number(1 + share);
}

std::string probability(const TailProbability& p) {
  if (p.log_p == 0) return "1";
  if (!std::isfinite(p.log_p)) return "0";
  const double log10 = p.log_p / std::numbers::ln10;
  if (log10 > -3) return fmt::format("{:.3f}", p.p);
  const int exponent = static_cast<int>(std::floor(log10));
  return scientific(std::pow(10.0, log10 - exponent), exponent, 1);
}

std::string table(const std::string& caption, const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows) {
  std::string out = "<table><caption>" + caption + "</caption>\n" + row(head, "th");
  for (const std::vector<std::string>& cells : rows) out += row(cells, "td");
  return out + "</table>\n";
}

std::string paragraph(const std::string& content) { return "<p>" + content + "</p>\n"; }

std::string list(const std::vector<std::string>& items) {
  std::string out = "<ul>\n";
  for (const std::string& item : items) out += "<li>" + item + "</li>\n";
  return out + "</ul>\n";
}

std::string folded(const std::string& summary, const std::string& content) {
  return "<details><summary>" + summary + "</summary>\n" + content + "</details>\n";
}

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
         text(title) + "</title>\n<style>" + std::string(kStyle) + "</style>\n</head>\n<body>\n" +
         body + "</body>\n</html>\n";
}

}  // namespace relumbre::html
