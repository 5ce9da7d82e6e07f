/// A blur's outline as edges in few directions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "relumbre/dof/outline.h"

namespace relumbre {

/// A polygon of diameter 1 as a running sum along each row sees it: where a row enters the polygon
/// the sum steps up, where it leaves it, down. From row to row the step moves by the edge's slope,
/// so that all of an edge is told by where it begins and where it ends.
///
///        ┌────┐        level 0: two edges begin
///       ╱      ╲
///      ╱        ╲      level 1: two end, two begin
///      ╲        ╱
///       ╲      ╱
///        └────┘        level 2: two end
struct SkewedOutline {
  /// An edge begins or ends.
  struct Change {
    std::size_t slope;  ///< of the edge: which of `slopes`
    double x;           ///< where it does
    double side;        ///< of the polygon: left +1, right −1
    bool begins;        ///< going down
  };
  struct Level {
    double y;
    std::vector<Change> changes;
    bool begins = false;  ///< some edge does
  };
  std::vector<double> slopes;  ///< dx/dy, all different
  std::vector<Level> levels;
  double area = 0, half_width = 0, half_height = 0;

  /// Every edge goes straight down.
  [[nodiscard]] bool upright() const;

  /// Edges have at most so many slopes, none steeper than kSteepest columns a row.
  static constexpr std::size_t kMostSlopes = 4;
  static constexpr double kSteepest = 4;
};

/// Nothing for a disc (no corners), for an odd number of corners, which change when they are turned
/// by half a turn, and for polygons with more slopes or steeper ones.
std::optional<SkewedOutline> skewed_outline(const OutlineCorners& corners);

}  // namespace relumbre
