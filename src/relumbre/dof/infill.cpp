#include "relumbre/dof/infill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "relumbre/base/parallel.h"
#include "relumbre/dof/focus.h"
#include "relumbre/dof/surface_edges.h"

namespace relumbre {

namespace {

/// Weights of pixels of one surface, and of those whose colour may be that of two.
constexpr float kPure = 1, kMixed = 1e-3F;

/// The mean of the farthest surface in a square of pixels.
struct Cell {
  float coc = -std::numeric_limits<float>::infinity();
  float inverse_depth = 0;
  Rgba color;
  float weight = 0;
};

void add(Cell& sum, const Cell& cell, float weight) {
  sum.coc += cell.coc * weight, sum.inverse_depth += cell.inverse_depth * weight;
  sum.color.r += cell.color.r * weight, sum.color.g += cell.color.g * weight;
  sum.color.b += cell.color.b * weight, sum.color.a += cell.color.a * weight;
  sum.weight += weight;
}

Cell mean_of(const Cell& sum) {
  Cell mean = sum;
  const float s = 1 / sum.weight;
  mean.coc *= s, mean.inverse_depth *= s;
  mean.color = {sum.color.r * s, sum.color.g * s, sum.color.b * s, sum.color.a * s};
  return mean;
}

/// The farthest of four cells, averaged with those of the same surface.
Cell farthest_of(const std::array<Cell, 4>& cells) {
  float far = cells[0].coc;
  for (const Cell& cell : cells) far = std::max(far, cell.coc);
  Cell sum{.coc = 0};
  for (const Cell& cell : cells)
    if (cell.weight > 0 && cell.coc > far - kOneSurface) add(sum, cell, cell.weight);
  return sum.weight > 0 ? mean_of(sum) : Cell{};
}

struct Level {
  std::size_t width = 0, height = 0;
  std::vector<Cell> cells;

  /// Beyond the border there is nothing.
  [[nodiscard]] Cell at(std::ptrdiff_t x, std::ptrdiff_t y) const {
    const bool inside = x >= 0 && y >= 0 && x < static_cast<std::ptrdiff_t>(width) &&
                        y < static_cast<std::ptrdiff_t>(height);
    return inside ? cells[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)]
                  : Cell{};
  }
};

Level finest(const DepthPicture& picture, std::span<const float> circles) {
  const auto mixed = SurfaceEdges(circles, picture.width, picture.height).pixels();
  Level level{picture.width, picture.height, std::vector<Cell>(picture.pixels())};
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    level.cells[i] = {circles[i], 1 / picture.front.depth[i], picture.front.color[i],
                      mixed[i] == 0 ? kPure : kMixed};
  }
  return level;
}

Level coarser(const Level& fine) {
  Level level{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
  level.cells.resize(level.width * level.height);
  parallel_for(0, level.height, 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < level.width; ++x) {
      const auto u = static_cast<std::ptrdiff_t>(2 * x), v = static_cast<std::ptrdiff_t>(2 * y);
      level.cells[y * level.width + x] =
          farthest_of({fine.at(u, v), fine.at(u + 1, v), fine.at(u, v + 1), fine.at(u + 1, v + 1)});
    }
  });
  return level;
}

std::vector<Level> pyramid(const DepthPicture& picture, std::span<const float> circles) {
  std::vector<Level> levels{finest(picture, circles)};
  while (levels.back().width > 1 || levels.back().height > 1)
    levels.push_back(coarser(levels.back()));
  return levels;
}

/// The mean of those of the four cells around a pixel that lie behind `coc`, weighted by how near
/// they are. Cells of less than `least` weight are passed over.
std::optional<Cell> behind_in(const Level& level, std::size_t cell_size, std::size_t x,
                              std::size_t y, float coc, float least) {
  const float scale = 1 / static_cast<float>(cell_size);
  const float fx = (static_cast<float>(x) + 0.5F) * scale - 0.5F,
              fy = (static_cast<float>(y) + 0.5F) * scale - 0.5F;
  const float x0 = std::floor(fx), y0 = std::floor(fy);
  Cell sum{.coc = 0};
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const Cell cell =
          level.at(static_cast<std::ptrdiff_t>(x0) + i, static_cast<std::ptrdiff_t>(y0) + j);
      const float wx = i == 0 ? 1 - (fx - x0) : fx - x0, wy = j == 0 ? 1 - (fy - y0) : fy - y0;
      if (cell.coc > coc + kOneSurface && cell.weight >= least)
        add(sum, cell, (wx * wy + 1e-3F) * cell.weight);
    }
  }
  if (sum.weight == 0) return std::nullopt;
  return mean_of(sum);
}

/// In the finest level that has one.
std::optional<Cell> find_behind(const std::vector<Level>& levels, std::size_t x, std::size_t y,
                                float coc, float least) {
  for (std::size_t l = 1; l < levels.size(); ++l) {
    const std::size_t size = std::size_t{1} << l;
    const std::optional<Cell> cell = behind_in(levels[l], size, x, y, coc, least);
    if (!cell) continue;
    const float reach = (cell->coc - coc) / 2 + 1;
    return static_cast<float>(size) / 2 <= reach ? cell : std::nullopt;
  }
  return std::nullopt;
}

/// The colour of mixed pixels is partly that of what lies before them, and would glow beside it:
/// they only count where nothing else is in reach.
std::optional<Cell> guess_behind(const std::vector<Level>& levels, std::size_t x, std::size_t y,
                                 float coc) {
  const std::optional<Cell> pure = find_behind(levels, x, y, coc, kPure);
  return pure ? pure : find_behind(levels, x, y, coc, kMixed);
}

}  // namespace

PictureLayer fill_behind(const DepthPicture& picture, std::span<const float> circles) {
  const std::vector<Level> levels = pyramid(picture, circles);
  PictureLayer layer{std::vector<Rgba>(picture.pixels()),
                     std::vector<float>(picture.pixels(), std::numeric_limits<float>::infinity())};
  parallel_for(0, picture.height, 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < picture.width; ++x) {
      const std::size_t i = y * picture.width + x;
      if (const auto cell = guess_behind(levels, x, y, circles[i])) {
        layer.color[i] = cell->color;
        layer.depth[i] = cell->inverse_depth > 0 ? 1 / cell->inverse_depth
                                                 : std::numeric_limits<float>::infinity();
      }
    }
  });
  return layer;
}

DepthPicture infilled(const DepthPicture& picture, const ThinLens& lens, double largest_diameter) {
  DepthPicture result = picture;
  result.behind = fill_behind(
      picture, circles_of_confusion(picture.front.depth, lens, picture.width, largest_diameter));
  return result;
}

}  // namespace relumbre
