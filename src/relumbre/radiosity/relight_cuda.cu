#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <cublas_v2.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/cuda/device.h"
#include "relumbre/cuda/memory.h"
#include "relumbre/radiosity/blas_cuda.h"
#include "relumbre/radiosity/count_product.cuh"
#include "relumbre/radiosity/count_table_cuda.h"
#include "relumbre/radiosity/operator_input.h"
#include "relumbre/radiosity/patch_kernels.cuh"
#include "relumbre/radiosity/relight_checks_cuda.h"
#include "relumbre/radiosity/relight_cuda.h"

namespace relumbre::cuda {

namespace {

/// Sources that share one pass over U.
constexpr std::size_t kBatch = 8;
/// What a block keeps of the operand in shared memory: so that two blocks fit on sm_75 and up.
constexpr std::size_t kOperandBytes = std::size_t{30} << 10,
                      kLargeOperandBytes = std::size_t{96} << 10;
/// Fields so small are read and written by the kernels where they are, on the host.
constexpr std::size_t kDirectBytes = std::size_t{512} << 10;
/// B is copied back in parts, each while the next one is made, if a part is at least so large.
constexpr std::size_t kMostParts = 4, kPartBytes = std::size_t{512} << 10;

/// B = E + R · (U y) of a group of sources.
struct StoreRadiosity {
  const float* emission;
  const float* reflectance;
  float* radiosity;
  std::size_t elements;

  __device__ void operator()(unsigned row, unsigned vector, float value) const {
    const std::size_t source = vector / 3, channel = vector % 3;
    const std::size_t in = 3 * std::size_t{row} + channel, at = 3 * source * elements + in;
    radiosity[at] = emission[at] + reflectance[in] * value;
  }
};

unsigned vector_tiles(std::size_t sources) { return sources == 1 ? 1 : sources <= 4 ? 3 : 6; }

/// For one source or a batch: E, B, what lies between, and its size.
struct Buffers {
  Buffers(std::size_t elements, std::size_t patches, std::size_t padded, std::size_t sources_)
      : sources(sources_),
        emission(3 * elements * sources),
        radiosity(3 * elements * sources),
        here_emission(emission.size()),
        here_radiosity(radiosity.size()),
        mean(3 * patches * sources),
        y(3 * patches * sources),
        operand(std::size_t{8} * vector_tiles(sources) * padded),
        unscale(std::size_t{4} * vector_tiles(sources)),
        not_finite(1),
        here_not_finite(1) {}

  std::size_t sources;
  DeviceArray<float> emission, radiosity;
  PinnedArray<float> here_emission, here_radiosity;
  DeviceArray<float> mean, y;
  DeviceArray<__half> operand;
  DeviceArray<float> unscale;
  DeviceArray<unsigned> not_finite;
  PinnedArray<unsigned> here_not_finite;
};

std::size_t buffer_bytes(std::size_t elements, std::size_t patches) {
  return 3 * sizeof(float) * (2 * elements + 2 * patches) + 16 * (patches + kStepBytes);
}

std::size_t transport_pitch(std::size_t patches) { return (patches + 3) / 4 * 4; }

}  // namespace

class DeviceRelight::Work {
 public:
  Work(const RelightParts& parts, CountFormat format)
      : device_(current_device()),
        table_(parts.counts, format, stream_),
        rays_(parts.counts.rays),
        offsets_(to_device(parts.patch_offsets, stream_)),
        weight_(to_device(parts.weight, stream_)),
        reflectance_(3 * table_.rows()),
        transport_(3 * table_.columns() * transport_pitch(table_.columns())),
        one_(table_.rows(), table_.columns(), padded(), 1) {
    set_reflectance(parts.reflectance, parts.transport);
    stream_.wait();
  }

  [[nodiscard]] std::size_t elements() const { return table_.rows(); }
  [[nodiscard]] std::size_t patches() const { return table_.columns(); }
  [[nodiscard]] std::size_t bytes_per_apply() const {
    const std::size_t n = elements();
    return table_.bytes() + transport_.bytes() + (3 * 3 * n + n) * sizeof(float);
  }
  [[nodiscard]] const Buffers& one() const { return one_; }

  void set_reflectance(std::span<const Rgb> reflectance,
                       const std::array<std::span<const double>, 3>& transport) {
    const UseDevice use(device_.index);
    static_assert(sizeof(Rgb) == 3 * sizeof(float));
    copy_to_device<float>({&reflectance[0].x, 3 * reflectance.size()}, reflectance_.data(),
                          stream_);
    const std::size_t k = patches(), pitch = transport_pitch(k);
    std::vector<float> rows(k * pitch);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < k; ++p)
        for (std::size_t q = 0; q < k; ++q)
          rows[p * pitch + q] = static_cast<float>(transport[c][p * k + q]);
      copy_to_device<float>(rows, transport_.data() + c * k * pitch, stream_);
      stream_.wait();
    }
  }

  /// One source, from and to the page-locked buffers.
  void relight() {
    const UseDevice use(device_.index);
    if (!graph_) {
      // Kernels are loaded by their first launch, which must not be the one that is recorded.
      run_with_copies(one_, 1);
      stream_.wait();
      graph_ = Graph(stream_, [this] { run_with_copies(one_, 1); });
    }
    one_.here_not_finite.data()[0] = 0;
    graph_.start(stream_);
    stream_.wait();
    if (one_.here_not_finite.data()[0] != 0)
      throw_not_finite(values_of(one_.here_emission), elements());
  }

  void relight(std::span<const float> emission, std::span<float> radiosity, std::size_t sources) {
    const UseDevice use(device_.index);
    for (std::size_t first = 0; first < sources; first += kBatch) {
      const std::size_t count = std::min(kBatch, sources - first), values = 3 * elements();
      const auto from = emission.subspan(first * values, count * values);
      const auto to = radiosity.subspan(first * values, count * values);
      const Buffers& buffers = count == 1 ? one_ : batch();
      copy_values(from, buffers.here_emission.data());
      if (count == 1) {
        relight();
      } else {
        buffers.here_not_finite.data()[0] = 0;
        run_with_copies(buffers, count);
        stream_.wait();
        if (buffers.here_not_finite.data()[0] != 0) throw_not_finite(from, elements());
      }
      copy_values(values_of(buffers.here_radiosity).first(to.size()), to.data());
    }
  }

  double measure_kernels(int times, std::size_t sources) {
    const UseDevice use(device_.index);
    const Buffers& buffers = sources == 1 ? one_ : batch();
    clear(buffers.emission.data(), buffers.emission.size(), stream_);
    return measure(times, [&] { run(buffers, std::min(sources, kBatch)); });
  }
  double measure_scatter(int times) {
    const UseDevice use(device_.index);
    run(one_, 1);
    return measure(times, [&] { scatter(one_, 1, 0, tiles(), one_.radiosity.data()); });
  }

 private:
  static void copy_values(std::span<const float> from, float* to) {
    if (from.data() == to) return;
    parallel_chunks(0, from.size(), std::size_t{1} << 18, [&](std::size_t first, std::size_t last) {
      std::memcpy(to + first, from.data() + first, (last - first) * sizeof(float));
    });
  }

  [[nodiscard]] std::size_t padded() const {
    const std::size_t entry = table_.format() == CountFormat::kCounts8 ? 1 : 2;
    return table_.row_bytes() / entry;
  }
  [[nodiscard]] unsigned tiles() const {
    return static_cast<unsigned>((elements() + kTileRows - 1) / kTileRows);
  }

  /// Made when the first batch comes.
  const Buffers& batch() {
    if (!batch_) {
      expect_free(kBatch * buffer_bytes(elements(), patches()),
                  "relighting several sources at once");
      batch_ = std::make_unique<Buffers>(elements(), patches(), padded(), kBatch);
    }
    return *batch_;
  }

  /// Without copies.
  void run(const Buffers& b, std::size_t sources) {
    clear(b.not_finite.data(), 1, stream_);
    before_scatter(b, sources, {b.emission.data(), nullptr, elements(), 0}, b.not_finite.data());
    scatter(b, sources, 0, tiles(), b.radiosity.data());
  }

  /// From and to the page-locked buffers.
  void run_with_copies(const Buffers& b, std::size_t sources) {
    if (sources == 1 && 3 * elements() * sizeof(float) <= kDirectBytes)
      run_on_host_memory(b);
    else
      run_in_parts(b, sources);
  }

  /// Small fields: the kernels read and write the host's memory, which costs less than copies do.
  void run_on_host_memory(const Buffers& b) {
    before_scatter(b, 1, {b.here_emission.data(), b.emission.data(), elements(), 0},
                   b.here_not_finite.data());
    scatter(b, 1, 0, tiles(), b.here_radiosity.data());
  }

  /// Large ones: each part of B is copied while the next one is made.
  void run_in_parts(const Buffers& b, std::size_t sources) {
    const std::size_t values = 3 * elements() * sources;
    copy_to_device<float>(values_of(b.here_emission).first(values), b.emission.data(), stream_);
    before_scatter(b, sources, {b.emission.data(), nullptr, elements(), 0},
                   b.here_not_finite.data());
    const std::size_t parts =
        sources > 1 ? 1
                    : std::clamp<std::size_t>(values * sizeof(float) / kPartBytes, 1, kMostParts);
    for (std::size_t part = 0; part < parts; ++part) {
      const auto first = static_cast<unsigned>(tiles() * part / parts);
      const auto last = static_cast<unsigned>(tiles() * (part + 1) / parts);
      scatter(b, sources, first, last - first, b.radiosity.data());
      const std::size_t from = parts == 1 ? 0 : std::size_t{3} * first * kTileRows;
      const std::size_t to =
          parts == 1 ? values : std::min(std::size_t{3} * last * kTileRows, values);
      scattered_[part].record(stream_);
      scattered_[part].hold(copying_);
      copy_to_host(b.radiosity.data() + from, values_of(b.here_radiosity).subspan(from, to - from),
                   copying_);
    }
    copied_.record(copying_);
    copied_.hold(stream_);
  }

  /// e = VᵀE, y = M e, and y split in two halves.
  void before_scatter(const Buffers& b, std::size_t sources, Emission emission,
                      unsigned* not_finite) {
    emission.sources = static_cast<unsigned>(sources);
    gather(b, emission, not_finite);
    if (sources == 1)
      exchange(b);
    else
      exchange_batch(b, sources);
    const unsigned vectors = 4 * vector_tiles(sources);
    launch(split_vectors, {.blocks = vectors, .threads = kPatchThreads, .shared_bytes = 64},
           stream_, b.y.data(), static_cast<unsigned>(3 * sources),
           static_cast<unsigned>(patches()), static_cast<unsigned>(padded()), b.operand.data(),
           b.unscale.data());
  }

  void gather(const Buffers& b, const Emission& emission, unsigned* not_finite) {
    const auto start = [&](auto kernel, std::size_t group) {
      const std::size_t per_block = kPatchThreads / group, groups = emission.sources * patches();
      launch(kernel,
             {.blocks = static_cast<unsigned>((groups + per_block - 1) / per_block),
              .threads = kPatchThreads},
             stream_, emission, weight_.data(), offsets_.data(), static_cast<unsigned>(patches()),
             b.mean.data(), not_finite);
    };
    const std::size_t each = elements() / patches();
    if (each >= 16)
      start(gather_patches<32>, 32);
    else if (each >= 4)
      start(gather_patches<8>, 8);
    else
      start(gather_patches<2>, 2);
  }

  void exchange(const Buffers& b) {
    const std::size_t k = patches(), per_block = kPatchThreads / kWarp;
    launch(exchange_patches,
           {.blocks = static_cast<unsigned>((3 * k + per_block - 1) / per_block),
            .threads = kPatchThreads},
           stream_, transport_.data(), static_cast<unsigned>(k),
           static_cast<unsigned>(transport_pitch(k)), b.mean.data(), per_ray(), b.y.data());
  }

  /// y = (e + (M − I) e) / rays, a product of matrices a channel.
  void exchange_batch(const Buffers& b, std::size_t sources) {
    const std::size_t k = patches(), pitch = transport_pitch(k);
    copy_on_device(b.mean.data(), b.y.data(), 3 * k * sources, stream_);
    for (std::size_t c = 0; c < 3; ++c)
      blas_.gemm(stream_, {.rows = k,
                           .columns = sources,
                           .inner = k,
                           .a = {transport_.data() + c * k * pitch, pitch, true},
                           .b = {b.mean.data() + c * k, 3 * k, false},
                           .alpha = per_ray(),
                           .beta = per_ray(),
                           .c = b.y.data() + c * k,
                           .c_stride = 3 * k});
  }

  void scatter(const Buffers& b, std::size_t sources, unsigned first_tile, unsigned count,
               float* radiosity) {
    const StoreRadiosity store{b.emission.data(), reflectance_.data(), radiosity, elements()};
    switch (table_.format()) {
      case CountFormat::kCounts8:
        return scatter_as<Table8>(b, sources, first_tile, count, store);
      case CountFormat::kCounts16:
        return scatter_as<Table16>(b, sources, first_tile, count, store);
      default:
        return scatter_as<TableHalf>(b, sources, first_tile, count, store);
    }
  }
  template <class Table>
  void scatter_as(const Buffers& b, std::size_t sources, unsigned first_tile, unsigned count,
                  const StoreRadiosity& store) {
    switch (vector_tiles(sources)) {
      case 1:
        return scatter_by<Table, 1>(b, sources, first_tile, count, store);
      case 3:
        return scatter_by<Table, 3>(b, sources, first_tile, count, store);
      default:
        return scatter_by<Table, 6>(b, sources, first_tile, count, store);
    }
  }
  template <class Table, unsigned kTiles>
  void scatter_by(const Buffers& b, std::size_t sources, unsigned first_tile, unsigned count,
                  const StoreRadiosity& store) {
    const unsigned chunk = operand_chunk<Table, kTiles>();
    const std::size_t shared = 8 * kTiles * operand_pitch<Table>(chunk);
    const CountProduct product{table_.data(),
                               table_.row_bytes(),
                               first_tile,
                               count,
                               static_cast<unsigned>(elements()),
                               b.operand.data(),
                               b.unscale.data(),
                               chunk,
                               table_.excess(),
                               table_.excess_offsets(),
                               b.y.data(),
                               static_cast<unsigned>(3 * sources),
                               static_cast<unsigned>(patches())};
    const auto kernel = multiply_counts<Table, kTiles, StoreRadiosity>;
    constexpr unsigned warps = kProductThreads / 32;
    const auto resident = static_cast<unsigned>(resident_blocks(kernel, kProductThreads, shared));
    launch(kernel,
           {.blocks = std::min(resident, (count + warps - 1) / warps),
            .threads = kProductThreads,
            .shared_bytes = shared},
           stream_, product, store);
  }

  /// All columns if they fit with a second block beside them; else as many as fit cheaply.
  template <class Table, unsigned kTiles>
  [[nodiscard]] unsigned operand_chunk() const {
    const std::size_t most = device_.major >= 8 ? kLargeOperandBytes : kOperandBytes;
    const std::size_t fits = (most / (8 * kTiles) - Table::kPitchPad) / 2 / 64 * 64;
    return static_cast<unsigned>(std::min(fits, (padded() + 63) / 64 * 64));
  }

  [[nodiscard]] float per_ray() const { return 1.0F / static_cast<float>(rays_); }

  template <class Body>
  double measure(int times, const Body& body) {
    const Event start, end;
    body();
    start.record(stream_);
    for (int i = 0; i < times; ++i) body();
    end.record(stream_);
    return Event::seconds_between(start, end) / times;
  }

  DeviceInfo device_;
  Stream stream_, copying_;
  Blas blas_;
  CountTable table_;
  std::uint32_t rays_;
  DeviceArray<std::uint32_t> offsets_;
  DeviceArray<float> weight_, reflectance_, transport_;
  Buffers one_;
  std::unique_ptr<Buffers> batch_;
  std::array<Event, kMostParts> scattered_;
  Event copied_;
  Graph graph_;
};

DeviceRelight::DeviceRelight(const RelightParts& parts, CountFormat format) {
  check_parts(parts);
  expect_free(device_bytes(parts.counts, format), "relight operator");
  work_ = std::make_unique<Work>(parts, format);
}
DeviceRelight::~DeviceRelight() = default;
DeviceRelight::DeviceRelight(DeviceRelight&&) noexcept = default;
DeviceRelight& DeviceRelight::operator=(DeviceRelight&&) noexcept = default;

std::size_t DeviceRelight::device_bytes(const SparseCounts& counts, CountFormat format) {
  const std::size_t n = counts.rows(), k = counts.columns;
  const std::size_t fixed =
      CountTable::table_bytes(n, k, format) + 3 * k * transport_pitch(k) * sizeof(float);
  const std::size_t block = 8 * std::min<std::size_t>(counts.nonzeros(), (1 << 22) + k);
  return fixed + block + buffer_bytes(n, k) + 4 * sizeof(float) * n +
         3 * sizeof(std::uint64_t) * (n + k);
}

std::size_t DeviceRelight::elements() const { return work_->elements(); }
std::size_t DeviceRelight::patches() const { return work_->patches(); }
std::size_t DeviceRelight::bytes_per_apply() const { return work_->bytes_per_apply(); }
void DeviceRelight::set_reflectance(std::span<const Rgb> reflectance,
                                    const std::array<std::span<const double>, 3>& transport) {
  check_reflectance(reflectance, elements());
  check_transport(transport, patches());
  work_->set_reflectance(reflectance, transport);
}
std::span<float> DeviceRelight::emission() const { return values_of(work_->one().here_emission); }
std::span<const float> DeviceRelight::radiosity() const {
  return values_of(work_->one().here_radiosity);
}
void DeviceRelight::relight() const { work_->relight(); }
double DeviceRelight::measure_kernels(int times, std::size_t sources) const {
  return work_->measure_kernels(times, sources);
}
double DeviceRelight::measure_scatter(int times) const { return work_->measure_scatter(times); }
void DeviceRelight::apply_checked(std::span<const float> emission, std::span<float> radiosity,
                                  std::size_t sources) const {
  work_->relight(emission, radiosity, sources);
}

}  // namespace relumbre::cuda
