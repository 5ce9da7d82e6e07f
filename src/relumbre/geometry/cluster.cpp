// Top-down clustering: split the group with the largest inertia until there are enough.
//
// The length w that weighs normals against positions is 2s, where s = √(A/m) is the size of a group
// if the total area A is divided evenly among the m groups asked for. A square piece of a wall of
// that size has inertia s⁴/6; two perpendicular square faces with edge b have about b²w² = 4b²s².
// So the faces of a box part when b exceeds about s/5, and below that stay one group as long as
// walls are still coarse. Likewise a thin round bar of length s is divided about every half radian.
// m is k for patches and n for elements, which resolve finer details.
#include <algorithm>
#include <cmath>
#include <queue>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/geometry/facet_group.h"
#include "relumbre/geometry/grouping.h"

namespace relumbre {
namespace {

/// A range of items. Groups form a list in which the two parts of a split stay neighbours, so that
/// the elements of a patch end up in one run.
struct Group {
  std::uint32_t begin, end;
  std::uint32_t next = kNone;
  std::uint32_t patch = 0;
};

class Clustering {
 public:
  Clustering(FacetForest& forest, std::span<const std::uint32_t> label_of_triangle);

  [[nodiscard]] std::size_t size() const { return groups_.size(); }
  /// Splits until there are `target` groups. Throws ValueError naming `what` if none can be cut.
  void grow(std::size_t target, const char* what);
  /// Every group becomes a patch; later parts belong to their group's patch.
  void mark_patches();
  [[nodiscard]] Grouping grouping() const;

 private:
  struct Candidate {
    Division division;
    std::uint32_t group;
    /// A priority queue serves the largest first; ties go to the older group.
    bool operator<(const Candidate& o) const {
      return division.inertia != o.division.inertia ? division.inertia < o.division.inertia
                                                    : group > o.group;
    }
  };
  [[nodiscard]] std::span<GroupItem> items_of(std::uint32_t group);
  [[nodiscard]] Candidate candidate(std::uint32_t group, double normal_scale);
  bool cut_single(std::uint32_t group);
  std::uint32_t split(std::uint32_t group, const Division& division);

  FacetForest& forest_;
  std::vector<GroupItem> items_;
  std::vector<Group> groups_;
};

/// Sides sorted by label, by side within a label.
std::vector<std::uint32_t> sides_by_label(const FacetForest& forest,
                                          std::span<const std::uint32_t> labels) {
  std::vector<std::uint32_t> sides(forest.sides());
  for (std::uint32_t i = 0; i < forest.sides(); ++i) sides[i] = i;
  if (labels.empty()) return sides;
  std::stable_sort(sides.begin(), sides.end(), [&](std::uint32_t a, std::uint32_t b) {
    return labels[forest[a].side / 2] < labels[forest[b].side / 2];
  });
  return sides;
}

Clustering::Clustering(FacetForest& forest, std::span<const std::uint32_t> labels)
    : forest_(forest) {
  items_.reserve(forest.sides());
  std::uint32_t previous = 0;
  for (const std::uint32_t side : sides_by_label(forest, labels)) {
    const std::uint32_t label = labels.empty() ? 0 : labels[forest[side].side / 2];
    const auto at = static_cast<std::uint32_t>(items_.size());
    if (groups_.empty() || label != previous) {
      if (!groups_.empty()) groups_.back().next = static_cast<std::uint32_t>(groups_.size());
      groups_.push_back({at, at});
    }
    previous = label;
    items_.emplace_back(forest, side);
    ++groups_.back().end;
  }
}

std::span<GroupItem> Clustering::items_of(std::uint32_t group) {
  const Group& g = groups_[group];
  return std::span(items_).subspan(g.begin, g.end - g.begin);
}

Clustering::Candidate Clustering::candidate(std::uint32_t group, double normal_scale) {
  return {measure(items_of(group), normal_scale), group};
}

/// Replaces the only facet of a group by its four children, at the end of the items.
bool Clustering::cut_single(std::uint32_t group) {
  Group& g = groups_[group];
  const auto first = forest_.cut(items_[g.begin].cell);
  if (!first) return false;
  g.begin = static_cast<std::uint32_t>(items_.size());
  g.end = g.begin + 4;
  for (std::uint32_t child = *first; child < *first + 4; ++child) {
    items_.emplace_back(forest_, child);
  }
  return true;
}

/// The second part becomes a new group, listed after the first.
std::uint32_t Clustering::split(std::uint32_t group, const Division& division) {
  const std::size_t first = divide(items_of(group), division);
  const auto added = static_cast<std::uint32_t>(groups_.size());
  const std::uint32_t middle = groups_[group].begin + static_cast<std::uint32_t>(first);
  groups_.push_back({middle, groups_[group].end, groups_[group].next, groups_[group].patch});
  groups_[group].end = middle;
  groups_[group].next = added;
  return added;
}

void Clustering::grow(std::size_t target, const char* what) {
  const double normal_scale = 2 * std::sqrt(forest_.area() / static_cast<double>(target));
  std::priority_queue<Candidate> queue;
  for (std::uint32_t g = 0; g < groups_.size(); ++g) queue.push(candidate(g, normal_scale));
  while (groups_.size() < target) {
    if (queue.empty()) {
      throw ValueError(fmt::format("{}: {} asked, but the mesh cannot be cut into more than {}",
                                   what, target, groups_.size()));
    }
    Candidate largest = queue.top();
    queue.pop();
    if (items_of(largest.group).size() == 1) {
      if (!cut_single(largest.group)) continue;
      largest = candidate(largest.group, normal_scale);
    }
    const std::uint32_t added = split(largest.group, largest.division);
    queue.push(candidate(largest.group, normal_scale));
    queue.push(candidate(added, normal_scale));
  }
}

void Clustering::mark_patches() {
  for (std::uint32_t g = 0; g < groups_.size(); ++g) groups_[g].patch = g;
}

Grouping Clustering::grouping() const {
  Grouping result;
  result.leaves.reserve(items_.size());
  std::uint32_t previous = kNone;
  for (std::uint32_t g = 0; g != kNone; g = groups_[g].next) {
    if (groups_[g].patch != previous) {
      result.patch_offsets.push_back(static_cast<std::uint32_t>(result.facet_offsets.size()));
    }
    previous = groups_[g].patch;
    result.facet_offsets.push_back(static_cast<std::uint32_t>(result.leaves.size()));
    for (std::uint32_t i = groups_[g].begin; i < groups_[g].end; ++i) {
      result.leaves.push_back(items_[i].cell);
    }
  }
  result.patch_offsets.push_back(static_cast<std::uint32_t>(result.facet_offsets.size()));
  result.facet_offsets.push_back(static_cast<std::uint32_t>(result.leaves.size()));
  return result;
}

}  // namespace

Grouping group_by_clusters(FacetForest& forest, const TessellationConfig& config) {
  Clustering clustering(forest, config.separate);
  if (clustering.size() > config.patches) {
    throw ValueError(fmt::format("patches: {} asked, but {} separate surfaces need one each",
                                 config.patches, clustering.size()));
  }
  clustering.grow(config.patches, "patches");
  clustering.mark_patches();
  clustering.grow(config.elements, "elements");
  return clustering.grouping();
}

}  // namespace relumbre
