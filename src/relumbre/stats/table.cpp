#include "relumbre/stats/table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void check_values(std::span<const double> values, const std::string& name) {
  if (values.empty()) throw ValueError(fmt::format("{}: there are no rows", name));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw ValueError(fmt::format("{}: row {} is {}, not a finite number", name, i, values[i]));
  if (std::ranges::all_of(values, [&](double v) { return v == values[0]; }))
    throw ValueError(fmt::format("{}: all {} rows are {}", name, values.size(), values[0]));
}

void check_levels(const Factor& factor, std::size_t rows) {
  if (factor.rows.size() != rows)
    throw ShapeError(fmt::format("factor {} has {} rows, the response {}", factor.name,
                                 factor.rows.size(), rows));
  for (std::size_t i = 0; i < rows; ++i)
    if (factor.rows[i] >= factor.levels.size())
      throw ValueError(fmt::format("factor {}: row {} has level {} of {}", factor.name, i,
                                   factor.rows[i], factor.levels.size()));
}

void check_factor(const Factor& factor, std::size_t rows) {
  check_levels(factor, rows);
  const std::set<std::uint32_t> used(factor.rows.begin(), factor.rows.end());
  if (used.size() < 2)
    throw ValueError(fmt::format("factor {} has one level, \"{}\": there is nothing to compare",
                                 factor.name, factor.levels[*used.begin()]));
}

}  // namespace

Factor make_factor(std::string name, std::span<const std::string> labels) {
  Factor factor{std::move(name), {}, {}};
  std::map<std::string, std::uint32_t> index;
  for (const std::string& label : labels) {
    const auto next = static_cast<std::uint32_t>(index.size());
    const auto [place, is_new] = index.emplace(label, next);
    if (is_new) factor.levels.push_back(label);
    factor.rows.push_back(place->second);
  }
  return factor;
}

void check_table(const Table& table) {
  check_values(table.values, table.response);
  if (table.factors.empty()) throw ValueError(table.response + ": there are no factors");
  std::set<std::string> names;
  for (const Factor& factor : table.factors) {
    check_factor(factor, table.values.size());
    if (!names.insert(factor.name).second)
      throw ValueError(fmt::format("two factors are named {}", factor.name));
  }
}

std::vector<std::vector<double>> groups_of(std::span<const double> values, const Factor& factor) {
  check_levels(factor, values.size());
  std::vector<std::vector<double>> groups(factor.levels.size());
  for (std::size_t i = 0; i < values.size(); ++i) groups[factor.rows[i]].push_back(values[i]);
  return groups;
}

Groups comparable_groups(std::span<const double> values, const Factor& factor) {
  check_values(values, "the response");
  check_factor(factor, values.size());
  Groups kept;
  std::vector<std::vector<double>> groups = groups_of(values, factor);
  for (std::uint32_t level = 0; level < groups.size(); ++level) {
    if (groups[level].empty()) continue;
    kept.values.push_back(std::move(groups[level]));
    kept.levels.push_back(level);
  }
  return kept;
}

}  // namespace relumbre
