/// Internal: what bakes on CPU and GPU share.
#pragma once

#include <cstddef>
#include <span>

#include "relumbre/geometry/label_locator.h"
#include "relumbre/radiosity/form_factors.h"

namespace relumbre {

std::size_t columns_of(const Tessellation& tessellation, Binning binning);

/// From a hit to its column.
LabelLocator label_locator(const Tessellation& tessellation, Binning binning);

/// Throws what trace_form_factors() promises of row_block and first_row.
void check_rows(const Tessellation& tessellation, const FormFactorConfig& config,
                std::size_t first_row);

void append(SparseCounts& to, const SparseCounts& from);

/// Puts rows together, one by one, into the blocks that a sink is promised.
class RowBlocks {
 public:
  /// `rows` from `first_row` on; `no_rows` has columns and rays set.
  RowBlocks(std::size_t first_row, std::size_t rows, std::size_t row_block, SparseCounts no_rows,
            const RowSink& sink, Progress& progress);

  /// Columns in ascending order.
  void add(std::span<const std::uint32_t> columns, std::span<const std::uint32_t> counts,
           const RayTally& tally);
  /// How many the sink has.
  [[nodiscard]] std::size_t rows() const { return done_; }

 private:
  void hand_over();

  std::size_t first_row_, rows_, row_block_, done_ = 0;
  SparseCounts block_;
  RayTally tally_;
  const RowSink& sink_;
  Progress& progress_;
};

}  // namespace relumbre
