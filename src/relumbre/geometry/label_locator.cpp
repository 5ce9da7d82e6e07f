#include "relumbre/geometry/label_locator.h"

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {
namespace {

struct Pruner {
  const FacetLocator& from;
  std::span<const std::uint32_t> labels;
  std::vector<std::int32_t> nodes{};

  [[nodiscard]] std::int32_t leaf(std::int32_t facet) const {
    if (static_cast<std::size_t>(facet) >= labels.size()) {
      throw ShapeError(fmt::format("labels: {} for facet {}", labels.size(), facet));
    }
    return ~static_cast<std::int32_t>(labels[static_cast<std::size_t>(facet)]);
  }

  /// Copies the subtree to the end of `nodes`; a subtree of one label is taken off again.
  std::int32_t copy(std::int32_t node) {
    if (node < 0) return leaf(~node);
    const std::size_t block = nodes.size();
    nodes.resize(block + 4);
    for (std::size_t child = 0; child < 4; ++child) {
      const std::int32_t copied = copy(from.nodes[4 * static_cast<std::size_t>(node) + child]);
      nodes[block + child] = copied;
    }
    const std::int32_t first = nodes[block];
    const bool same = first < 0 && nodes[block + 1] == first && nodes[block + 2] == first &&
                      nodes[block + 3] == first;
    if (!same) return static_cast<std::int32_t>(block / 4);
    nodes.resize(block);
    return first;
  }
};

}  // namespace

LabelLocator prune(const FacetLocator& locator, std::span<const std::uint32_t> label_of_facet) {
  Pruner pruner{locator, label_of_facet};
  std::vector<std::int32_t> roots(locator.roots);
  for (std::int32_t& root : roots) {
    if (root != FacetLocator::kMissing) root = pruner.copy(root);
  }
  return {std::move(roots), std::move(pruner.nodes)};
}

}  // namespace relumbre
