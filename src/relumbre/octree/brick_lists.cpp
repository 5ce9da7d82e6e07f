#include "relumbre/octree/brick_lists.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/brick.h"
#include "relumbre/octree/morton.h"
#include "relumbre/scan/radix_sort.h"

namespace relumbre {

namespace {

constexpr std::size_t kGrain = 4096;  // triangles

/// Levels above the bricks.
unsigned brick_depth(unsigned depth) {
  return depth > BrickFiller::kDepth ? depth - BrickFiller::kDepth : 0;
}

/// Calls visit(brick's Morton code) for all bricks that the triangle touches.
template <class Visit>
void for_each_brick(const TriangleMesh& mesh, const Cube& cube, unsigned depth, std::size_t t,
                    Visit&& visit) {
  const unsigned bricks = brick_depth(depth);
  const TriangleCells cells(grid_triangle(mesh, cube, t), kGridBits - bricks, Separating::k26);
  const auto code = [](const GridPoint& c) {
    return morton_encode({static_cast<std::uint32_t>(c.x), static_cast<std::uint32_t>(c.y),
                          static_cast<std::uint32_t>(c.z)});
  };
  if (cells.bounds().lower == cells.bounds().upper) return visit(code(cells.bounds().lower));
  cells.for_each(cells.bounds(), [&](const GridPoint& c) { visit(code(c)); });
}

void check_vertices(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!is_finite(mesh.positions[i]))
      throw ValueError("vertex " + std::to_string(i) + " of the mesh is not finite");
  }
}

struct Listed {
  std::vector<std::uint32_t> brick, triangle;
  void add(std::uint32_t b, std::uint32_t t) {
    brick.push_back(b);
    triangle.push_back(t);
  }
};

Listed joined(std::vector<Listed>& parts) {
  std::size_t size = 0;
  for (const Listed& part : parts) size += part.brick.size();
  Listed all;
  all.brick.reserve(size);
  all.triangle.reserve(size);
  for (Listed& part : parts) {
    all.brick.insert(all.brick.end(), part.brick.begin(), part.brick.end());
    all.triangle.insert(all.triangle.end(), part.triangle.begin(), part.triangle.end());
    part = {};
  }
  return all;
}

BrickLists cut_into_lists(Listed&& sorted) {
  BrickLists lists;
  for (std::size_t i = 0; i < sorted.brick.size(); ++i) {
    if (i > 0 && sorted.brick[i] == sorted.brick[i - 1]) continue;
    lists.brick.push_back(sorted.brick[i]);
    lists.first.push_back(i);
  }
  lists.first.push_back(sorted.brick.size());
  lists.triangle = std::move(sorted.triangle);
  return lists;
}

/// Bytes that a triangle in a brick's list takes while lists are sorted: twice a key and a number.
constexpr std::uint64_t kListBytes = 2 * (sizeof(std::uint32_t) + sizeof(std::uint32_t));

/// Bricks are counted in groups of as many as share a Morton code's upper bits.
constexpr unsigned kGroupLevels = 6;

}  // namespace

std::vector<BrickRange> plan_passes(const TriangleMesh& mesh, const Cube& cube, unsigned depth,
                                    std::uint64_t list_bytes, Progress& progress) {
  check_vertices(mesh);
  const unsigned bricks = brick_depth(depth);
  const unsigned shift = 3 * (bricks > kGroupLevels ? bricks - kGroupLevels : 0);
  const std::size_t groups = std::size_t{1} << (3 * bricks - shift);
  std::vector<std::atomic<std::uint64_t>> counts(groups);
  parallel_for(0, mesh.triangles.size(), kGrain, [&](std::size_t t) {
    progress.check();
    for_each_brick(mesh, cube, depth, t, [&](std::uint64_t brick) {
      counts[brick >> shift].fetch_add(1, std::memory_order_relaxed);
    });
  });
  std::vector<BrickRange> passes{{0, 0}};
  std::uint64_t bytes = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    const std::uint64_t more = kListBytes * counts[g];
    if (bytes > 0 && bytes + more > list_bytes) {
      passes.push_back({passes.back().last, 0});
      bytes = 0;
    }
    bytes += more;
    passes.back().last = (g + 1) << shift;
  }
  return passes;
}

BrickLists list_triangles(const TriangleMesh& mesh, const Cube& cube, unsigned depth,
                          const BrickRange& range, Progress& progress) {
  std::vector<Listed> parts((mesh.triangles.size() + kGrain - 1) / kGrain);
  parallel_chunks(0, mesh.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Listed& part = parts[begin / kGrain];
    for (std::size_t t = begin; t < end; ++t) {
      progress.check();
      for_each_brick(mesh, cube, depth, t, [&](std::uint64_t brick) {
        if (brick >= range.first && brick < range.last)
          part.add(static_cast<std::uint32_t>(brick), static_cast<std::uint32_t>(t));
      });
    }
  });
  Listed all = joined(parts);
  radix_sort(all.brick, all.triangle, 3 * brick_depth(depth));
  return cut_into_lists(std::move(all));
}

}  // namespace relumbre
