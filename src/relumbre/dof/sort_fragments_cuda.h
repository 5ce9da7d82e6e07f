/// Memory in which fragments are sorted by layer and place, on a GPU.
#pragma once

#include <cstddef>
#include <cstdint>

#include "relumbre/cuda/memory.h"
#include "relumbre/dof/fragments_cuda.h"

namespace relumbre::cuda {

/// Entries sorted by layer and, in a layer, by cell of this many pixels, row by row of cells. Cells
/// of one row and layer follow one another; the order of their rows and in a cell is any.
inline constexpr std::uint32_t kCellColumns = 32, kCellRows = 16;

struct SortedFragments {
  DeviceFragment* fragments;
  /// A fragment in a layer: entry e of fragment f is f · entries a fragment + e.
  std::uint32_t* order;
  std::uint32_t *ends, *counts;  ///< of each layer's cells in `order`
  std::uint32_t* reach;          ///< bits of each layer's largest |coc|
  std::uint32_t* total;          ///< in `order`
  const FragmentSummary* summary;
  std::uint32_t layers;
  std::uint32_t width, height;  ///< of the picture
  std::uint32_t cell_columns, cell_rows;

  [[nodiscard]] std::size_t cells() const { return std::size_t{layers} * cell_rows * cell_columns; }
};

/// Finds places for each row of cells of each layer, once all are counted. Leaves in `ends` where
/// cells begin.
void place_cells(const SortedFragments& sort, const Stream& stream);

class FragmentSorter {
 public:
  /// Layers that a picture has at most: more than floats tell apart.
  static constexpr std::size_t kMostLayers = std::size_t{1} << 24;

  /// For pictures of so many pixels, fragments of which are in up to `entries` layers.
  FragmentSorter(std::size_t pixels, bool behind, unsigned entries);
  static std::size_t bytes_of(std::size_t pixels, bool behind, unsigned entries);

  /// Makes room, with nothing counted yet. Throws ValueError for 0 layers or more than kMostLayers,
  /// OutOfDeviceMemory with figures.
  SortedFragments begin(const DevicePicture& picture, const DeviceFragments& fragments,
                        std::size_t layers, const Stream& stream);

 private:
  DeviceArray<std::uint32_t> order_, cells_;
};

}  // namespace relumbre::cuda
