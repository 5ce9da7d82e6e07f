/// E -> B: the real-time stage, behind one interface.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/radiosity/sparse_counts.h"

namespace relumbre {

/// Solves (I − RF)B = E approximately, for RGB. apply() is thread-safe with respect to
/// other operators but uses scratch of its own: one apply() at a time on one operator.
class RelightOperator {
 public:
  virtual ~RelightOperator() = default;
  [[nodiscard]] virtual std::size_t elements() const = 0;
  [[nodiscard]] virtual std::size_t patches() const = 0;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Bytes read and written by one apply() with one source, for comparison with memory bandwidth.
  [[nodiscard]] virtual std::size_t bytes_per_apply() const = 0;

  /// `emission` and `radiosity`: sources × n × 3 floats, RGB interleaved, W/m²; may be the same
  /// span. Throws ShapeError if the sizes are not sources·n·3, ValueError if emission has a NaN or
  /// an infinity.
  void apply(std::span<const float> emission, std::span<float> radiosity,
             std::size_t sources = 1) const;

 protected:
  virtual void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                             std::size_t sources) const = 0;
};

/// An operator whose reflectances can be edited without tracing a ray.
class EditableOperator : public RelightOperator {
 public:
  /// Recomputes M_c from the counts that the operator holds: the result is that of a new operator.
  /// reflectance: n, in [0, 1). Throws as the making of an operator does, and then changes nothing.
  /// Not while apply() runs. O(n·k + k³) for each of three channels.
  virtual void set_reflectance(std::span<const Rgb> reflectance) = 0;
};

/// What the operators are made from. All spans must outlive the constructor only.
struct OperatorInput {
  const SparseCounts& counts;                    ///< n × k
  std::span<const std::uint32_t> patch_offsets;  ///< k + 1, in elements
  std::span<const float> area;                   ///< n; weights of V: areas, or better seen_area()
  std::span<const Rgb> reflectance;              ///< n, in [0, 1)
};

/// How U is held at run time.
enum class CountFormat { kFloat32, kFloat16, kCounts16, kCounts8 };
std::string_view to_string(CountFormat format);

/// The exact integer format that takes fewer bytes for these counts: 8 bits with the list of counts
/// above 255, or 16 bits.
CountFormat smallest_format(const SparseCounts& counts);

/// B = E + R U M Vᵀ E with U of exact counts (kFloat16 rounds counts above 2048), one pass over U
/// for all three channels. M_c = (I − VᵀR_cU)⁻¹ by LU in float64. Within 1e-5 of the largest B of
/// the same in float64; the same bits for any number of threads and any grouping of sources.
/// Throws ShapeError where the input's sizes disagree, ValueError for reflectances outside [0, 1),
/// invalid counts, or more than 46,340 patches.
std::unique_ptr<EditableOperator> make_compressed_operator(const OperatorInput& input,
                                                           CountFormat format);

/// The paper's stage, the baseline: dense float32 Y_c = −R_c U M_c and V, two SGEMV a channel.
/// Source: the low-rank radiosity paper, eqs. (8) and (9).
std::unique_ptr<RelightOperator> make_paper_operator(const OperatorInput& input);

}  // namespace relumbre
