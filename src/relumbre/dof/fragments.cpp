#include "relumbre/dof/fragments.h"

#include "relumbre/base/parallel.h"
#include "relumbre/dof/mixed_pixel.h"
#include "relumbre/dof/revealed.h"
#include "relumbre/dof/surface_edges.h"

namespace relumbre {

namespace {

Rgba scaled(const Rgba& c, float s) { return {c.r * s, c.g * s, c.b * s, c.a * s}; }

void add_front(const DepthPicture& picture, std::span<const float> front, const SurfaceEdges& edges,
               const Unmixer& unmix, std::uint32_t x, std::uint32_t y,
               std::vector<Fragment>& fragments) {
  const std::size_t i = y * picture.width + x;
  const auto mixed = unmix(x, y);
  if (!mixed) {
    fragments.push_back({x, y, front[i], edges.slope(x, y), 1, picture.front.color[i]});
    return;
  }
  const float share = mixed->share, rest = 1 - share;
  if (share > 0)
    fragments.push_back({x, y, mixed->near_coc, {}, share, scaled(mixed->near, share)});
  if (rest > 0) fragments.push_back({x, y, mixed->far_coc, {}, rest, scaled(mixed->far, rest)});
}

}  // namespace

std::vector<Fragment> fragments_of(const DepthPicture& picture, std::span<const float> front,
                                   std::span<const float> behind) {
  const SurfaceEdges edges(front, picture.width, picture.height),
      edges_behind(behind, picture.width, picture.height);
  const std::vector<std::uint8_t> shown = behind.empty()
                                              ? std::vector<std::uint8_t>(picture.pixels())
                                              : revealed(picture, edges, front, behind);
  const Unmixer unmix(picture, front, edges);
  std::vector<std::vector<Fragment>> rows(picture.height);
  parallel_for(0, picture.height, 16, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    rows[row].reserve(picture.width + picture.width / 4);
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const std::size_t i = y * picture.width + x;
      add_front(picture, front, edges, unmix, x, y, rows[row]);
      if (shown[i] != 0)
        rows[row].push_back(
            {x, y, behind[i], edges_behind.slope(x, y), 1, picture.behind.color[i]});
    }
  });
  std::vector<Fragment> fragments;
  fragments.reserve(picture.pixels() + picture.pixels() / 4);
  for (const std::vector<Fragment>& row : rows)
    fragments.insert(fragments.end(), row.begin(), row.end());
  return fragments;
}

}  // namespace relumbre
