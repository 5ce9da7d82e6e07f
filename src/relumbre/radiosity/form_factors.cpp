#include "relumbre/radiosity/form_factors.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/geometry/label_locator.h"
#include "relumbre/radiosity/element_sampler.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/hit_labels.h"
#include "relumbre/radiosity/row_counter.h"

namespace relumbre {

namespace {

constexpr std::size_t kRowsPerTask = 4;

/// Consecutive rows and what became of their rays.
struct Rows {
  SparseCounts counts;
  RayTally tally;
};

/// What one thread needs while it traces.
struct Scratch {
  explicit Scratch(std::size_t columns) : counter(columns), rays(kBatch) {}
  static constexpr std::size_t kBatch = 32;  ///< packets generated ahead of tracing: 16 KiB

  RowCounter counter;
  EmittingSurface surface;
  std::vector<RayPacket> rays;
};

/// Hands out scratch; as many are made as are ever in use at once.
class ScratchPool {
 public:
  explicit ScratchPool(std::size_t columns) : columns_(columns) {}

  std::unique_ptr<Scratch> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<Scratch>(columns_);
    std::unique_ptr<Scratch> scratch = std::move(idle_.back());
    idle_.pop_back();
    return scratch;
  }
  void give_back(std::unique_ptr<Scratch> scratch) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(scratch));
  }

 private:
  std::size_t columns_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> idle_;
};

/// Traces rows of one bake.
class Tracer {
 public:
  Tracer(const Tessellation& tessellation, const RayScene& rays, const FormFactorConfig& config,
         Binning binning)
      : rays_(rays),
        sampler_(tessellation, config.rays, config.seed, rays.epsilon()),
        locator_(label_locator(tessellation, binning)),
        columns_(columns_of(tessellation, binning)),
        scratch_(columns_) {}

  [[nodiscard]] SparseCounts no_rows() const {
    SparseCounts counts;
    counts.columns = columns_;
    counts.rays = sampler_.pattern().rays();
    return counts;
  }

  Rows trace(std::size_t first, std::size_t last) {
    Rows rows{no_rows(), {}};
    std::unique_ptr<Scratch> scratch = scratch_.take();
    for (std::size_t row = first; row < last; ++row) trace_row(row, *scratch, rows);
    scratch_.give_back(std::move(scratch));
    return rows;
  }

 private:
  void trace_row(std::size_t row, Scratch& scratch, Rows& rows) const {
    sampler_.load(row, scratch.surface);
    const RayPattern& pattern = sampler_.pattern();
    for (std::size_t first = 0; first < pattern.packets(); first += Scratch::kBatch) {
      const std::size_t count = std::min(Scratch::kBatch, pattern.packets() - first);
      const std::span packets = std::span(scratch.rays).first(count);
      sampler_.generate(row, scratch.surface, first, packets);
      for (std::size_t p = 0; p < count; ++p) {
        trace_packet(packets[p], pattern.active(first + p), scratch.counter, rows.tally);
      }
    }
    scratch.counter.flush(rows.counts);
  }

  void trace_packet(const RayPacket& packet, std::size_t active, RowCounter& counter,
                    RayTally& tally) const {
    HitPacket hits;
    HitLabels labels;
    rays_.closest(packet, hits, active);
    find_labels(locator_, hits, labels);
    for (std::size_t i = 0; i < active; ++i) {
      if (labels[i] < kAbsorbed) {
        counter.add(labels[i]);
        ++tally.hits;
      } else {
        ++(labels[i] == kAbsorbed ? tally.back_face : tally.escaped);
      }
    }
  }

  const RayScene& rays_;
  ElementSampler sampler_;
  LabelLocator locator_;
  std::size_t columns_;
  ScratchPool scratch_;
};

/// The rows of a bake cut into blocks, and the blocks into tasks of a few rows.
struct TaskGrid {
  std::size_t first_row, rows, row_block;

  [[nodiscard]] std::size_t tasks_per_block() const {
    return (row_block + kRowsPerTask - 1) / kRowsPerTask;
  }
  [[nodiscard]] std::size_t tasks() const {
    const std::size_t in_last = (rows % row_block + kRowsPerTask - 1) / kRowsPerTask;
    return rows / row_block * tasks_per_block() + in_last;
  }
  [[nodiscard]] std::size_t begin(std::size_t task) const {
    const std::size_t in_block = task % tasks_per_block() * kRowsPerTask;
    return first_row + task / tasks_per_block() * row_block + in_block;
  }
  [[nodiscard]] std::size_t end(std::size_t task) const {
    const std::size_t block_end = first_row + (task / tasks_per_block() + 1) * row_block;
    return std::min({begin(task) + kRowsPerTask, block_end, first_row + rows});
  }
};

/// Puts tasks' rows together into the blocks that the sink is promised.
class BlockWriter {
 public:
  BlockWriter(const TaskGrid& grid, SparseCounts no_rows, const RowSink& sink, Progress& progress)
      : grid_(grid), no_rows_(std::move(no_rows)), sink_(sink), progress_(progress) {
    block_.counts = no_rows_;
  }

  /// Takes the rows of the tasks that follow the last ones, and leaves `wave` empty.
  void write(std::vector<Rows>& wave) {
    for (const Rows& rows : wave) {
      append(block_.counts, rows.counts);
      block_.tally += rows.tally;
      const std::size_t done = row_ + block_.counts.rows();
      if (block_.counts.rows() == grid_.row_block || done == grid_.rows) hand_over();
    }
    wave.clear();
  }

  /// How many the sink has.
  [[nodiscard]] std::size_t rows() const { return row_; }

 private:
  void hand_over() {
    sink_(grid_.first_row + row_, block_.counts, block_.tally);
    row_ += block_.counts.rows();
    progress_.advance(block_.counts.rows());
    block_ = {no_rows_, {}};
  }

  const TaskGrid& grid_;
  SparseCounts no_rows_;
  const RowSink& sink_;
  Progress& progress_;
  Rows block_;
  std::size_t row_ = 0;
};

/// Enough tasks that threads rarely wait for the last one, few enough that memory stays small.
std::size_t tasks_per_wave(std::uint32_t rays) {
  return thread_count() * std::clamp<std::size_t>((1U << 15) / rays, 8, 64);
}

/// Makes room for what all rows will take if they are like those so far.
void reserve(SparseCounts& counts, std::size_t rows, std::size_t more, std::size_t all_rows) {
  const std::size_t needed = counts.column.size() + more;
  if (needed <= counts.column.capacity()) return;
  const double expected = 1.05 * static_cast<double>(needed) * static_cast<double>(all_rows) /
                          static_cast<double>(counts.rows() + rows);
  const std::size_t capacity = std::max(needed, static_cast<std::size_t>(expected));
  counts.column.reserve(capacity);
  counts.count.reserve(capacity);
}

}  // namespace

void trace_form_factors(const Tessellation& tessellation, const RayScene& rays,
                        const FormFactorConfig& config, Binning binning, std::size_t first_row,
                        const RowSink& sink, Progress& progress) {
  check_rows(tessellation, config, first_row);
  Tracer tracer(tessellation, rays, config, binning);
  const TaskGrid grid{first_row, tessellation.elements() - first_row, config.row_block};
  BlockWriter writer(grid, tracer.no_rows(), sink, progress);
  progress.begin("form factors", grid.rows);

  // Waves of tasks: while one is traced, the sink is given the one before it.
  std::vector<Rows> traced, in_work;
  for (std::size_t first = 0; first < grid.tasks(); first += in_work.size(), in_work.swap(traced)) {
    if (progress.cancelled()) break;
    in_work.resize(std::min(tasks_per_wave(config.rays), grid.tasks() - first));
    parallel_for(0, in_work.size() + 1, 1, [&](std::size_t i) {
      if (i == 0) return writer.write(traced);
      in_work[i - 1] = tracer.trace(grid.begin(first + i - 1), grid.end(first + i - 1));
    });
  }
  writer.write(traced);
  if (writer.rows() < grid.rows) throw Cancelled("form factors: interrupted");
}

FormFactors trace_form_factors(const Tessellation& tessellation, const RayScene& rays,
                               const FormFactorConfig& config, Binning binning,
                               Progress& progress) {
  FormFactors result;
  const auto gather = [&](std::size_t, const SparseCounts& block, const RayTally& tally) {
    reserve(result.counts, block.rows(), block.nonzeros(), tessellation.elements());
    append(result.counts, block);
    result.tally += tally;
  };
  result.counts.columns = columns_of(tessellation, binning);
  result.counts.rays = config.rays;
  result.counts.row_offsets.reserve(tessellation.elements() + 1);
  trace_form_factors(tessellation, rays, config, binning, 0, gather, progress);
  return result;
}

}  // namespace relumbre
