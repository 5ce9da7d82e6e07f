/// How a window along one axis, with real bounds, covers the pixels there are.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace relumbre {

/// What is seen beyond the image's edge.
enum class Border {
  kClamp,     ///< the edge's pixel: a a a | a b c
  kConstant,  ///< a given value:      v v v | a b c
  kMirror,    ///< the image mirrored: c b a | a b c
};

/// Pixels begin … end − 1, each counted `weight` times.
struct AxisSegment {
  std::size_t begin = 0, end = 0;
  double weight = 0;
};

/// The part of [low, high] that each pixel covers, where pixel i is [i, i + 1]. Its length times a
/// pixel's weight is exact for what a piecewise-constant image integrates to.
class AxisWindow {
 public:
  /// low ≤ high, both within ±2^30; size ≥ 1.
  AxisWindow(double low, double high, std::size_t size, Border border);

  [[nodiscard]] std::span<const AxisSegment> segments() const { return {segments_.data(), count_}; }
  /// Length of the window inside the image, or all of it where the border repeats pixels.
  [[nodiscard]] double covered() const { return covered_; }
  [[nodiscard]] double length() const { return length_; }

 private:
  void add(std::size_t begin, std::size_t end, double weight);
  void add_inside(double low, double high);
  void add_clamped(double low, double high);
  void add_mirrored(double low, double high);

  double size_, length_, covered_ = 0;
  std::size_t count_ = 0;
  std::array<AxisSegment, 10> segments_;  ///< mirrored: whole periods, and three parts of three
};

}  // namespace relumbre
