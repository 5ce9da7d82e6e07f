#include "relumbre/radiosity/energy_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void check(const SparseCounts& counts, std::span<const float> area,
           std::span<const std::uint32_t> patch_offsets) {
  const bool same = counts.rows() == area.size() && !patch_offsets.empty() &&
                    counts.columns == patch_offsets.size() - 1 &&
                    patch_offsets.back() == counts.rows();
  if (!same) {
    throw ShapeError(fmt::format("energy report: {} × {} counts, {} areas, {} patch offsets",
                                 counts.rows(), counts.columns, area.size(), patch_offsets.size()));
  }
}

void add_row_sums(const SparseCounts& counts, std::span<const float> area, EnergyReport& report) {
  double weighted = 0, whole = 0, open = 0;
  report.row_sum_min = counts.rows() == 0 ? 0 : 1;
  for (std::size_t i = 0; i < counts.rows(); ++i) {
    std::uint64_t hits = 0;
    for (const std::uint32_t count : counts.row_counts(i)) hits += count;
    const double sum = static_cast<double>(hits) / counts.rays;
    report.row_sum_min = std::min(report.row_sum_min, sum);
    report.row_sum_max = std::max(report.row_sum_max, sum);
    open += sum < 0.999 ? 1 : 0;
    weighted += static_cast<double>(area[i]) * sum;
    whole += static_cast<double>(area[i]);
  }
  if (counts.rows() == 0) return;
  report.row_sum_mean = weighted / whole;
  report.open_rows = open / static_cast<double>(counts.rows());
}

/// A_p F_pq of the pairs of patches for which it is not 0, compressed by rows, q ascending, with
/// the variance that independent rays would give it.
struct PatchExchange {
  struct Entry {
    std::uint32_t column;
    float variance;
    double value;
  };
  std::vector<std::size_t> offsets{0};
  std::vector<Entry> entries;

  [[nodiscard]] std::span<const Entry> row(std::size_t p) const {
    return std::span(entries).subspan(offsets[p], offsets[p + 1] - offsets[p]);
  }
  /// The entry (p, q), or one of value 0.
  [[nodiscard]] Entry at(std::size_t p, std::uint32_t q) const {
    const auto entries_of_p = row(p);
    const auto found = std::lower_bound(
        entries_of_p.begin(), entries_of_p.end(), q,
        [](const Entry& entry, std::uint32_t column) { return entry.column < column; });
    return found != entries_of_p.end() && found->column == q ? *found : Entry{q, 0, 0};
  }
};

PatchExchange exchange(const SparseCounts& counts, std::span<const float> area,
                       std::span<const std::uint32_t> patch_offsets) {
  PatchExchange result;
  std::vector<double> value(counts.columns), variance(counts.columns);
  std::vector<std::uint32_t> touched;
  for (std::size_t p = 0; p + 1 < patch_offsets.size(); ++p) {
    for (std::size_t i = patch_offsets[p]; i < patch_offsets[p + 1]; ++i) {
      const auto columns = counts.row_columns(i), hits = counts.row_counts(i);
      for (std::size_t e = 0; e < columns.size(); ++e) {
        const double a = static_cast<double>(area[i]),
                     f = static_cast<double>(hits[e]) / counts.rays;
        if (value[columns[e]] == 0) touched.push_back(columns[e]);
        value[columns[e]] += a * f;
        variance[columns[e]] += a * a * f * (1 - f) / counts.rays;
      }
    }
    std::sort(touched.begin(), touched.end());
    for (const std::uint32_t q : touched) {
      result.entries.push_back({q, static_cast<float>(variance[q]), value[q]});
      value[q] = variance[q] = 0;
    }
    touched.clear();
    result.offsets.push_back(result.entries.size());
  }
  return result;
}

void add_reciprocity(const PatchExchange& exchange, EnergyReport& report) {
  double whole = 0, error = 0, noise = 0;
  for (std::size_t p = 0; p + 1 < exchange.offsets.size(); ++p) {
    for (const auto& [q, variance, value] : exchange.row(p)) {
      whole += value;
      if (q == p) continue;
      const auto mirror = exchange.at(q, static_cast<std::uint32_t>(p));
      // A pair that only one side sees is met once, any other twice.
      const double times = mirror.value == 0 ? 2 : 1;
      error += times * std::abs(value - mirror.value);
      // The mean of |x| for a normal x of that variance.
      noise +=
          times * std::sqrt(2 / std::numbers::pi *
                            (static_cast<double>(variance) + static_cast<double>(mirror.variance)));
    }
  }
  if (whole == 0) return;
  report.reciprocity_error = error / whole;
  report.reciprocity_noise = noise / whole;
}

void add_tally(const RayTally& tally, EnergyReport& report) {
  report.rays = tally.hits + tally.back_face + tally.escaped;
  if (report.rays == 0) return;
  const auto rays = static_cast<double>(report.rays);
  report.back_face = static_cast<double>(tally.back_face) / rays;
  report.escaped = static_cast<double>(tally.escaped) / rays;
}

}  // namespace

EnergyReport energy_report(const SparseCounts& counts, std::span<const float> area,
                           std::span<const std::uint32_t> patch_offsets, const RayTally& tally) {
  check(counts, area, patch_offsets);
  EnergyReport report;
  report.elements = counts.rows();
  report.patches = counts.columns;
  add_row_sums(counts, area, report);
  add_reciprocity(exchange(counts, area, patch_offsets), report);
  add_tally(tally, report);
  return report;
}

}  // namespace relumbre
