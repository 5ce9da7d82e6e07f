#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/cuda/device.h"
#include "relumbre/cuda/memory.h"
#include "relumbre/cuda/stream.h"
#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/form_factors_cuda.cuh"
#include "relumbre/radiosity/form_factors_cuda.h"
#include "relumbre/radiosity/ray_pattern.h"
#include "relumbre/visibility/bvh_cuda.h"
#include "relumbre/visibility/ray_tracer.h"

namespace relumbre::cuda {

namespace {

using namespace form_factors_kernel;

/// Batches in flight: one is prepared or handed over while two are on the device.
constexpr std::size_t kSlots = 3;
constexpr std::size_t kRowsPerBatch = std::size_t{1} << 16;
/// Places of counts in a batch are 32-bit numbers.
constexpr std::size_t kMostCounts = std::size_t{1} << 31;
/// Rays of a tile, so that threads rarely wait for its last ones.
constexpr std::uint32_t kRaysPerTile = 4096;
/// Rows are counted in shared memory where a tile's fit in that. It is the level 1 cache too, which
/// the hierarchy needs: eight blocks a multiprocessor leave it half of a large device's.
constexpr std::size_t kSharedBytes = std::size_t{16} << 10;

/// How the rows are cut up, and what that takes.
struct Plan {
  RowLayout layout;
  std::size_t slots, rows_per_batch, counts_per_batch, facets_per_batch;
  std::uint32_t rows_per_tile;
  unsigned blocks;
  bool in_shared_memory;

  [[nodiscard]] std::size_t row_bytes() const { return layout.words() * sizeof(std::uint32_t); }
  [[nodiscard]] std::size_t shared_bytes() const {
    return sizeof(TileState) + (in_shared_memory ? rows_per_tile * row_bytes() : 0);
  }
  [[nodiscard]] std::size_t buffer_words() const {
    return in_shared_memory ? 0 : std::size_t{blocks} * rows_per_tile * layout.words();
  }
  [[nodiscard]] std::size_t slot_bytes() const {
    return rows_per_batch * (sizeof(RowInput) + sizeof(RowOutput) + sizeof(float)) +
           facets_per_batch * (EmittingSurface::kFloats + 1) * sizeof(float) +
           2 * counts_per_batch * sizeof(std::uint32_t) + buffer_words() * sizeof(std::uint32_t);
  }
};

std::size_t most_facets(const Tessellation& tessellation, std::size_t first_row,
                        std::size_t rows_per_batch) {
  std::size_t most = 0;
  for (std::size_t row = first_row; row < tessellation.elements(); row += rows_per_batch) {
    const std::size_t end = std::min(row + rows_per_batch, tessellation.elements());
    most = std::max<std::size_t>(most,
                                 tessellation.facet_offsets[end] - tessellation.facet_offsets[row]);
  }
  return most;
}

Plan make_plan(const Tessellation& tessellation, std::uint32_t rays, std::size_t columns,
               std::size_t first_row, const RowBatchConfig& batch, std::size_t free_bytes) {
  Plan plan{};
  plan.layout = {static_cast<std::uint32_t>(columns)};
  const std::size_t rows = std::max<std::size_t>(1, tessellation.elements() - first_row);
  const std::size_t row_counts = std::clamp<std::size_t>(columns, 1, rays);
  plan.rows_per_batch = std::min(
      rows,
      std::clamp<std::size_t>(std::min(batch.counts, kMostCounts) / row_counts, 1, kRowsPerBatch));
  plan.slots = std::min(kSlots, (rows + plan.rows_per_batch - 1) / plan.rows_per_batch);
  plan.counts_per_batch = plan.rows_per_batch * row_counts;
  plan.facets_per_batch = most_facets(tessellation, first_row, plan.rows_per_batch);

  plan.rows_per_tile = std::clamp<std::uint32_t>(kRaysPerTile / rays, 1, 64);
  plan.in_shared_memory = plan.row_bytes() <= kSharedBytes;
  if (plan.in_shared_memory) {
    plan.rows_per_tile =
        std::min(plan.rows_per_tile, static_cast<std::uint32_t>(kSharedBytes / plan.row_bytes()));
  }
  plan.blocks = static_cast<unsigned>(resident_blocks(trace_rows, kThreads, plan.shared_bytes()));
  // Rows counted in the device's memory may take half of it; fewer at a time are slower.
  while (plan.slots * plan.buffer_words() * sizeof(std::uint32_t) > free_bytes / 2) {
    if (plan.rows_per_tile > 1) {
      plan.rows_per_tile /= 2;
    } else if (plan.blocks > 1) {
      plan.blocks /= 2;
    } else {
      break;
    }
  }
  return plan;
}

/// One batch on its way: prepared on the host, traced on the device, and read back.
class Slot {
 public:
  explicit Slot(const Plan& plan)
      : plan_(plan),
        in_(plan.rows_per_batch),
        records_(plan.facets_per_batch * EmittingSurface::kFloats),
        shares_(plan.facets_per_batch + plan.rows_per_batch),
        out_(plan.rows_per_batch),
        progress_(2),
        device_in_(in_.size()),
        device_records_(records_.size()),
        device_shares_(shares_.size()),
        device_out_(out_.size()),
        device_progress_(2),
        device_column_(plan.counts_per_batch),
        device_count_(plan.counts_per_batch),
        buffers_(plan.buffer_words()) {
    clear(buffers_.data(), buffers_.size(), stream_);
  }
  ~Slot() {  // the device may still write to what is about to go
    try {
      stream_.wait();
    } catch (const Error&) {  // was, or will be, reported by a call that may throw
    }
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  [[nodiscard]] bool busy() const { return rows_ > 0; }

  /// Prepares rows and starts them.
  void start(const Tessellation& tessellation, std::uint64_t seed, float clearance,
             std::size_t first_row, std::size_t rows, RowBatch batch) {
    rows_ = rows;
    const std::uint32_t first_facet = tessellation.facet_offsets[first_row];
    const std::size_t facets = tessellation.facet_offsets[first_row + rows] - first_facet;
    parallel_chunks(0, rows, 64, [&](std::size_t first, std::size_t last) {
      EmittingSurface surface;
      for (std::size_t i = first; i < last; ++i) {
        load_element(tessellation, first_row + i, clearance, surface);
        prepare(i, tessellation.facet_offsets[first_row + i] - first_facet, surface,
                digital_shift(seed, first_row + i));
      }
    });
    copy_to_device<RowInput>(values_of(in_).first(rows), device_in_.data(), stream_);
    copy_to_device<float>(values_of(records_).first(facets * EmittingSurface::kFloats),
                          device_records_.data(), stream_);
    copy_to_device<float>(values_of(shares_).first(facets + rows), device_shares_.data(), stream_);
    clear(device_progress_.data(), 2, stream_);
    launch_on_device(batch);
    copy_to_host<RowOutput>(device_out_.data(), values_of(out_).first(rows), stream_);
    copy_to_host<std::uint32_t>(device_progress_.data(), values_of(progress_), stream_);
  }

  /// Waits for the rows and gives them to `blocks`.
  void finish(std::uint32_t rays, RowBlocks& blocks) {
    stream_.wait();
    const std::size_t counts = progress_.data()[1];
    const std::size_t room = std::min(counts + counts / 8, plan_.counts_per_batch);
    if (counts > column_.size()) column_.reserve(room), count_.reserve(room);
    copy_to_host<std::uint32_t>(device_column_.data(), values_of(column_).first(counts), stream_);
    copy_to_host<std::uint32_t>(device_count_.data(), values_of(count_).first(counts), stream_);
    stream_.wait();
    for (const RowOutput& row : values_of(out_).first(std::exchange(rows_, 0))) {
      const RayTally tally{rays - row.back_face - row.escaped, row.back_face, row.escaped};
      blocks.add(values_of(column_).subspan(row.first, row.nonzeros),
                 values_of(count_).subspan(row.first, row.nonzeros), tally);
    }
  }

 private:
  void prepare(std::size_t i, std::uint32_t first_facet, const EmittingSurface& surface,
               const DigitalShift& shift) {
    const auto first_share = static_cast<std::uint32_t>(first_facet + i);
    const auto facets = static_cast<std::uint32_t>(surface.size());
    in_.data()[i] = {first_facet, first_share, facets, 0, shift};
    const float* records = surface.records()->data();
    std::copy_n(records, surface.size() * EmittingSurface::kFloats,
                records_.data() + std::size_t{first_facet} * EmittingSurface::kFloats);
    if (facets > 1) {
      std::copy_n(surface.cumulative(), facets + 1, shares_.data() + first_share);
    }
  }

  void launch_on_device(RowBatch& batch) {
    batch.in = device_in_.data();
    batch.records = device_records_.data(), batch.shares = device_shares_.data();
    batch.rows = static_cast<std::uint32_t>(rows_), batch.rows_per_tile = plan_.rows_per_tile;
    batch.layout = plan_.layout;
    batch.buffers = plan_.in_shared_memory ? nullptr : buffers_.data();
    batch.progress = device_progress_.data();
    batch.out = device_out_.data();
    batch.column = device_column_.data(), batch.count = device_count_.data();
    const std::size_t tiles = (rows_ + plan_.rows_per_tile - 1) / plan_.rows_per_tile;
    const auto blocks = static_cast<unsigned>(std::min<std::size_t>(plan_.blocks, tiles));
    launch(trace_rows,
           {.blocks = blocks, .threads = kThreads, .shared_bytes = plan_.shared_bytes()}, stream_,
           batch);
  }

  const Plan& plan_;
  std::size_t rows_ = 0;
  Stream stream_;
  PinnedArray<RowInput> in_;
  PinnedArray<float> records_, shares_;
  PinnedArray<RowOutput> out_;
  PinnedArray<std::uint32_t> progress_, column_, count_;
  DeviceArray<RowInput> device_in_;
  DeviceArray<float> device_records_, device_shares_;
  DeviceArray<RowOutput> device_out_;
  DeviceArray<std::uint32_t> device_progress_, device_column_, device_count_, buffers_;
};

/// What all batches read, on the device.
struct Shared {
  Stream stream;
  DeviceBvh scene;
  DeviceArray<std::int32_t> roots, nodes;
  DeviceArray<std::uint32_t> pattern;
  std::size_t stride;
  std::uint32_t rays;

  Shared(const Bvh& bvh, const LabelLocator& locator, const RayPattern& points)
      : scene(bvh, stream),
        roots(to_device(std::span(locator.roots), stream)),
        nodes(to_device(std::span(locator.nodes), stream)),
        pattern(4 * points.packets() * RayPacket::kSize),
        stride(points.packets() * RayPacket::kSize),
        rays(points.rays()) {
    for (std::size_t d = 0; d < 4; ++d) {
      copy_to_device<std::uint32_t>({points.coordinate(d), stride}, pattern.data() + d * stride,
                                    stream);
    }
    stream.wait();
  }
  static std::size_t bytes(const Bvh& bvh, const LabelLocator& locator, const RayPattern& points) {
    return bvh.bytes() + (locator.roots.size() + locator.nodes.size()) * sizeof(std::int32_t) +
           4 * points.packets() * RayPacket::kSize * sizeof(std::uint32_t);
  }
  [[nodiscard]] RowBatch batch() const {
    RowBatch batch{};
    batch.scene = scene.view();
    batch.labels = {roots.data(), nodes.data()};
    batch.pattern = pattern.data(), batch.stride = stride, batch.rays = rays;
    return batch;
  }
};

SparseCounts no_rows(std::size_t columns, std::uint32_t rays) {
  SparseCounts counts;
  counts.columns = columns, counts.rays = rays;
  return counts;
}

/// A bake's rows, batch after batch.
class RowTracer {
 public:
  RowTracer(const Bvh& bvh, float clearance, const Tessellation& tessellation,
            const FormFactorConfig& config, Binning binning, std::size_t first_row,
            const RowBatchConfig& batch)
      : tessellation_(tessellation),
        config_(config),
        first_row_(first_row),
        clearance_(clearance),
        columns_(columns_of(tessellation, binning)) {
    const RayPattern pattern(config.rays);
    const LabelLocator locator = label_locator(tessellation, binning);
    const std::size_t bytes = Shared::bytes(bvh, locator, pattern);
    const std::size_t free = current_device().free_bytes;
    plan_ = make_plan(tessellation, config.rays, columns_, first_row, batch,
                      free - std::min(free, bytes));
    expect_free(bytes + plan_.slots * plan_.slot_bytes(), "form factors");
    shared_.emplace(bvh, locator, pattern);
  }

  /// Batches go round the slots: a slot's rows are handed over before it gets the next.
  void run(const RowSink& sink, Progress& progress) {
    const std::size_t rows = tessellation_.elements() - first_row_;
    RowBlocks blocks(first_row_, rows, config_.row_block, no_rows(columns_, config_.rays), sink,
                     progress);
    std::size_t turn = 0;
    for (std::size_t done = 0; done < rows; done += plan_.rows_per_batch) {
      if (progress.cancelled()) throw Cancelled("form factors: interrupted");
      std::optional<Slot>& slot = slots_[turn++ % kSlots];
      if (!slot) slot.emplace(plan_);
      if (slot->busy()) slot->finish(config_.rays, blocks);
      slot->start(tessellation_, config_.seed, clearance_, first_row_ + done,
                  std::min(plan_.rows_per_batch, rows - done), shared_->batch());
    }
    for (std::size_t i = 0; i < kSlots; ++i) {
      std::optional<Slot>& slot = slots_[turn++ % kSlots];
      if (slot && slot->busy()) slot->finish(config_.rays, blocks);
    }
  }

 private:
  const Tessellation& tessellation_;
  const FormFactorConfig& config_;
  std::size_t first_row_;
  float clearance_;
  std::size_t columns_;
  Plan plan_{};
  std::optional<Shared> shared_;
  std::array<std::optional<Slot>, kSlots> slots_;  // last: they use what is above
};

}  // namespace

void trace_form_factors(const Bvh& bvh, float clearance, const Tessellation& tessellation,
                        const FormFactorConfig& config, Binning binning, std::size_t first_row,
                        const RowSink& sink, Progress& progress, const RowBatchConfig& batch) {
  check_rows(tessellation, config, first_row);
  RowTracer tracer(bvh, clearance, tessellation, config, binning, first_row, batch);
  progress.begin("form factors", tessellation.elements() - first_row);
  tracer.run(sink, progress);
}

void trace_form_factors(const TriangleMesh& mesh, const Tessellation& tessellation,
                        const FormFactorConfig& config, Binning binning, std::size_t first_row,
                        const RowSink& sink, Progress& progress, const RowBatchConfig& batch) {
  check_rows(tessellation, config, first_row);
  trace_form_factors(build_bvh(mesh), ray_epsilon(mesh), tessellation, config, binning, first_row,
                     sink, progress, batch);
}

FormFactorTracer form_factor_tracer(int device) {
  return [device](const TriangleMesh& mesh, const Tessellation& tessellation,
                  const FormFactorConfig& config, Binning binning, std::size_t first_row,
                  const RowSink& sink, Progress& progress) {
    const UseDevice use(device);
    trace_form_factors(mesh, tessellation, config, binning, first_row, sink, progress);
  };
}

}  // namespace relumbre::cuda
