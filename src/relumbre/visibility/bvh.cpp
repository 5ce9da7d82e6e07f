#include "relumbre/visibility/bvh.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/visibility/bvh_binary.h"

namespace relumbre {

namespace {

using bvh::BinaryChild;
using bvh::BinaryTree;
using bvh::Primitive;

constexpr std::size_t kWidth = 8;
constexpr std::size_t kGrain = 256;

bool within_reach(const Vec3f& p) {
  constexpr float kFarthest = 1e18F;
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

std::vector<Primitive> primitives_of(const TriangleMesh& mesh) {
  std::vector<Primitive> primitives;
  primitives.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<Vec3f, 3> corners{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    if (std::all_of(corners.begin(), corners.end(), within_reach)) {
      primitives.push_back({bounds(corners), t});
    }
  }
  return primitives;
}

/// Up to eight children of a wide node, at their slots.
struct WideChildren {
  std::array<BinaryChild, kWidth> slot;
  std::array<bool, kWidth> used{};
};

/// Opens the largest inner node among a node's children until there are eight.
std::size_t open_children(const BinaryTree& tree, const BinaryChild& root,
                          std::array<BinaryChild, kWidth>& children) {
  children[0] = root;
  std::size_t count = 1;
  while (count < kWidth) {
    std::size_t largest = count;
    for (std::size_t i = 0; i < count; ++i) {
      if (children[i].what.is_leaf()) continue;
      if (largest == count ||
          bvh::half_area(children[i].box) > bvh::half_area(children[largest].box)) {
        largest = i;
      }
    }
    if (largest == count) break;
    const std::array<BinaryChild, 2>& both = tree.inner[children[largest].what.index()];
    children[largest] = both[0];
    children[count++] = both[1];
  }
  return count;
}

/// Bit k of a slot's number says at which end of axis k its child should lie. Pairs of child and
/// slot are made greedily, those that fit best first.
WideChildren choose_slots(std::span<const BinaryChild> children, const Box& whole) {
  std::array<std::array<float, kWidth>, kWidth> fit{};  // of child and slot
  for (std::size_t c = 0; c < children.size(); ++c) {
    const Vec3f at = children[c].box.center() - whole.center();
    for (std::size_t s = 0; s < kWidth; ++s) {
      fit[c][s] = ((s & 1) != 0 ? at.x : -at.x) + ((s & 2) != 0 ? at.y : -at.y) +
                  ((s & 4) != 0 ? at.z : -at.z);
    }
  }
  WideChildren result;
  std::array<bool, kWidth> placed{};
  for (std::size_t turn = 0; turn < children.size(); ++turn) {
    std::size_t child = kWidth, slot = kWidth;
    for (std::size_t c = 0; c < children.size(); ++c) {
      for (std::size_t s = 0; s < kWidth && !placed[c]; ++s) {
        if (result.used[s]) continue;
        if (child == kWidth || fit[c][s] > fit[child][slot]) child = c, slot = s;
      }
    }
    placed[child] = result.used[slot] = true;
    result.slot[slot] = children[child];
  }
  return result;
}

/// The exponent of the smallest cell of which 255 reach from `lower` to `upper`.
std::uint8_t cell_exponent(float lower, float upper) {
  const double cell = (static_cast<double>(upper) - static_cast<double>(lower)) / 255;
  if (!(cell > 0)) return 1;
  int exponent = 0;
  std::frexp(cell, &exponent);  // cell < 2^exponent
  return static_cast<std::uint8_t>(std::clamp(exponent + 127, 1, 254));
}

void set_grid(BvhNode& node, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.origin[axis] = box.lower[axis];
    node.exponent[axis] = cell_exponent(box.lower[axis], box.upper[axis]);
  }
}

/// The child's box in cells, rounded outwards.
void set_box(BvhNode& node, std::size_t slot, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double origin = static_cast<double>(node.origin[axis]);
    const double cell = std::ldexp(1.0, node.exponent[axis] - 127);
    const double lower = std::floor((static_cast<double>(box.lower[axis]) - origin) / cell);
    const double upper = std::ceil((static_cast<double>(box.upper[axis]) - origin) / cell);
    node.lower[axis][slot] = static_cast<std::uint8_t>(std::clamp(lower, 0.0, 255.0));
    node.upper[axis][slot] = static_cast<std::uint8_t>(std::clamp(upper, 0.0, 255.0));
  }
}

/// A node to be made: its number is its place in its level.
struct Planned {
  BinaryChild root;
  WideChildren children{};
  std::uint32_t first_child = 0, first_triangle = 0;

  [[nodiscard]] std::uint32_t nodes() const {
    std::uint32_t count = 0;
    for (std::size_t s = 0; s < kWidth; ++s) count += is_node(s) ? 1 : 0;
    return count;
  }
  [[nodiscard]] std::uint32_t triangles() const {
    std::uint32_t count = 0;
    for (std::size_t s = 0; s < kWidth; ++s)
      count += is_leaf(s) ? children.slot[s].what.count() : 0;
    return count;
  }
  [[nodiscard]] bool is_node(std::size_t s) const {
    return children.used[s] && !children.slot[s].what.is_leaf();
  }
  [[nodiscard]] bool is_leaf(std::size_t s) const {
    return children.used[s] && children.slot[s].what.is_leaf();
  }
};

BvhTriangle triangle_of(const TriangleMesh& mesh, std::uint32_t index) {
  BvhTriangle triangle{};
  triangle.index = index;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    triangle.a[axis] = mesh.corner(index, 0)[axis];
    triangle.b[axis] = mesh.corner(index, 1)[axis];
    triangle.c[axis] = mesh.corner(index, 2)[axis];
  }
  return triangle;
}

/// Merges a binary tree into wide nodes, a level at a time.
class Widener {
 public:
  Widener(const TriangleMesh& mesh, const std::vector<Primitive>& primitives,
          const BinaryTree& tree)
      : mesh_(mesh), primitives_(primitives), tree_(tree) {}

  Bvh run() && {
    result_.triangles.resize(primitives_.size());
    std::vector<Planned> level{{tree_.root}};
    for (; !level.empty(); ++result_.depth) {
      plan(level);
      const std::size_t first = result_.nodes.size();
      result_.nodes.resize(first + level.size());
      std::vector<Planned> next(next_node_ - result_.nodes.size());
      parallel_for(0, level.size(), kGrain,
                   [&](std::size_t i) { emit(level[i], result_.nodes[first + i], next); });
      level = std::move(next);
    }
    return std::move(result_);
  }

 private:
  /// Chooses the children of a level's nodes, and where they will lie.
  void plan(std::vector<Planned>& level) {
    parallel_for(0, level.size(), kGrain, [&](std::size_t i) {
      std::array<BinaryChild, kWidth> children;
      const std::size_t count = open_children(tree_, level[i].root, children);
      level[i].children = choose_slots(std::span(children).first(count), level[i].root.box);
    });
    next_node_ = result_.nodes.size() + level.size();
    for (Planned& node : level) {
      node.first_child = static_cast<std::uint32_t>(next_node_);
      node.first_triangle = static_cast<std::uint32_t>(next_triangle_);
      next_node_ += node.nodes();
      next_triangle_ += node.triangles();
    }
  }

  void emit(const Planned& planned, BvhNode& node, std::vector<Planned>& next) {
    node = {};
    node.first_child = planned.first_child, node.first_triangle = planned.first_triangle;
    set_grid(node, planned.root.box);
    // The next level begins where the first of this level's children lies.
    std::size_t child = planned.first_child - (next_node_ - next.size());
    std::uint32_t triangles = 0;
    for (std::size_t s = 0; s < kWidth; ++s) {
      if (!planned.children.used[s]) continue;
      const BinaryChild& at = planned.children.slot[s];
      set_box(node, s, at.box);
      if (planned.is_node(s)) {
        node.meta[s] = static_cast<std::uint8_t>(1U << 5 | (24 + s));
        node.inner = static_cast<std::uint8_t>(node.inner | 1U << s);
        next[child++].root = at;
      } else {
        const std::uint32_t count = at.what.count();
        node.meta[s] = static_cast<std::uint8_t>(((1U << count) - 1) << 5 | triangles);
        for (std::uint32_t i = 0; i < count; ++i, ++triangles) {
          const std::uint32_t t = primitives_[at.what.index() + i].triangle;
          result_.triangles[planned.first_triangle + triangles] = triangle_of(mesh_, t);
        }
      }
    }
  }

  const TriangleMesh& mesh_;
  const std::vector<Primitive>& primitives_;
  const BinaryTree& tree_;
  Bvh result_;
  std::size_t next_node_ = 0, next_triangle_ = 0;
};

}  // namespace

void check_positions(const TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      if (vertex < mesh.positions.size()) continue;
      throw ValueError("triangle " + std::to_string(t) + " refers to position " +
                       std::to_string(vertex) + " of " + std::to_string(mesh.positions.size()));
    }
  }
}

Bvh build_bvh(const TriangleMesh& mesh) {
  if (mesh.triangles.size() > Bvh::kMaxTriangles) {
    throw ValueError("the mesh has " + std::to_string(mesh.triangles.size()) +
                     " triangles; at most 2^28 are possible");
  }
  check_positions(mesh);
  std::vector<Primitive> primitives = primitives_of(mesh);
  if (primitives.empty()) {
    Bvh none;
    none.nodes.push_back({});
    none.depth = 1;
    return none;
  }
  const BinaryTree tree = bvh::build_binary(primitives, Bvh::kMaxDepth);
  return Widener(mesh, primitives, tree).run();
}

}  // namespace relumbre
