// The convex hull of points in the plane: what lies outside a line is kept by compaction, the
// farthest point is the last result of a scan for the maximum. Its twin wraps the points one by
// one.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "relumbre/scan/compact.h"

namespace {

struct Point {
  std::int64_t x, y;
  friend auto operator<=>(const Point&, const Point&) = default;
};
using Points = std::vector<Point>;

/// Twice the area of a, b, c; positive where c is to the left of a → b.
std::int64_t area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A point with its distance from a line; of equally far ones, the one farthest along.
struct Far {
  std::int64_t distance = 0, along = 0;
  Point point{};
  friend auto operator<=>(const Far&, const Far&) = default;
};
struct Farther {
  using value_type = Far;
  static constexpr bool exact = true;
  [[nodiscard]] Far identity() const { return {}; }
  Far operator()(const Far& a, const Far& b) const { return a < b ? b : a; }
};

Points left_of(const Points& points, const Point& a, const Point& b) {
  Points kept(points.size());
  kept.resize(relumbre::compact(points, kept, [&](const Point& p) { return area(a, b, p) > 0; }));
  return kept;
}

Point farthest(const Points& points, const Point& a, const Point& b) {
  std::vector<Far> far(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    far[i] = {area(a, b, p), (p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y), p};
  }
  return relumbre::inclusive_scan(far, far, Farther()).point;
}

/// Corners strictly between a and b, of points all to the left of a → b.
void extend(const Points& outside, const Point& a, const Point& b, std::set<Point>& hull) {
  if (outside.empty()) return;
  const Point c = farthest(outside, a, b);
  hull.insert(c);
  extend(left_of(outside, a, c), a, c, hull);
  extend(left_of(outside, c, b), c, b, hull);
}

std::set<Point> quickhull(const Points& points) {
  if (points.empty()) return {};
  const auto [low, high] = std::minmax_element(points.begin(), points.end());
  std::set<Point> hull{*low, *high};
  extend(left_of(points, *low, *high), *low, *high, hull);
  extend(left_of(points, *high, *low), *high, *low, hull);
  return hull;
}

/// Jarvis's march: from corner to corner, the next one having all others to its left.
std::set<Point> wrap(const Points& points) {
  if (points.empty()) return {};
  const Point start = *std::min_element(points.begin(), points.end());
  std::set<Point> hull;
  Point at = start;
  do {
    hull.insert(at);
    Point next = at;
    for (const Point& p : points) {
      const std::int64_t turn = area(at, next, p);
      const auto length = [&](const Point& q) {
        return (q.x - at.x) * (q.x - at.x) + (q.y - at.y) * (q.y - at.y);
      };
      if (next == at || turn < 0 || (turn == 0 && length(p) > length(next))) next = p;
    }
    at = next;
  } while (at != start);
  return hull;
}

}  // namespace

int main() {
  std::mt19937 random(1);
  for (const std::size_t size : {0UL, 1UL, 2UL, 3UL, 50UL, 20'011UL}) {
    for (const std::int64_t range : {0, 1, 20, 100'000}) {  // few places: collinear and equal ones
      std::uniform_int_distribution<std::int64_t> coordinate(-range, range);
      Points points(size);
      for (Point& p : points) p = {coordinate(random), coordinate(random)};
      if (quickhull(points) != wrap(points)) {
        std::printf("quickhull: wrong for %zu points in ±%lld\n", size,
                    static_cast<long long>(range));
        return 1;
      }
    }
  }
  std::puts("quickhull: as wrapping");
}
