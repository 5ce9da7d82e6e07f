#include "relumbre/geometry/clean.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"
#include "relumbre/geometry/position_index.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {
namespace {

constexpr double kRelativeHeight = 0x1p-22;
constexpr double kSmallestArea = 1e-30;

void check(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  if (count >= kNone) throw ValueError(fmt::format("mesh: {} triangles are too many", count));
  for (const std::size_t size : {mesh.material.size(), mesh.object.size(), mesh.two_sided.size()}) {
    if (size != 0 && size != count) {
      throw ShapeError(
          fmt::format("mesh: a per-triangle array has {} entries for {} triangles", size, count));
    }
  }
  for (std::size_t t = 0; t < count; ++t) {
    const std::uint32_t largest =
        *std::max_element(mesh.triangles[t].begin(), mesh.triangles[t].end());
    if (largest >= mesh.positions.size()) {
      throw ValueError(
          fmt::format("mesh: triangle {} uses vertex {} of {}", t, largest, mesh.positions.size()));
    }
  }
}

float largest_coordinate(const Vec3f& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

bool usable(const Vec3f& p) { return is_finite(p) && largest_coordinate(p) <= kLargestCoordinate; }

bool degenerate(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d ab = Vec3d(b) - Vec3d(a), ac = Vec3d(c) - Vec3d(a), bc = Vec3d(c) - Vec3d(b);
  const double doubled_area = length(cross(ab, ac));
  const double longest = std::sqrt(std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)}));
  const double magnitude =
      double{std::max({largest_coordinate(a), largest_coordinate(b), largest_coordinate(c)})};
  return doubled_area < 2 * kSmallestArea || doubled_area < kRelativeHeight * magnitude * longest;
}

/// Which orientations of which three points have been seen: an open-addressing hash set.
class SideSet {
 public:
  explicit SideSet(std::size_t triangles)
      : slots_(std::bit_ceil(std::max<std::size_t>(16, triangles + triangles / 2)), Slot{}) {}

  /// Adds a triangle's sides. False if all of them were there.
  bool insert(Index3 points, bool both_sides) {
    const bool odd = sort_points(points);
    const auto sides = static_cast<std::uint32_t>(both_sides ? 3 : odd ? 2 : 1);
    Slot& slot = slot_of(points);
    const bool added = (slot.sides & sides) != sides;
    slot.points = points;
    slot.sides |= sides;
    return added;
  }

 private:
  struct Slot {
    Index3 points{};
    std::uint32_t sides = 0;  ///< bit 0: even permutation of the sorted points; bit 1: odd
  };

  /// True if an odd number of swaps sorted them: the triangle faces the other way.
  static bool sort_points(Index3& p) {
    bool odd = false;
    const auto order = [&](std::size_t i, std::size_t j) {
      if (p[i] > p[j]) std::swap(p[i], p[j]), odd = !odd;
    };
    order(0, 1), order(1, 2), order(0, 1);
    return odd;
  }

  Slot& slot_of(const Index3& points) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = hash64(std::uint64_t{points[0]} << 32 | points[1], points[2]) & mask;
    while (slots_[at].sides != 0 && slots_[at].points != points) at = (at + 1) & mask;
    return slots_[at];
  }

  std::vector<Slot> slots_;
};

enum class Verdict : std::uint8_t { kKeep, kNonFinite, kDegenerate, kDuplicate };

Verdict judge_shape(const TriangleMesh& mesh, std::size_t t) {
  const Vec3f a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
  if (!usable(a) || !usable(b) || !usable(c)) return Verdict::kNonFinite;
  return degenerate(a, b, c) ? Verdict::kDegenerate : Verdict::kKeep;
}

/// One number a vertex, the same for equal positions.
std::vector<std::uint32_t> weld(const std::vector<Vec3f>& positions) {
  PositionIndex index(positions.size());
  std::vector<std::uint32_t> welded;
  welded.reserve(positions.size());
  for (const Vec3f& p : positions) welded.push_back(index.insert(p));
  return welded;
}

void find_duplicates(const TriangleMesh& mesh, std::vector<Verdict>& verdicts) {
  const std::vector<std::uint32_t> welded = weld(mesh.positions);
  SideSet seen(mesh.triangles.size());
  const auto visit = [&](bool two_sided) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool both = !mesh.two_sided.empty() && mesh.two_sided[t] != 0;
      if (both != two_sided || verdicts[t] != Verdict::kKeep) continue;
      const auto [a, b, c] = mesh.triangles[t];
      if (!seen.insert({welded[a], welded[b], welded[c]}, both)) verdicts[t] = Verdict::kDuplicate;
    }
  };
  visit(true);  // first, since they stand for one-sided ones of either orientation
  visit(false);
}

template <class T>
void compact(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

CleanReport report(const std::vector<Verdict>& verdicts) {
  CleanReport result;
  for (std::size_t t = 0; t < verdicts.size(); ++t) {
    switch (verdicts[t]) {
      case Verdict::kKeep:
        result.kept.push_back(static_cast<std::uint32_t>(t));
        break;
      case Verdict::kNonFinite:
        ++result.non_finite;
        break;
      case Verdict::kDegenerate:
        ++result.degenerate;
        break;
      case Verdict::kDuplicate:
        ++result.duplicate;
        break;
    }
  }
  return result;
}

}  // namespace

CleanReport clean(TriangleMesh& mesh) {
  check(mesh);
  std::vector<Verdict> verdicts(mesh.triangles.size());
  for (std::size_t t = 0; t < verdicts.size(); ++t) verdicts[t] = judge_shape(mesh, t);
  find_duplicates(mesh, verdicts);

  CleanReport result = report(verdicts);
  compact(mesh.triangles, result.kept);
  compact(mesh.material, result.kept);
  compact(mesh.object, result.kept);
  compact(mesh.two_sided, result.kept);
  const Vec3f used = mesh.triangles.empty() ? Vec3f{} : mesh.corner(0, 0);
  for (Vec3f& p : mesh.positions) p = usable(p) ? p : used;
  return result;
}

}  // namespace relumbre
