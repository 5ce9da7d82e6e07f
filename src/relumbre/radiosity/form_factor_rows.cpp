#include "relumbre/radiosity/form_factor_rows.h"

#include <string>
#include <utility>
#include <vector>

#include "relumbre/base/error.h"

namespace relumbre {

std::size_t columns_of(const Tessellation& tessellation, Binning binning) {
  return binning == Binning::kPatches ? tessellation.patches() : tessellation.elements();
}

LabelLocator label_locator(const Tessellation& tessellation, Binning binning) {
  std::vector<std::uint32_t> label = tessellation.element_of_facet();
  if (binning == Binning::kPatches) {
    const std::vector<std::uint32_t> patch = tessellation.patch_of_element();
    for (std::uint32_t& element : label) element = patch[element];
  }
  return prune(tessellation.locator, label);
}

void check_rows(const Tessellation& tessellation, const FormFactorConfig& config,
                std::size_t first_row) {
  if (config.row_block == 0) throw ValueError("form factors: row block of 0 rows");
  if (first_row > tessellation.elements()) {
    throw ValueError("form factors: first row " + std::to_string(first_row) + " of " +
                     std::to_string(tessellation.elements()));
  }
}

void append(SparseCounts& to, const SparseCounts& from) {
  const std::uint64_t base = to.nonzeros();
  for (std::size_t row = 0; row < from.rows(); ++row) {
    to.row_offsets.push_back(base + from.row_offsets[row + 1]);
  }
  to.column.insert(to.column.end(), from.column.begin(), from.column.end());
  to.count.insert(to.count.end(), from.count.begin(), from.count.end());
}

RowBlocks::RowBlocks(std::size_t first_row, std::size_t rows, std::size_t row_block,
                     SparseCounts no_rows, const RowSink& sink, Progress& progress)
    : first_row_(first_row),
      rows_(rows),
      row_block_(row_block),
      block_(std::move(no_rows)),
      sink_(sink),
      progress_(progress) {}

void RowBlocks::add(std::span<const std::uint32_t> columns, std::span<const std::uint32_t> counts,
                    const RayTally& tally) {
  block_.column.insert(block_.column.end(), columns.begin(), columns.end());
  block_.count.insert(block_.count.end(), counts.begin(), counts.end());
  block_.row_offsets.push_back(block_.column.size());
  tally_ += tally;
  if (block_.rows() == row_block_ || done_ + block_.rows() == rows_) hand_over();
}

void RowBlocks::hand_over() {
  sink_(first_row_ + done_, block_, tally_);
  done_ += block_.rows();
  progress_.advance(block_.rows());
  block_.row_offsets.resize(1);  // the room stays for the next block
  block_.column.clear(), block_.count.clear();
  tally_ = {};
}

}  // namespace relumbre
