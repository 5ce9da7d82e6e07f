/// How a picture is shared out among the geometry units: statically, sorted first.
///
///   tiles of T × T pixels in raster order, those    ┌───┬───┬─┐
///   at the right and lower edge as small as need    │ 0 │ 1 │2│   unit g of G owns tiles
///   be; inside a tile, pixels go row by row         ├───┼───┼─┤   ⌊gN/G⌋ to ⌊(g+1)N/G⌋-1
///                                                   │ 3 │ 4 │5│   of all N
///                                                   └───┴───┴─┘
#pragma once

#include <algorithm>
#include <cstdint>

namespace relumbre {

/// Pixels (x, y) with x0 <= x < x1 and y0 <= y < y1.
struct PixelRect {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

class Tiles {
 public:
  static constexpr std::uint32_t kMaxUnits = 1U << 20;

  /// Throws ValueError for sides of 0, a tile of 0 and for 0 or more than kMaxUnits units.
  Tiles(std::uint32_t width, std::uint32_t height, std::uint32_t tile, std::uint32_t units);

  [[nodiscard]] std::uint64_t count() const { return columns_ * rows_; }
  [[nodiscard]] std::uint32_t units() const { return units_; }
  [[nodiscard]] PixelRect tile(std::uint64_t index) const;

  struct Range {
    std::uint64_t begin = 0, end = 0;
    [[nodiscard]] bool is_empty() const { return begin == end; }
  };
  /// Of a unit's tiles. Empty for some where there are more units than tiles.
  [[nodiscard]] Range owned_by(std::uint32_t unit) const { return {share(unit), share(unit + 1)}; }

  /// Calls run(y, x0, x1) for each row of each tile of the unit, in order.
  template <class Run>
  void for_each_run(std::uint32_t unit, Run&& run) const {
    const Range range = owned_by(unit);
    for (std::uint64_t i = range.begin; i < range.end; ++i) {
      const PixelRect rect = tile(i);
      for (std::uint32_t y = rect.y0; y < rect.y1; ++y) run(y, rect.x0, rect.x1);
    }
  }

 private:
  /// ⌊unit · N / G⌋ without overflow: N = qG + r gives unit · q + ⌊unit · r / G⌋.
  [[nodiscard]] std::uint64_t share(std::uint64_t unit) const {
    return unit * (count() / units_) + unit * (count() % units_) / units_;
  }

  std::uint32_t width_, height_, tile_, units_;
  std::uint64_t columns_, rows_;
};

}  // namespace relumbre
