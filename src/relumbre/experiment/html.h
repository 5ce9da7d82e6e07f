/// Pieces of HTML: escaped text, numbers, tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "relumbre/stats/distributions.h"

namespace relumbre::html {

std::string text(std::string_view plain);

/// Four significant digits, as HTML: "12.35", "1.235·10<sup>7</sup>".
std::string number(double value);
/// "62.1 %"
std::string percent(double share);
/// How much larger something is: "nothing", "3.2 %", and from twice on "a factor of 14.20".
std::string change(double share);
/// "0.042", "1.3·10<sup>−9</sup>", also where p underflows.
std::string probability(const TailProbability& p);

/// A table of HTML cells; all columns but the first are numbers. Every row is as long as the head.
std::string table(const std::string& caption, const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& rows);

std::string paragraph(const std::string& content);
std::string list(const std::vector<std::string>& items);
/// What opens on a click.
std::string folded(const std::string& summary, const std::string& content);

/// A page by itself: style inline, nothing loaded.
std::string page(const std::string& title, const std::string& body);

}  // namespace relumbre::html
