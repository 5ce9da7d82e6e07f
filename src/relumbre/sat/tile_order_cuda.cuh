/// The order in which the tiles of a table are begun.
#pragma once

#include <cmath>
#include <cstdint>

#include "relumbre/base/host_device.h"

namespace relumbre::cuda {

struct TilePlace {
  std::uint32_t row, column;
};

/// The n-th tile by diagonals, from the top left: what a tile waits for, the tiles left of it and
/// above it, lies on diagonals before its own, so that they were begun about a diagonal's length
/// earlier, on both sides alike.
///
///     0 1 3 6        a table of 3 rows of 4 tiles
///     2 4 7 9
///     5 8 10 11
RELUMBRE_HOST_DEVICE inline TilePlace tile_by_diagonals(std::uint64_t n, std::uint64_t rows,
                                                        std::uint64_t columns) {
  const std::uint64_t length = rows < columns ? rows : columns;  // of the longest diagonals
  const std::uint64_t corner = length * (length - 1) / 2;        // tiles before the first of them
  const std::uint64_t long_ones = rows + columns - 2 * length + 1;
  const bool from_end = n >= corner + long_ones * length;
  if (from_end) n = rows * columns - 1 - n;  // the last corner is the first one, turned round
  std::uint64_t diagonal, place;
  if (n < corner) {
    diagonal = (static_cast<std::uint64_t>(sqrt(static_cast<double>(8 * n + 1))) - 1) / 2;
    place = n - diagonal * (diagonal + 1) / 2;
  } else {
    diagonal = length - 1 + (n - corner) / length;
    place = (n - corner) % length;
  }
  const std::uint64_t first_row = diagonal < columns ? 0 : diagonal - (columns - 1);
  const std::uint64_t row = first_row + place, column = diagonal - row;
  if (from_end)
    return {static_cast<std::uint32_t>(rows - 1 - row),
            static_cast<std::uint32_t>(columns - 1 - column)};
  return {static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(column)};
}

}  // namespace relumbre::cuda
