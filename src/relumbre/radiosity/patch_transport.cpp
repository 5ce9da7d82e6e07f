#include "relumbre/radiosity/patch_transport.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "relumbre/base/parallel.h"
#include "relumbre/linalg/inverse.h"

namespace relumbre {

namespace {

constexpr std::size_t kRowGrain = 16;
/// One entry in so many of a row may be listed exactly, so that the scale need not reach it...
constexpr std::size_t kExcessShare = 128;
/// ...if leaving them out makes the scale at least this much finer.
constexpr double kWorthwhile = 2;

/// Row p of I − VᵀRU.
void fill_row(const CountMatrix& counts, const SegmentMean& mean, std::span<const Rgb> reflectance,
              std::size_t channel, std::size_t p, std::span<double> row) {
  std::vector<double> count(row.size());
  std::ranges::fill(row, 0.0);
  for (std::size_t i = mean.first_element(p); i < mean.first_element(p + 1); ++i) {
    const double weight = static_cast<double>(mean.weights()[i]) *
                          static_cast<double>(reflectance[i][channel]) / counts.rays();
    counts.decode_row(i, count);
    for (std::size_t q = 0; q < row.size(); ++q) row[q] -= weight * count[q];
  }
  row[p] += 1;
}

/// The largest value that the fixed-point part of a row must reach.
double fixed_point_range(std::span<const double> row) {
  std::vector<double> sorted(row.begin(), row.end());
  const auto at = sorted.end() - 1 - static_cast<std::ptrdiff_t>(row.size() / kExcessShare);
  std::nth_element(sorted.begin(), at, sorted.end());
  const double largest = *std::max_element(at, sorted.end());
  const double range = std::max(*at, 0.0);
  return largest > kWorthwhile * range && range > 0 ? range : std::max(largest, 0.0);
}

}  // namespace

std::vector<double> interreflections(const CountMatrix& counts, const SegmentMean& mean,
                                     std::span<const Rgb> reflectance, std::size_t channel) {
  const std::size_t k = counts.columns();
  std::vector<double> matrix(k * k);
  parallel_for(0, k, 1, [&](std::size_t p) {
    fill_row(counts, mean, reflectance, channel, p, std::span(matrix).subspan(p * k, k));
  });
  invert(matrix, k);
  for (std::size_t p = 0; p < k; ++p) matrix[p * k + p] -= 1;
  return matrix;
}

PatchTransport::PatchTransport(std::size_t patches, TransportFormat format,
                               const RowKernels& kernels)
    : patches_(patches),
      entry_bytes_(format == TransportFormat::kFloat32 ? 4 : 2),
      product_(format == TransportFormat::kFloat32 ? kernels.one_float32 : kernels.one_uint16) {
  for (Channel& channel : channels_)
    channel.table = HugeBuffer(patches * row_bytes() + kTablePadding);
}

std::size_t PatchTransport::bytes() const {
  std::size_t total = 0;
  for (const Channel& c : channels_)
    total += patches_ * row_bytes() + c.scale.size() * sizeof(float) +
             c.excess_offsets.size() * sizeof(std::uint64_t) + c.excess.size() * sizeof(Excess);
  return total;
}

void PatchTransport::set_channel(std::size_t channel, std::span<const double> matrix) {
  Channel& to = channels_[channel];
  std::memset(to.table.data() + patches_ * row_bytes(), 0, kTablePadding);
  if (entry_bytes_ == sizeof(float))
    set_float(to, matrix);
  else
    set_fixed(to, matrix);
}

void PatchTransport::set_float(Channel& to, std::span<const double> matrix) const {
  auto* table = reinterpret_cast<float*>(to.table.data());
  parallel_for(0, patches_, kRowGrain, [&](std::size_t p) {
    for (std::size_t q = 0; q < patches_; ++q)
      table[p * patches_ + q] = static_cast<float>(matrix[p * patches_ + q]);
  });
}

void PatchTransport::set_fixed(Channel& to, std::span<const double> matrix) const {
  auto* table = reinterpret_cast<std::uint16_t*>(to.table.data());
  std::vector<std::vector<Excess>> excess(patches_);
  to.scale.assign(patches_, 0);
  parallel_for(0, patches_, kRowGrain, [&](std::size_t p) {
    encode_fixed(matrix.subspan(p * patches_, patches_), table + p * patches_, to.scale[p],
                 excess[p]);
  });
  to.excess.clear();
  to.excess_offsets.assign(1, 0);
  for (const std::vector<Excess>& row : excess) {
    to.excess.insert(to.excess.end(), row.begin(), row.end());
    to.excess_offsets.push_back(to.excess.size());
  }
}

void PatchTransport::encode_fixed(std::span<const double> row, std::uint16_t* table, float& scale,
                                  std::vector<Excess>& excess) {
  constexpr double levels = std::numeric_limits<std::uint16_t>::max();
  const double range = fixed_point_range(row);
  scale = static_cast<float>(range / levels);
  const double inverse = scale > 0 ? 1 / static_cast<double>(scale) : 0.0;
  for (std::size_t q = 0; q < row.size(); ++q) {
    const double level = std::clamp(std::round(row[q] * inverse), 0.0, levels);
    table[q] = static_cast<std::uint16_t>(level);
    if (row[q] > range)
      excess.push_back({static_cast<std::uint32_t>(q),
                        static_cast<float>(row[q] - level * static_cast<double>(scale))});
  }
}

void PatchTransport::multiply(std::size_t channel, std::size_t first, std::size_t last,
                              const float* e, const std::byte* operand, float* y) const {
  const Channel& from = channels_[channel];
  product_.multiply(from.table.data() + first * row_bytes(), last - first, patches_, operand,
                    y + first);
  if (from.scale.empty()) {
    for (std::size_t p = first; p < last; ++p) y[p] += e[p];
    return;
  }
  for (std::size_t p = first; p < last; ++p) {
    float listed = 0;
    for (std::size_t x = from.excess_offsets[p]; x < from.excess_offsets[p + 1]; ++x)
      listed += from.excess[x].value * e[from.excess[x].column];
    y[p] = e[p] + (from.scale[p] * y[p] + listed);
  }
}

}  // namespace relumbre
