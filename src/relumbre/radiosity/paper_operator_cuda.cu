// The paper's real-time stage on a GPU, B = E − Y_c (Vᵀ E), and its splits between both processors.
//
//   V     n × k    dense, for kDense alone
//   Y_c   n × k    −R_c U M_c; columns contiguous, as the paper's
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/cuda/device.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/cuda/memory.h"
#include "relumbre/radiosity/blas_cuda.h"
#include "relumbre/radiosity/operator_input.h"
#include "relumbre/radiosity/patch_kernels.cuh"
#include "relumbre/radiosity/relight_checks_cuda.h"

namespace relumbre::cuda {

namespace {

constexpr unsigned kThreads = 256;

unsigned blocks_of(std::size_t items) {
  return static_cast<unsigned>((items + kThreads - 1) / kThreads);
}

/// Rows of counts as floats, scaled: row[i][p] = −R_i · c_ip / rays. One thread a row.
__global__ void place_scaled_rows(const std::uint64_t* offsets, const std::uint32_t* column,
                                  const std::uint32_t* count, const float* reflectance,
                                  unsigned channel, float per_ray, std::size_t rows,
                                  std::size_t columns, float* table) {
  const std::size_t row = std::size_t{blockIdx.x} * kThreads + threadIdx.x;
  if (row >= rows) return;
  const float scale = -reflectance[3 * row + channel] * per_ray;
  for (std::uint64_t at = offsets[row]; at < offsets[row + 1]; ++at)
    table[row * columns + column[at]] = scale * static_cast<float>(count[at]);
}

/// V with contiguous columns. One thread a patch.
__global__ void place_weights(const std::uint32_t* offsets, const float* weight, std::size_t rows,
                              std::size_t columns, float* v) {
  const std::size_t p = std::size_t{blockIdx.x} * kThreads + threadIdx.x;
  if (p >= columns) return;
  for (std::uint32_t i = offsets[p]; i < offsets[p + 1]; ++i) v[p * rows + i] = weight[i];
}

/// mean[p] = Σ weight · e over a patch's elements, of one channel. One warp a patch.
__global__ void gather_channel(const float* e, const float* weight, const std::uint32_t* offsets,
                               unsigned patches, float* mean) {
  const unsigned p = (blockIdx.x * kThreads + threadIdx.x) / kWarp;
  float sum = 0;
  if (p < patches)
    for (std::uint32_t i = offsets[p] + threadIdx.x % kWarp; i < offsets[p + 1]; i += kWarp)
      sum = fmaf(weight[i], e[i], sum);
  sum = warp_sum(sum);
  if (p < patches && threadIdx.x % kWarp == 0) mean[p] = sum;
}

}  // namespace

class PaperRelight::Work {
 public:
  Work(const RelightParts& parts, PaperStage stage, double cpu_share)
      : stage_(stage),
        n_(parts.counts.rows()),
        k_(parts.counts.columns),
        here_(stage == PaperStage::kSplitRows
                  ? static_cast<std::size_t>(std::lround(cpu_share * static_cast<double>(n_)))
                  : 0),
        offsets_(parts.patch_offsets.begin(), parts.patch_offsets.end()),
        weight_(parts.weight.begin(), parts.weight.end()),
        device_offsets_(to_device(parts.patch_offsets, stream_)),
        device_weight_(to_device(parts.weight, stream_)),
        e_(n_),
        mean_(k_),
        here_e_(n_),
        here_b_(n_),
        here_mean_(k_) {
    if (stage == PaperStage::kDense) place_v();
    for (std::size_t c = 0; c < 3; ++c) make_y(parts, c);
    std::fill_n(here_e_.data(), n_, 1.0F);
  }

  [[nodiscard]] std::size_t elements() const { return n_; }
  [[nodiscard]] std::size_t patches() const { return k_; }
  [[nodiscard]] PaperStage stage() const { return stage_; }
  [[nodiscard]] std::size_t bytes_per_apply() const {
    const std::size_t matrices = stage_ == PaperStage::kDense ? 2 : 1;
    return 3 * sizeof(float) * (matrices * n_ * k_ + 3 * n_);
  }

  void relight(std::span<const float> emission, std::span<float> radiosity, std::size_t sources) {
    for (const float e : emission)
      if (!std::isfinite(e)) throw_not_finite(emission, n_);
    for (std::size_t s = 0; s < sources; ++s) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = 3 * s * n_ + c;
        for (std::size_t i = 0; i < n_; ++i) here_e_.data()[i] = emission[at + 3 * i];
        relight_channel(c);
        for (std::size_t i = 0; i < n_; ++i) radiosity[at + 3 * i] = here_b_.data()[i];
      }
    }
  }

  void relight_channel(std::size_t channel) {
    if (stage_ == PaperStage::kDense || stage_ == PaperStage::kSparseV)
      apply_there(channel);
    else
      apply_on_both(channel);
  }

 private:
  void place_v() {
    v_ = DeviceArray<float>(n_ * k_);
    clear(v_.data(), v_.size(), stream_);
    launch(place_weights, {.blocks = blocks_of(k_), .threads = kThreads}, stream_,
           device_offsets_.data(), device_weight_.data(), n_, k_, v_.data());
  }

  /// Y = (−R U / rays) M by one product of matrices on the device.
  void make_y(const RelightParts& parts, std::size_t channel) {
    std::vector<float> m(parts.transport[channel].begin(), parts.transport[channel].end());
    for (std::size_t p = 0; p < k_; ++p) m[p * k_ + p] += 1;
    const auto device_m = to_device(std::span<const float>(m), stream_);
    const auto reflectance =
        to_device(std::span<const float>(&parts.reflectance[0].x, 3 * n_), stream_);
    const auto offsets =
        to_device(std::span<const std::uint64_t>(parts.counts.row_offsets), stream_);
    const auto column = to_device(std::span<const std::uint32_t>(parts.counts.column), stream_);
    const auto count = to_device(std::span<const std::uint32_t>(parts.counts.count), stream_);
    DeviceArray<float> rows(n_ * k_);
    clear(rows.data(), rows.size(), stream_);
    launch(place_scaled_rows, {.blocks = blocks_of(n_), .threads = kThreads}, stream_,
           offsets.data(), column.data(), count.data(), reflectance.data(),
           static_cast<unsigned>(channel), 1.0F / static_cast<float>(parts.counts.rays), n_, k_,
           rows.data());
    y_[channel] = DeviceArray<float>(n_ * k_);
    blas_.gemm(stream_, {.rows = n_,
                         .columns = k_,
                         .inner = k_,
                         .a = {rows.data(), k_, true},
                         .b = {device_m.data(), k_, true},
                         .c = y_[channel].data(),
                         .c_stride = n_});
    stream_.wait();
    keep_rows(channel);
  }

  /// The CPU's share of Y's rows, one after the other.
  void keep_rows(std::size_t channel) {
    if (here_ == 0) return;
    std::vector<float> columns(n_ * k_);
    copy_to_host(y_[channel].data(), columns, stream_);
    stream_.wait();
    here_y_[channel].resize(here_ * k_);
    for (std::size_t i = 0; i < here_; ++i)
      for (std::size_t p = 0; p < k_; ++p) here_y_[channel][i * k_ + p] = columns[p * n_ + i];
  }

  /// All on the device; B replaces E there.
  void apply_there(std::size_t channel) {
    copy_to_device<float>(values_of(here_e_), e_.data(), stream_);
    if (stage_ == PaperStage::kDense) {
      blas_.gemv(stream_, n_, k_, {v_.data(), n_, true}, e_.data(), 1, 0, mean_.data());
    } else {
      launch(gather_channel, {.blocks = blocks_of(k_ * kWarp), .threads = kThreads}, stream_,
             e_.data(), device_weight_.data(), device_offsets_.data(), static_cast<unsigned>(k_),
             mean_.data());
    }
    blas_.gemv(stream_, n_, k_, {y_[channel].data(), n_}, mean_.data(), -1, 1, e_.data());
    copy_to_host(e_.data(), values_of(here_b_), stream_);
    stream_.wait();
  }

  /// Vᵀ E here; Y e there, but for the first rows, which are done here meanwhile.
  void apply_on_both(std::size_t channel) {
    const float* e = here_e_.data();
    parallel_for(0, k_, 64, [&](std::size_t p) {
      float sum = 0;
      for (std::uint32_t i = offsets_[p]; i < offsets_[p + 1]; ++i) sum += weight_[i] * e[i];
      here_mean_.data()[p] = sum;
    });
    const std::size_t there = n_ - here_;
    copy_to_device<float>(values_of(here_mean_), mean_.data(), stream_);
    if (there > 0) {
      blas_.gemv(stream_, there, k_, {y_[channel].data() + here_, n_}, mean_.data(), -1, 0,
                 e_.data());
      copy_to_host(e_.data(), values_of(here_b_).subspan(here_), stream_);
    }
    parallel_for(0, here_, 64, [&](std::size_t i) {
      const float* row = here_y_[channel].data() + i * k_;
      float sum = 0;
      for (std::size_t p = 0; p < k_; ++p) sum += row[p] * here_mean_.data()[p];
      here_b_.data()[i] = e[i] - sum;
    });
    stream_.wait();
    for (std::size_t i = here_; i < n_; ++i) here_b_.data()[i] += e[i];
  }

  PaperStage stage_;
  std::size_t n_, k_, here_;
  Stream stream_;
  Blas blas_;
  std::vector<std::uint32_t> offsets_;
  std::vector<float> weight_;
  DeviceArray<std::uint32_t> device_offsets_;
  DeviceArray<float> device_weight_, v_, e_, mean_;
  std::array<DeviceArray<float>, 3> y_;
  std::array<std::vector<float>, 3> here_y_;
  PinnedArray<float> here_e_, here_b_, here_mean_;
};

std::string_view to_string(PaperStage stage) {
  switch (stage) {
    case PaperStage::kDense:
      return "paper";
    case PaperStage::kSparseV:
      return "paper, sparse V";
    case PaperStage::kGatherHere:
      return "paper, V'E on the CPU";
    case PaperStage::kSplitRows:
      break;
  }
  return "paper, rows on both";
}

PaperRelight::PaperRelight(const RelightParts& parts, PaperStage stage, double cpu_share) {
  check_parts(parts);
  if (!(cpu_share >= 0 && cpu_share <= 1))
    throw ValueError("the CPU's share of the rows is " + std::to_string(cpu_share) +
                     ", not in [0, 1]");
  const std::size_t n = parts.counts.rows(), k = parts.counts.columns;
  const std::size_t matrices = stage == PaperStage::kDense ? 5 : 4;  // three Y, one in the making
  expect_free(matrices * n * k * sizeof(float) + 8 * parts.counts.nonzeros(),
              "the paper's relight operator");
  work_ = std::make_unique<Work>(parts, stage, cpu_share);
}
PaperRelight::~PaperRelight() = default;
PaperRelight::PaperRelight(PaperRelight&&) noexcept = default;
PaperRelight& PaperRelight::operator=(PaperRelight&&) noexcept = default;

std::size_t PaperRelight::elements() const { return work_->elements(); }
std::size_t PaperRelight::patches() const { return work_->patches(); }
std::string_view PaperRelight::name() const { return to_string(work_->stage()); }
std::size_t PaperRelight::bytes_per_apply() const { return work_->bytes_per_apply(); }
void PaperRelight::relight_channels() const {
  for (std::size_t c = 0; c < 3; ++c) work_->relight_channel(c);
}
void PaperRelight::apply_checked(std::span<const float> emission, std::span<float> radiosity,
                                 std::size_t sources) const {
  work_->relight(emission, radiosity, sources);
}

}  // namespace relumbre::cuda
