/// What statistics are computed on: one response a row, and the levels of named factors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relumbre {

/// A categorical factor: the level of every row, by name.
struct Factor {
  std::string name;
  std::vector<std::string> levels;  ///< names, in the order in which they are shown
  std::vector<std::uint32_t> rows;  ///< index into levels, one a row
};

/// The factor of these labels, one a row. Levels are in the order in which they first appear.
Factor make_factor(std::string name, std::span<const std::string> labels);

/// n rows of a response and any number of factors.
struct Table {
  std::string response;             ///< the response's name
  std::vector<double> values = {};  ///< n of them
  std::vector<Factor> factors = {};
};

/// Throws an error that names the factor or the response: ShapeError where lengths disagree,
/// ValueError where there are no rows or no factors, a response is NaN or infinite, all responses
/// are equal, a factor's name is taken twice, a level does not exist, or fewer than two of a
/// factor's levels have rows.
void check_table(const Table& table);

/// The responses of every level of a factor, in the order of the rows; levels without rows have
/// none. Throws ShapeError or ValueError where lengths disagree or a level does not exist.
std::vector<std::vector<double>> groups_of(std::span<const double> values, const Factor& factor);

/// groups_of for tests that compare groups: throws as check_table would on a table of this factor
/// alone, and drops levels that have no rows; `levels` says which were kept.
struct Groups {
  std::vector<std::vector<double>> values;
  std::vector<std::uint32_t> levels;
};
Groups comparable_groups(std::span<const double> values, const Factor& factor);

}  // namespace relumbre
