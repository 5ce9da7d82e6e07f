#include "relumbre/dof/revealed.h"

#include "relumbre/dof/silhouette.h"

namespace relumbre {

namespace {

/// Tells all pixels of a surface of its silhouettes, by two sweeps over neighbours.
std::vector<Silhouette> find_silhouettes(const EdgeMap& edges) {
  const std::ptrdiff_t w = edges.plane.width, h = edges.plane.height;
  std::vector<Silhouette> result(static_cast<std::size_t>(w * h));
  const SilhouetteWindow all{edges, 0, 0, w, h, result.data()};
  for (std::ptrdiff_t y = 0; y < h; ++y)
    for (std::ptrdiff_t x = 0; x < w; ++x) all.begin(x, y);
  for (std::ptrdiff_t y = 0; y < h; ++y)
    for (std::ptrdiff_t x = 0; x < w; ++x) all.sweep(x, y, 1);
  for (std::ptrdiff_t y = h - 1; y >= 0; --y)
    for (std::ptrdiff_t x = w - 1; x >= 0; --x) all.sweep(x, y, -1);
  return result;
}

}  // namespace

std::vector<std::uint8_t> revealed(const DepthPicture& picture, const SurfaceEdges& edges,
                                   std::span<const float> front, std::span<const float> behind) {
  const std::vector<Silhouette> silhouettes = find_silhouettes(edges.map());
  std::vector<std::uint8_t> result(front.size());
  for (std::size_t i = 0; i < front.size(); ++i)
    result[i] = is_revealed(silhouettes[i], picture.behind.depth[i], front[i], behind[i]) ? 1 : 0;
  return result;
}

}  // namespace relumbre
