/// Where an axis has its ticks, and what stands beside them.
#pragma once

#include <string>
#include <vector>

namespace relumbre {

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a minor tick
};

/// Multiples of 1, 2 or 5 times a power of ten within [low, high], low < high, both finite: as many
/// as fit without exceeding `most` (≥ 2). Labels have the decimals that the step needs; thousands,
/// millions … are written k, M, G, T, larger and tiny numbers as 2e-07.
std::vector<Tick> linear_ticks(double low, double high, int most);

/// Powers of ten within [low, high], 0 < low < high; where they are fewer than two, also 2 and 5
/// times those, or all of 1 … 9 times; minor ticks between the powers where they are few enough.
/// Where even that is fewer than two, linear_ticks.
std::vector<Tick> log_ticks(double low, double high, int most);

}  // namespace relumbre
