/// M = (I − VᵀRU)⁻¹: how light settles between patches, one matrix a channel.
///
/// M − I is held, because the identity would take all the precision. Where k is near n it weighs
/// more than U, so it is held in 16-bit fixed point, a scale a row, with the row's largest 1/128 of
/// entries (contact edges) in a list of exact floats:
///
///   table[c]   row p: q_p0 q_p1 ... q_p,k-1          M_pq − I_pq = scale_p·q + excess
///   scale[c]   k floats
///   excess[c]  (column, value) of row p: excess_offsets[p] ... excess_offsets[p+1]
///
/// This is within 1e-5 of the largest radiosity, half the bytes of float32, and more exact than
/// half-precision floats (docs/decisions/0010-form-of-m.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/huge_array.h"
#include "relumbre/radiosity/count_kernels.h"
#include "relumbre/radiosity/count_matrix.h"
#include "relumbre/radiosity/segment_mean.h"

namespace relumbre {

/// M − I of one channel, k × k, row-major: by LU in float64. Memory: k²·8 bytes; time: O(n·k + k³).
std::vector<double> interreflections(const CountMatrix& counts, const SegmentMean& mean,
                                     std::span<const Rgb> reflectance, std::size_t channel);

/// How M − I is held at run time.
enum class TransportFormat { kFloat32, kFixed16 };

class PatchTransport {
 public:
  PatchTransport(std::size_t patches, TransportFormat format,
                 const RowKernels& kernels = best_row_kernels());

  /// Encodes M − I of a channel: k × k, all ≥ 0 (rounding below is taken for 0).
  void set_channel(std::size_t channel, std::span<const double> matrix);

  [[nodiscard]] std::size_t patches() const { return patches_; }
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t row_bytes() const { return patches_ * entry_bytes_; }

  /// The packed form of k values of e: operand_bytes() bytes, aligned to kOperandAlignment.
  [[nodiscard]] std::size_t operand_bytes() const { return product_.operand_bytes(patches_); }
  void pack(const float* e, std::byte* operand) const { product_.pack(e, patches_, operand); }
  /// y[p] = (M e)_p of a channel for the rows first ≤ p < last. e and y have k values.
  void multiply(std::size_t channel, std::size_t first, std::size_t last, const float* e,
                const std::byte* operand, float* y) const;

 private:
  struct Excess {
    std::uint32_t column;
    float value;
  };
  struct Channel {
    HugeBuffer table;
    std::vector<float> scale;  ///< a row; empty for kFloat32
    std::vector<std::uint64_t> excess_offsets;
    std::vector<Excess> excess;
  };
  static void encode_fixed(std::span<const double> row, std::uint16_t* table, float& scale,
                           std::vector<Excess>& excess);
  void set_float(Channel& to, std::span<const double> matrix) const;
  void set_fixed(Channel& to, std::span<const double> matrix) const;

  std::size_t patches_, entry_bytes_;
  RowProduct product_;
  std::array<Channel, 3> channels_;
};

}  // namespace relumbre
