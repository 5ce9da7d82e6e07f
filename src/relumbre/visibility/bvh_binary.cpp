#include "relumbre/visibility/bvh_binary.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <optional>
#include <span>

#include "relumbre/base/parallel.h"

namespace relumbre::bvh {

namespace {

constexpr std::size_t kBins = 16;
/// What it costs to meet a node's box instead of a triangle.
constexpr double kBoxCost = 0.5;
/// Ranges as long as this are binned by several threads; shorter ones are one thread's task.
constexpr std::size_t kTask = 16384;

struct Range {
  std::size_t first, last;
  std::size_t levels;  ///< of inner nodes that are left
  BinaryChild* child;  ///< what to fill in; its box is known

  [[nodiscard]] std::size_t count() const { return last - first; }
};

/// Twice the centre. Finite: coordinates are.
Vec3f doubled_center(const Primitive& p) { return p.box.lower + p.box.upper; }

struct Bin {
  Box box;
  std::size_t count = 0;

  void merge(const Bin& other) { extend(box, other.box), count += other.count; }
};
using Bins = std::array<std::array<Bin, kBins>, 3>;

/// Which bin of an axis a centre is in.
class Grid {
 public:
  explicit Grid(const Box& centers) : lower_(centers.lower) {
    const Vec3f size = centers.size();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scale_[axis] = size[axis] > 0 ? static_cast<float>(kBins) / size[axis] : 0;
    }
  }
  [[nodiscard]] std::size_t bin(const Vec3f& center, std::size_t axis) const {
    const float at = (center[axis] - lower_[axis]) * scale_[axis];
    return static_cast<std::size_t>(std::clamp(at, 0.0F, static_cast<float>(kBins - 1)));
  }

 private:
  Vec3f lower_, scale_;
};

struct Split {
  double cost;
  std::size_t axis, bin;  ///< the first bin of the right side
  Box left, right;
};

/// Adds up what `add(sum, primitive)` makes of all primitives; the order must not matter.
template <class Sum, class Add, class Merge>
Sum reduce(std::span<const Primitive> primitives, Add&& add, Merge&& merge) {
  Sum total;
  if (primitives.size() <= kTask) {  // spares the small ones, which are most, the threads
    for (const Primitive& p : primitives) add(total, p);
    return total;
  }
  std::mutex mutex;
  parallel_chunks(0, primitives.size(), kTask, [&](std::size_t first, std::size_t last) {
    Sum part;
    for (std::size_t i = first; i < last; ++i) add(part, primitives[i]);
    const std::lock_guard lock(mutex);
    merge(total, part);
  });
  return total;
}

Box centers_of(std::span<const Primitive> primitives) {
  return reduce<Box>(
      primitives, [](Box& box, const Primitive& p) { box.extend(doubled_center(p)); },
      [](Box& total, const Box& part) { extend(total, part); });
}

Box box_of(std::span<const Primitive> primitives) {
  return reduce<Box>(
      primitives, [](Box& box, const Primitive& p) { extend(box, p.box); },
      [](Box& total, const Box& part) { extend(total, part); });
}

Bins fill_bins(std::span<const Primitive> primitives, const Grid& grid) {
  const auto add = [&grid](Bins& bins, const Primitive& p) {
    const Vec3f center = doubled_center(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Bin& bin = bins[axis][grid.bin(center, axis)];
      extend(bin.box, p.box);
      ++bin.count;
    }
  };
  const auto merge = [](Bins& total, const Bins& part) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t b = 0; b < kBins; ++b) total[axis][b].merge(part[axis][b]);
    }
  };
  return reduce<Bins>(primitives, add, merge);
}

/// The cheapest cut between bins of one axis that leaves neither side empty.
void improve(std::optional<Split>& best, const std::array<Bin, kBins>& bins, std::size_t axis) {
  std::array<Bin, kBins> right;  // b: bins b and up
  right[kBins - 1] = bins[kBins - 1];
  for (std::size_t b = kBins - 1; b-- > 1;) {
    right[b] = right[b + 1];
    right[b].merge(bins[b]);
  }
  Bin left;
  for (std::size_t b = 1; b < kBins; ++b) {
    left.merge(bins[b - 1]);
    if (left.count == 0 || right[b].count == 0) continue;
    const double cost = half_area(left.box) * static_cast<double>(left.count) +
                        half_area(right[b].box) * static_cast<double>(right[b].count);
    if (!best || cost < best->cost) best = Split{cost, axis, b, left.box, right[b].box};
  }
}

class Builder {
 public:
  Builder(std::span<Primitive> primitives, BinaryTree& tree)
      : primitives_(primitives), tree_(tree) {}

  /// Fills in what is under a range; those not longer than kTask are put off if there are `tasks`.
  void build(const Range& range, std::vector<Range>* tasks) {
    if (tasks != nullptr && range.count() <= kTask) return tasks->push_back(range);
    if (range.count() == 1) return make_leaf(range);
    const std::span<Primitive> own = primitives_.subspan(range.first, range.count());
    const Grid grid(centers_of(own));
    const std::optional<Split> split = best_split(own, grid);
    if (is_best_left_whole(range, split)) return make_leaf(range);

    std::array<BinaryChild, 2> children;
    const bool balanced = !split || std::bit_width(range.count() - 1) + 1U >= range.levels;
    const std::size_t middle =
        range.first + (balanced ? halve(own, children) : partition(own, grid, *split, children));
    tree_.inner[middle] = children;
    range.child->what = Reference::inner(middle);
    build({range.first, middle, range.levels - 1, &tree_.inner[middle][0]}, tasks);
    build({middle, range.last, range.levels - 1, &tree_.inner[middle][1]}, tasks);
  }

 private:
  static void make_leaf(const Range& range) {
    range.child->what = Reference::leaf(range.first, range.count());
  }

  static std::optional<Split> best_split(std::span<const Primitive> own, const Grid& grid) {
    const Bins bins = fill_bins(own, grid);
    std::optional<Split> best;
    for (std::size_t axis = 0; axis < 3; ++axis) improve(best, bins[axis], axis);
    return best;
  }

  static bool is_best_left_whole(const Range& range, const std::optional<Split>& split) {
    if (range.count() > kMaxLeaf) return false;
    const double area = half_area(range.child->box);
    return !split || area * static_cast<double>(range.count()) <= split->cost + kBoxCost * area;
  }

  /// Both return how many go to the left.
  static std::size_t partition(std::span<Primitive> own, const Grid& grid, const Split& split,
                               std::array<BinaryChild, 2>& children) {
    const auto middle = std::partition(own.begin(), own.end(), [&](const Primitive& p) {
      return grid.bin(doubled_center(p), split.axis) < split.bin;
    });
    children[0].box = split.left, children[1].box = split.right;
    return static_cast<std::size_t>(middle - own.begin());
  }
  static std::size_t halve(std::span<Primitive> own, std::array<BinaryChild, 2>& children) {
    const Vec3f size = centers_of(own).size();
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = own.size() / 2;
    std::nth_element(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(half), own.end(),
                     [axis](const Primitive& a, const Primitive& b) {
                       const float x = doubled_center(a)[axis], y = doubled_center(b)[axis];
                       return x != y ? x < y : a.triangle < b.triangle;
                     });
    children[0].box = box_of(own.first(half)), children[1].box = box_of(own.subspan(half));
    return half;
  }

  std::span<Primitive> primitives_;
  BinaryTree& tree_;
};

}  // namespace

BinaryTree build_binary(std::vector<Primitive>& primitives, std::size_t max_depth) {
  BinaryTree tree;
  tree.inner.resize(primitives.size());
  tree.root.box = box_of(primitives);
  Builder builder(primitives, tree);
  std::vector<Range> tasks;
  builder.build({0, primitives.size(), max_depth, &tree.root}, &tasks);
  parallel_for(0, tasks.size(), 1, [&](std::size_t i) { builder.build(tasks[i], nullptr); });
  return tree;
}

}  // namespace relumbre::bvh
