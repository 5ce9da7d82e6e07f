/// Does the transport conserve energy? What a bake says about itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

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

/// counts: n × k; area: n, m²; patch_offsets: k + 1, in elements. Throws ShapeError where the sizes
/// disagree. O(non-zeros · log k) time, 16 bytes a pair of patches that see each other.
EnergyReport energy_report(const SparseCounts& counts, std::span<const float> area,
                           std::span<const std::uint32_t> patch_offsets, const RayTally& tally);

}  // namespace relumbre
