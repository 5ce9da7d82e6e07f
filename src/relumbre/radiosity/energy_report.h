/// Does the transport conserve energy? What a bake says about itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

struct EnergyReport {
  std::size_t elements = 0, patches = 0;
  std::uint64_t rays = 0;  ///< in all

  /// Σ_p F_ip over elements i: 1 in a closed scene. The mean is weighted by area.
  double row_sum_min = 0, row_sum_mean = 0, row_sum_max = 0;
  double open_rows = 0;  ///< fraction of the rows that sum to less than 0.999

  /// Σ |A_p F_pq − A_q F_qp| / Σ A_p F_pq over all patches p, q, with A_p F_pq = Σ_{i∈p} A_i F_iq:
  /// 0 for exact form factors.
  double reciprocity_error = 0;
  /// What noise alone would make of it if all rays were independent. Quasi-random rays do better,
  /// so an error well above this means that the geometry is at fault: surfaces that cross, or sides
  /// that see what does not see them.
  double reciprocity_noise = 0;

  double back_face = 0;  ///< fraction of the rays that met the back of a one-sided surface
  double escaped = 0;    ///< fraction of the rays that left the scene
};

/// Reads the rows of U once, in order, a block at a time, so that they need not be in memory
/// together. Keeps 16 bytes a pair of patches of which one sees the other.
class EnergyAudit {
 public:
  /// area: n, m²; patch_offsets: k + 1, in elements, of tessellate(); both outlive the audit.
  /// Throws ShapeError where they disagree.
  EnergyAudit(std::span<const float> area, std::span<const std::uint32_t> patch_offsets);

  /// The next rows. Throws ShapeError for rows of other than k columns or beyond n. O(non-zeros).
  void add(const SparseCounts& rows);
  /// Throws ShapeError while rows are missing. O(pairs · log k).
  [[nodiscard]] EnergyReport report(const RayTally& tally) const;

 private:
  /// A_p F_pq of a patch p and the patch `column`, with the variance that independent rays would
  /// give it.
  struct Exchange {
    std::uint32_t column;
    float variance;
    double value;
  };
  using ExchangeRow = std::vector<Exchange>;  // ascending columns

  void add_row_sum(std::span<const std::uint32_t> counts, double area, double rays);
  void add_exchange(const SparseCounts& rows, std::size_t row, double area);
  void finish_patches();
  [[nodiscard]] Exchange exchange(std::size_t patch, std::uint32_t column) const;
  void report_reciprocity(EnergyReport& report) const;

  std::span<const float> area_;
  std::span<const std::uint32_t> patch_offsets_;
  std::size_t next_row_ = 0, open_rows_ = 0;
  double row_sum_min_ = 1, row_sum_max_ = 0, weighted_row_sum_ = 0;
  std::vector<double> value_, variance_;  // of the patch that is being read, by column
  std::vector<std::uint32_t> touched_;    // its columns
  std::vector<ExchangeRow> exchanges_;    // of the patches that have been
};

/// Of counts that are in memory as a whole.
EnergyReport energy_report(const SparseCounts& counts, std::span<const float> area,
                           std::span<const std::uint32_t> patch_offsets, const RayTally& tally);

}  // namespace relumbre
