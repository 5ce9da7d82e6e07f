#include "relumbre/dof/fragments.h"

#include "relumbre/base/parallel.h"
#include "relumbre/dof/mixed_pixel.h"
#include "relumbre/dof/revealed.h"
#include "relumbre/dof/surface_edges.h"

namespace relumbre {

std::vector<Fragment> fragments_of(const DepthPicture& picture, std::span<const float> front,
                                   std::span<const float> behind) {
  const SurfaceEdges edges(front, picture.width, picture.height),
      edges_behind(behind, picture.width, picture.height);
  const std::vector<std::uint8_t> shown = behind.empty()
                                              ? std::vector<std::uint8_t>(picture.pixels())
                                              : revealed(picture, edges, front, behind);
  const Unmixer unmixer(picture, front, edges);
  const MixedPicture mixed = unmixer.plain();
  std::vector<std::vector<Fragment>> rows(picture.height);
  parallel_for(0, picture.height, 16, [&](std::size_t row) {
    const auto y = static_cast<std::uint32_t>(row);
    rows[row].reserve(picture.width + picture.width / 4);
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const std::size_t i = y * picture.width + x;
      front_fragments(mixed, edges.map(), x, y, [&](const Fragment& f) { rows[row].push_back(f); });
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
