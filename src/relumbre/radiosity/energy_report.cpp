#include "relumbre/radiosity/energy_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

/// A row that sums to less has lost rays.
constexpr double kClosed = 0.999;

void add_tally(const RayTally& tally, EnergyReport& report) {
  report.rays = tally.hits + tally.back_face + tally.escaped;
  if (report.rays == 0) return;
  const auto rays = static_cast<double>(report.rays);
  report.back_face = static_cast<double>(tally.back_face) / rays;
  report.escaped = static_cast<double>(tally.escaped) / rays;
}

}  // namespace

EnergyAudit::EnergyAudit(std::span<const float> area, std::span<const std::uint32_t> patch_offsets)
    : area_(area), patch_offsets_(patch_offsets) {
  if (patch_offsets.empty() || patch_offsets.back() != area.size()) {
    throw ShapeError(fmt::format("energy report: {} areas, {} patch offsets", area.size(),
                                 patch_offsets.size()));
  }
  value_.resize(patch_offsets.size() - 1);
  variance_.resize(value_.size());
  exchanges_.reserve(value_.size());
  finish_patches();
}

void EnergyAudit::add(const SparseCounts& rows) {
  if (rows.columns != value_.size() || rows.rows() > area_.size() - next_row_) {
    throw ShapeError(fmt::format("energy report: {} × {} counts from row {} on, of {} × {}",
                                 rows.rows(), rows.columns, next_row_, area_.size(),
                                 value_.size()));
  }
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    const auto area = static_cast<double>(area_[next_row_]);
    add_row_sum(rows.row_counts(i), area, rows.rays);
    add_exchange(rows, i, area);
    ++next_row_;
    finish_patches();
  }
}

void EnergyAudit::add_row_sum(std::span<const std::uint32_t> counts, double area, double rays) {
  std::uint64_t hits = 0;
  for (const std::uint32_t count : counts) hits += count;
  const double sum = static_cast<double>(hits) / rays;
  row_sum_min_ = std::min(row_sum_min_, sum);
  row_sum_max_ = std::max(row_sum_max_, sum);
  weighted_row_sum_ += area * sum;
  if (sum < kClosed) ++open_rows_;
}

void EnergyAudit::add_exchange(const SparseCounts& rows, std::size_t row, double area) {
  const auto columns = rows.row_columns(row), counts = rows.row_counts(row);
  for (std::size_t e = 0; e < columns.size(); ++e) {
    const double f = static_cast<double>(counts[e]) / rows.rays;
    if (value_[columns[e]] == 0) touched_.push_back(columns[e]);
    value_[columns[e]] += area * f;
    variance_[columns[e]] += area * area * f * (1 - f) / rows.rays;
  }
}

/// Stores the exchange of every patch whose last row has been read.
void EnergyAudit::finish_patches() {
  while (exchanges_.size() < value_.size() && patch_offsets_[exchanges_.size() + 1] <= next_row_) {
    std::ranges::sort(touched_);
    ExchangeRow row;
    row.reserve(touched_.size());
    for (const std::uint32_t q : touched_) {
      row.push_back({q, static_cast<float>(variance_[q]), value_[q]});
      value_[q] = variance_[q] = 0;
    }
    touched_.clear();
    exchanges_.push_back(std::move(row));
  }
}

/// The exchange of two patches, or one of value 0.
EnergyAudit::Exchange EnergyAudit::exchange(std::size_t patch, std::uint32_t column) const {
  const ExchangeRow& row = exchanges_[patch];
  const auto found = std::ranges::lower_bound(row, column, {}, &Exchange::column);
  return found != row.end() && found->column == column ? *found : Exchange{column, 0, 0};
}

void EnergyAudit::report_reciprocity(EnergyReport& report) const {
  double whole = 0, error = 0, noise = 0;
  for (std::size_t p = 0; p < exchanges_.size(); ++p) {
    for (const auto& [q, variance, value] : exchanges_[p]) {
      whole += value;
      if (q == p) continue;
      const Exchange mirror = exchange(q, static_cast<std::uint32_t>(p));
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

EnergyReport EnergyAudit::report(const RayTally& tally) const {
  if (next_row_ != area_.size()) {
    throw ShapeError(fmt::format("energy report: {} rows of {}", next_row_, area_.size()));
  }
  EnergyReport report;
  report.elements = area_.size();
  report.patches = exchanges_.size();
  add_tally(tally, report);
  if (area_.empty()) return report;
  double whole = 0;
  for (const float a : area_) whole += static_cast<double>(a);
  report.row_sum_min = row_sum_min_;
  report.row_sum_mean = weighted_row_sum_ / whole;
  report.row_sum_max = row_sum_max_;
  report.open_rows = static_cast<double>(open_rows_) / static_cast<double>(area_.size());
  report_reciprocity(report);
  return report;
}

EnergyReport energy_report(const SparseCounts& counts, std::span<const float> area,
                           std::span<const std::uint32_t> patch_offsets, const RayTally& tally) {
  EnergyAudit audit(area, patch_offsets);
  audit.add(counts);
  return audit.report(tally);
}

}  // namespace relumbre
