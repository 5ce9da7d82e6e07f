#include "relumbre/radiosity/compressed_operator.h"

#include <algorithm>
#include <cmath>

#include "relumbre/base/parallel.h"
#include "relumbre/radiosity/operator_input.h"

namespace relumbre {

namespace {

/// A loop is cut into so many chunks, of at least so many bytes: enough to share them out evenly,
/// and long enough that handing over, and prefetching beyond a chunk's end, cost little.
constexpr std::size_t kChunks = 32;
constexpr std::size_t kMinChunkBytes = std::size_t{64} << 10;
/// Work on fewer bytes is done before another thread has woken.
constexpr std::size_t kSerialBytes = std::size_t{96} << 10;
/// Packed operands of a group of sources stay in a core's cache while blocks of U pass by.
constexpr std::size_t kGroupBytes = std::size_t{512} << 10;
/// Rows of U that are multiplied with all sources of a group before the next rows are read.
constexpr std::size_t kRowBlock = 32;

const OperatorInput& checked(const OperatorInput& input) {
  check_operator_input(input);
  return input;
}

/// Small matrices stay in cache whatever their form, and have no list of exceptions to be exact by.
constexpr std::size_t kFixedPatches = 128;

TransportFormat transport_format(CountFormat format, std::size_t patches) {
  return format == CountFormat::kFloat32 || patches < kFixedPatches ? TransportFormat::kFloat32
                                                                    : TransportFormat::kFixed16;
}

/// parallel_chunks over `items` of `bytes` each, in multiples of `step`.
template <class Body>
void parallel_bytes(std::size_t items, std::size_t bytes, std::size_t step, Body&& body) {
  if (items * bytes < kSerialBytes) return body(std::size_t{0}, items);
  const std::size_t chunk = std::max(items * bytes / kChunks, kMinChunkBytes);
  const std::size_t grain = chunk / std::max<std::size_t>(bytes, 1) + 1;
  parallel_chunks(0, items, (grain + step - 1) / step * step, body);
}

}  // namespace

CompressedOperator::CompressedOperator(const OperatorInput& input, CountFormat format,
                                       const RowKernels& kernels)
    : counts_(checked(input).counts, format, kernels),
      mean_(input.patch_offsets, input.area, kernels),
      transport_(patches(), transport_format(format, patches()), kernels) {
  set_reflectance(input.reflectance);
}

std::size_t CompressedOperator::bytes_per_apply() const {
  const std::size_t n = elements();
  const std::size_t vectors = 3 * n * sizeof(float);  // each of E, B and R
  return counts_.bytes() + transport_.bytes() + 3 * vectors + mean_.weights().size_bytes();
}

void CompressedOperator::set_reflectance(std::span<const Rgb> reflectance) {
  check_reflectance(reflectance, elements());
  reflectance_.assign(reflectance.begin(), reflectance.end());
  for (std::size_t c = 0; c < 3; ++c)
    transport_.set_channel(c, interreflections(counts_, mean_, reflectance_, c));
}

void CompressedOperator::apply_checked(std::span<const float> emission, std::span<float> radiosity,
                                       std::size_t sources) const {
  reserve(sources);
  gather(emission, sources);  // e = VᵀE
  const std::size_t group = group_size(sources);
  for (std::size_t s = 0; s < sources; s += group) {
    const std::size_t here = std::min(group, sources - s);
    exchange(s, here);                                    // y = M e
    scatter(emission.data(), radiosity.data(), s, here);  // B = E + R U y
  }
}

std::size_t CompressedOperator::group_size(std::size_t sources) const {
  return std::clamp<std::size_t>(kGroupBytes / counts_.operand_bytes(), 1, sources);
}

void CompressedOperator::reserve(std::size_t sources) const {
  const std::size_t values = sources * 3 * patches();
  if (scratch_.mean.size() < values) {
    scratch_.mean.resize(values);
    scratch_.y.resize(values);
  }
  const std::size_t operand = std::max(counts_.operand_bytes(), 3 * transport_.operand_bytes());
  const std::size_t bytes = group_size(sources) * operand;
  if (scratch_.operands.size() < bytes) scratch_.operands = HugeBuffer(bytes);
}

void CompressedOperator::gather(std::span<const float> emission, std::size_t sources) const {
  const std::size_t n = elements(), k = patches();
  for (std::size_t s = 0; s < sources; ++s) {
    float* mean = scratch_.mean.data() + s * 3 * k;
    parallel_bytes(k, n / k * 4 * sizeof(float), 1, [&](std::size_t first, std::size_t last) {
      mean_.gather(emission.data() + s * 3 * n, first, last, mean);
    });
  }
  float probe = 0;  // 0·x is NaN for a NaN or an infinity
  for (std::size_t v = 0; v < sources * 3 * k; ++v) probe += 0.0F * scratch_.mean[v];
  if (std::isnan(probe)) throw_not_finite(emission, n);
}

void CompressedOperator::exchange(std::size_t first_source, std::size_t sources) const {
  const std::size_t k = patches(), bytes = transport_.operand_bytes();
  const float* mean = scratch_.mean.data() + first_source * 3 * k;
  float* y = scratch_.y.data() + first_source * 3 * k;
  for (std::size_t v = 0; v < sources * 3; ++v)
    transport_.pack(mean + v * k, scratch_.operands.data() + v * bytes);
  const std::size_t block = 16;
  const std::size_t blocks = (k + block - 1) / block;  // of rows, in each channel's matrix
  parallel_bytes(3 * blocks, block * transport_.row_bytes(), 1,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t b = first; b < last; ++b) {
                     const std::size_t c = b / blocks, row = b % blocks * block;
                     for (std::size_t s = 0; s < sources; ++s) {
                       const std::size_t v = s * 3 + c;
                       transport_.multiply(c, row, std::min(row + block, k), mean + v * k,
                                           scratch_.operands.data() + v * bytes, y + v * k);
                     }
                   }
                 });
  const float per_ray = 1.0F / static_cast<float>(counts_.rays());
  for (std::size_t v = 0; v < sources * 3 * k; ++v) y[v] *= per_ray;
}

void CompressedOperator::scatter(const float* emission, float* radiosity, std::size_t first_source,
                                 std::size_t sources) const {
  const float* y = scratch_.y.data() + first_source * 3 * patches();
  for (std::size_t s = 0; s < sources; ++s)
    counts_.pack(y + s * 3 * patches(), scratch_.operands.data() + s * counts_.operand_bytes());
  parallel_bytes(elements(), counts_.row_bytes(), kRowBlock,
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t i = first; i < last; i += kRowBlock)
                     scatter_rows(i, std::min(i + kRowBlock, last), emission, radiosity,
                                  first_source, sources);
                 });
}

void CompressedOperator::scatter_rows(std::size_t first, std::size_t last, const float* emission,
                                      float* radiosity, std::size_t first_source,
                                      std::size_t sources) const {
  float uy[3 * kRowBlock];
  const float* reflectance = &reflectance_[first].x;
  for (std::size_t s = 0; s < sources; ++s) {
    const std::size_t source = first_source + s;
    counts_.multiply(first, last, scratch_.y.data() + source * 3 * patches(),
                     scratch_.operands.data() + s * counts_.operand_bytes(), uy);
    const float* e = emission + 3 * (source * elements() + first);
    float* b = radiosity + 3 * (source * elements() + first);
    for (std::size_t v = 0; v < 3 * (last - first); ++v) b[v] = e[v] + reflectance[v] * uy[v];
  }
}

std::unique_ptr<EditableOperator> make_compressed_operator(const OperatorInput& input,
                                                           CountFormat format) {
  return std::make_unique<CompressedOperator>(input, format);
}

}  // namespace relumbre
