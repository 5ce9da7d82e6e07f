/// Which facets around one position are smooth with each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// A facet as seen from one of its loop vertices.
struct Incidence {
  Vec3f normal;            ///< unit
  std::uint32_t triangle;  ///< source triangle
  std::uint32_t back;      ///< 1 for its back side
  std::uint32_t label;     ///< never smooth with another label
};

/// Divides the facets around a position into smooth groups. Reusable, so that memory is allocated
/// once for many positions.
class SmoothGroups {
 public:
  explicit SmoothGroups(float crease_deg);

  /// The group of every facet, numbered from 0 in order of first appearance; valid until the next
  /// call. Groups are the connected components under "same label, and normals within the crease
  /// angle". If that would join the two sides of one triangle (at the tip of a needle), back sides
  /// are kept from front sides. O(m + d²) for m facets with d distinct normals.
  std::span<const std::uint32_t> divide(std::span<const Incidence> facets);

 private:
  struct Node {
    Vec3f normal;
    std::uint32_t label, back, group;
  };
  void connect(std::span<const Incidence> facets, bool keep_sides_apart);
  std::uint32_t node_of(const Incidence& facet, bool rounded, bool keep_sides_apart);
  void merge_with_smooth_nodes(std::size_t added);
  [[nodiscard]] bool joins_sides(std::span<const Incidence> facets) const;
  void renumber();

  float least_cosine_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> node_of_facet_, group_of_facet_, number_;
};

}  // namespace relumbre
