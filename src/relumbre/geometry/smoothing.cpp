#include "relumbre/geometry/smoothing.h"

#include <cmath>
#include <numbers>

#include "relumbre/geometry/tessellation.h"

namespace relumbre {
namespace {

/// Around a position with more facets than this, normals are rounded so that few are distinct.
constexpr std::size_t kManyFacets = 64;

Vec3f rounded_normal(const Vec3f& n) {
  constexpr float steps = 16;
  return normalized(
      Vec3f{std::round(n.x * steps), std::round(n.y * steps), std::round(n.z * steps)});
}

}  // namespace

SmoothGroups::SmoothGroups(float crease_deg)
    // Nearly equal normals must pass at 0 degrees, too.
    : least_cosine_(std::cos(crease_deg * std::numbers::pi_v<float> / 180) - 1e-6F) {}

std::span<const std::uint32_t> SmoothGroups::divide(std::span<const Incidence> facets) {
  const bool many = facets.size() > kManyFacets;
  connect(facets, many);
  if (!many && joins_sides(facets)) connect(facets, true);
  renumber();
  return group_of_facet_;
}

void SmoothGroups::connect(std::span<const Incidence> facets, bool keep_sides_apart) {
  nodes_.clear();
  node_of_facet_.clear();
  for (const Incidence& facet : facets) {
    node_of_facet_.push_back(node_of(facet, facets.size() > kManyFacets, keep_sides_apart));
  }
  group_of_facet_.clear();
  for (const std::uint32_t node : node_of_facet_) group_of_facet_.push_back(nodes_[node].group);
}

/// The node of equal normal, label and side; a new one at once joins those it is smooth with.
std::uint32_t SmoothGroups::node_of(const Incidence& facet, bool rounded, bool keep_sides_apart) {
  const Vec3f normal = rounded ? rounded_normal(facet.normal) : facet.normal;
  const std::uint32_t back = keep_sides_apart ? facet.back : 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (node.normal == normal && node.label == facet.label && node.back == back) {
      return static_cast<std::uint32_t>(i);
    }
  }
  const auto added = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({normal, facet.label, back, added});
  merge_with_smooth_nodes(added);
  return added;
}

void SmoothGroups::merge_with_smooth_nodes(std::size_t added) {
  Node& node = nodes_[added];
  for (std::size_t i = 0; i < added; ++i) {
    const Node& other = nodes_[i];
    if (other.group == node.group || other.label != node.label || other.back != node.back) continue;
    if (dot(other.normal, node.normal) < least_cosine_) continue;
    const std::uint32_t from = node.group, to = other.group;
    for (Node& n : nodes_) n.group = n.group == from ? to : n.group;
  }
}

bool SmoothGroups::joins_sides(std::span<const Incidence> facets) const {
  for (std::size_t i = 0; i < facets.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (facets[i].triangle == facets[j].triangle && facets[i].back != facets[j].back &&
          group_of_facet_[i] == group_of_facet_[j]) {
        return true;
      }
    }
  }
  return false;
}

void SmoothGroups::renumber() {
  number_.assign(nodes_.size(), kNone);
  std::uint32_t next = 0;
  for (std::uint32_t& group : group_of_facet_) {
    if (number_[group] == kNone) number_[group] = next++;
    group = number_[group];
  }
}

}  // namespace relumbre
