#include "relumbre/sat/sat_table.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <memory>
#include <thread>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <hwy/cache_control.h>

#include "relumbre/base/error.h"
#include "relumbre/base/huge_array.h"
#include "relumbre/base/parallel.h"
#include "relumbre/sat/sat_kernels.h"

namespace relumbre {

namespace {

/// Strips are this wide if the image has room for kStrips of them: their work buffers then stay in
/// the first-level cache, and rows are long enough for the processor's own prefetching.
constexpr std::size_t kStrips = 8, kLeastStrip = 128, kMostStrip = 512;
/// Rows after which a strip tells its right neighbour how far it is.
constexpr std::size_t kRowsPerReport = 8;
constexpr std::size_t kCacheLine = 64;

std::size_t round_up(std::size_t value, std::size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

/// Larger tables are written past the caches, where their lines would only evict one another.
constexpr std::size_t kLargestCachedTable = std::size_t{1} << 23;

/// In pixels; whole groups of the kernels.
std::size_t strip_width(const SatLayout& layout) {
  const std::size_t width = (layout.width + kStrips - 1) / kStrips;
  return round_up(std::clamp(width, kLeastStrip, kMostStrip), kSatGroup);
}

/// Integers as they are.
template <class In, class T>
bool widen(const In* values, std::size_t count, In lowest, In highest, T* summands) {
  In least = highest, most = lowest;
  for (std::size_t i = 0; i < count; ++i) {
    summands[i] = static_cast<T>(values[i]);
    least = std::min(least, values[i]), most = std::max(most, values[i]);
  }
  return least >= lowest && most <= highest;
}

template <class Real, class T>
auto row_kernel(const SatKernels<T>& kernels, std::size_t channels, bool stream) {
  if constexpr (std::is_same_v<Real, float>)
    return (stream ? kernels.stream_floats : kernels.store_floats)[channels - 1];
  else
    return (stream ? kernels.stream_summands : kernels.store_summands)[channels - 1];
}

/// How many rows of a strip are done. On a cache line of its own: its neighbour polls it.
struct alignas(kCacheLine) Progress {
  std::atomic<std::size_t> rows = 0;
};

/// Waits until `done` has reached `rows`. The strip waited for has been begun by a running thread,
/// since strips are begun from left to right, so the wait ends.
void wait_for(const Progress& done, std::size_t rows) {
  constexpr int kSpins = 1000;
  for (int spin = 0; done.rows.load(std::memory_order_acquire) < rows; ++spin) {
    if (spin < kSpins)
      hwy::Pause();
    else
      std::this_thread::yield();
  }
}

/// One build: what all strips share.
template <class In, class T>
class Builder {
 public:
  Builder(std::span<const In> pixels, const SatLayout& layout, const SatSummands<In>& summands,
          std::span<T> table)
      : pixels_(pixels),
        layout_(layout),
        summands_(summands),
        table_(table),
        strip_(strip_width(layout)),
        strips_((layout.width + strip_ - 1) / strip_),
        workers_(std::min(strips_, thread_count())),
        buffer_(strip_ * layout.channels + kCacheLine),
        sums_(workers_ * buffer_),
        spare_(workers_ * buffer_),
        carries_(layout.height * kSatMaxChannels, T{}),
        progress_(strips_) {
    for (std::size_t i = 0; i < subtrahend_.size(); ++i)
      subtrahend_[i] = summands.mean[i % layout.channels];
    const bool stream = table.size_bytes() > kLargestCachedTable;
    kernel_ = row_kernel<Real>(best_sat_kernels<T>(), layout.channels, stream);
    conversion_ = {summands.scale, subtrahend_.data(), static_cast<float>(summands.lowest),
                   static_cast<float>(summands.highest)};
  }

  bool build() {
    std::fill_n(table_.data(), strips_ > 0 ? layout_.row_stride : table_.size(), T{});
    parallel_chunks(0, workers_, 1, [this](std::size_t worker, std::size_t) { work(worker); });
    return in_range_;
  }

 private:
  /// What the kernel reads.
  using Real = std::conditional_t<std::is_same_v<In, float>, float, T>;

  /// Takes strips from left to right until none is left. Nothing here may throw: another worker may
  /// be waiting for this strip.
  void work(std::size_t worker) noexcept {
    T* sums = sums_.data() + worker * buffer_;
    Real* spare = spare_.data() + worker * buffer_;
    for (std::size_t s = next_++; s < strips_; s = next_++) build_strip(s, sums, spare);
    hwy::FlushStream();
  }

  void build_strip(std::size_t strip, T* sums, Real* spare) {
    std::fill_n(sums, buffer_, T{});
    std::fill_n(spare, buffer_, Real{});
    for (std::size_t y = 0; y < layout_.height; y += kRowsPerReport) {
      const std::size_t end = std::min(y + kRowsPerReport, layout_.height);
      if (strip > 0) wait_for(progress_[strip - 1], end);
      for (std::size_t row = y; row < end; ++row) build_row(strip, row, sums, spare);
      progress_[strip].rows.store(end, std::memory_order_release);
    }
  }

  /// The strip's part of row y of the image: row y + 1 of the table.
  void build_row(std::size_t strip, std::size_t y, T* sums, Real* spare) {
    const std::size_t c = layout_.channels, x = strip * strip_;
    const std::size_t pixels = std::min(strip_, layout_.width - x);
    T* row = table_.data() + layout_.at(0, y + 1);
    if (strip == 0) std::fill_n(row, c, T{});  // column 0
    const In* in = pixels_.data() + (y * layout_.width + x) * c;
    SatRow<Real, T> part{nullptr, 0, 0, &carries_[y * kSatMaxChannels], sums, row + c + x * c};
    const bool ok = add_row(in, pixels, bytes_ahead(y), part, spare);
    if (!ok) in_range_ = false;
  }

  /// Floats go to the kernel from where they are, but for the last ones: it reads whole groups and
  /// a value more, which may not be there.
  bool add_row(const float* in, std::size_t pixels, std::ptrdiff_t ahead, SatRow<float, T> part,
               float* spare) {
    const std::size_t whole = (pixels - 1) / kSatGroup * kSatGroup, done = whole * layout_.channels;
    part.values = in, part.pixels = whole, part.ahead = ahead;
    bool ok = kernel_(part, conversion_);
    const float* end = in + pixels * layout_.channels;
    std::fill(std::copy(in + done, end, spare), spare + (kSatGroup + 1) * layout_.channels, *in);
    part.values = spare, part.pixels = kSatGroup, part.ahead = 0;
    part.sums += done, part.row += done;
    ok &= kernel_(part, conversion_);
    return ok;
  }

  bool add_row(const In* in, std::size_t pixels, std::ptrdiff_t, SatRow<Real, T> part,
               Real* spare) requires(!std::is_same_v<In, float>) {
    const bool ok =
        widen(in, pixels * layout_.channels, summands_.lowest, summands_.highest, spare);
    part.values = spare, part.pixels = round_up(pixels, kSatGroup);
    return kernel_(part, conversion_) && ok;
  }

  /// From a value to the one that is read kRowsAhead rows later; none beyond the image.
  [[nodiscard]] std::ptrdiff_t bytes_ahead(std::size_t y) const {
    constexpr std::size_t kRowsAhead = 4;
    if (y + kRowsAhead >= layout_.height) return 0;
    return static_cast<std::ptrdiff_t>(kRowsAhead * layout_.width * layout_.channels * sizeof(In));
  }

  std::span<const In> pixels_;
  const SatLayout& layout_;
  const SatSummands<In>& summands_;
  std::span<T> table_;
  std::size_t strip_, strips_, workers_;
  std::size_t buffer_;      ///< elements of a worker's buffers
  HugeArray<T> sums_;       ///< of each worker: the last row of sums
  HugeArray<Real> spare_;   ///< and the values that the kernel cannot take from where they are
  std::vector<T> carries_;  ///< of each row: its sum up to where the last strip ended
  std::vector<Progress> progress_;
  std::array<float, kSatGroup * kSatMaxChannels> subtrahend_{};
  SatConversion conversion_;
  bool (*kernel_)(const SatRow<Real, T>&, const SatConversion&) = nullptr;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> in_range_ = true;
};

}  // namespace

template <class In, class T>
bool build_sat_table(std::span<const In> pixels, const SatLayout& layout,
                     const SatSummands<In>& summands, std::span<T> table) {
  check_pixel_count(layout, pixels.size());
  if (table.size() != layout.elements)
    throw ShapeError(fmt::format("a summed-area table of {} numbers, where {} are needed",
                                 table.size(), layout.elements));
  assert(reinterpret_cast<std::uintptr_t>(table.data()) % kCacheLine == 0);
  return Builder<In, T>(pixels, layout, summands, table).build();
}

#define RELUMBRE_INSTANTIATE(In)                                                               \
  template bool build_sat_table(std::span<const In>, const SatLayout&, const SatSummands<In>&, \
                                std::span<std::uint32_t>);                                     \
  template bool build_sat_table(std::span<const In>, const SatLayout&, const SatSummands<In>&, \
                                std::span<std::uint64_t>);                                     \
  template bool build_sat_table(std::span<const In>, const SatLayout&, const SatSummands<In>&, \
                                std::span<float>);                                             \
  template bool build_sat_table(std::span<const In>, const SatLayout&, const SatSummands<In>&, \
                                std::span<double>);
RELUMBRE_INSTANTIATE(float)
RELUMBRE_INSTANTIATE(std::uint8_t)
RELUMBRE_INSTANTIATE(std::uint16_t)
RELUMBRE_INSTANTIATE(std::uint32_t)
#undef RELUMBRE_INSTANTIATE

}  // namespace relumbre
