/// The real-time stage on a GPU: E -> B at the speed of its memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "relumbre/radiosity/relight_operator.h"

namespace relumbre::cuda {

/// What a device's operators are made from. All spans must outlive the constructor only.
struct RelightParts {
  const SparseCounts& counts;                    ///< U: n × k
  std::span<const std::uint32_t> patch_offsets;  ///< k + 1, in elements
  std::span<const float> weight;                 ///< n; V_ip of the patch p that element i is of
  std::span<const Rgb> reflectance;              ///< n, in [0, 1)
  /// M − I of each channel, k × k, row-major.
  std::array<std::span<const double>, 3> transport;
};

/// B = E + R U M Vᵀ E. U is read once for all three channels, and once for up to eight sources, as
/// counts of 8 or 16 bits or half-precision floats, by the tensor cores with float32 sums; the
/// other operand is split into two halves, which hold 22 bits. Within 1e-5 of the largest B of the
/// same in float64 (kFloat16 rounds counts above 2048). Any n and k. One source runs as a graph:
///
///   E ─► gather e = VᵀE ─► y = M e ─► split y ─► rows of U y ─► B
///
/// Where E is small, the kernels read it and write B in page-locked memory of the host; else E is
/// copied, and B in parts, each while the next one is made.
///
/// All on the device that is current in the constructor. One call at a time.
class DeviceRelight final : public RelightOperator {
 public:
  /// Throws ShapeError where sizes disagree, ValueError for format kFloat32, reflectances outside
  /// [0, 1) or invalid counts, OutOfDeviceMemory with figures before anything large is allocated.
  DeviceRelight(const RelightParts& parts, CountFormat format);
  ~DeviceRelight() override;
  DeviceRelight(DeviceRelight&&) noexcept;
  DeviceRelight& operator=(DeviceRelight&&) noexcept;

  [[nodiscard]] std::size_t elements() const override;
  [[nodiscard]] std::size_t patches() const override;
  [[nodiscard]] std::string_view name() const override { return "cuda"; }
  /// Of device memory.
  [[nodiscard]] std::size_t bytes_per_apply() const override;
  /// What the operator takes of the device's memory, before a batch is asked for.
  [[nodiscard]] static std::size_t device_bytes(const SparseCounts& counts, CountFormat format);

  void set_reflectance(std::span<const Rgb> reflectance,
                       const std::array<std::span<const double>, 3>& transport);

  /// For those who avoid copies: page-locked, n × 3. relight() reads one and writes the other.
  [[nodiscard]] std::span<float> emission() const;
  [[nodiscard]] std::span<const float> radiosity() const;
  /// Throws ValueError naming the first value that is not finite.
  void relight() const;
  /// The kernels alone, `times` in a row, without copies: seconds each, by events.
  [[nodiscard]] double measure_kernels(int times, std::size_t sources = 1) const;
  /// The pass over U alone.
  [[nodiscard]] double measure_scatter(int times) const;

 private:
  void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                     std::size_t sources) const override;

  class Work;
  std::unique_ptr<Work> work_;
};

/// How the paper's stage is split between the two processors.
enum class PaperStage {
  kDense,       ///< two SGEMV a channel on the device; E and B are copied each time
  kSparseV,     ///< Vᵀ E as a segmented sum on the device
  kGatherHere,  ///< Vᵀ E on the CPU, Y e on the device: only e is sent
  kSplitRows,   ///< as kGatherHere, and a share of the rows of Y e on the CPU meanwhile
};
inline constexpr std::array kPaperStages = {PaperStage::kDense, PaperStage::kSparseV,
                                            PaperStage::kGatherHere, PaperStage::kSplitRows};
std::string_view to_string(PaperStage stage);

/// The paper's stage on the GPU by cuBLAS, the baseline, and the variants that it proposes as
/// future work: dense float32 Y_c = −R_c U M_c. One call at a time.
/// Source: the low-rank radiosity paper, §3 and §5.
class PaperRelight final : public RelightOperator {
 public:
  /// `cpu_share` of the rows is the CPU's, of kSplitRows alone. Throws as DeviceRelight; ValueError
  /// for a share outside [0, 1].
  PaperRelight(const RelightParts& parts, PaperStage stage, double cpu_share = 0.05);
  ~PaperRelight() override;
  PaperRelight(PaperRelight&&) noexcept;
  PaperRelight& operator=(PaperRelight&&) noexcept;

  [[nodiscard]] std::size_t elements() const override;
  [[nodiscard]] std::size_t patches() const override;
  [[nodiscard]] std::string_view name() const override;
  [[nodiscard]] std::size_t bytes_per_apply() const override;

  /// Three channels of one field as the paper does them, one after the other, each from and to
  /// page-locked memory of its own: what it times.
  void relight_channels() const;

 private:
  void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                     std::size_t sources) const override;

  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace relumbre::cuda
