#include "relumbre/archsim/node_reads.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <mutex>
#include <utility>

#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

/// The tree of the addresses that were read. As a path is walked down from node to node, each read
/// costs one look at its parent, without hashing.
class CountingTree {
 public:
  CountingTree() : nodes_(1) {}  // what is above the root

  void add(std::span<const std::uint8_t> reads) {
    std::array<std::uint32_t, 33> last{};  // [level + 1]
    for (const std::uint8_t read : reads) {
      const std::size_t level = read >> 3;
      const std::uint32_t node = child(last[level], read & 7U);
      last[level + 1] = node;
      ++nodes_[node].reads;
    }
  }

  /// Level by level, by address.
  [[nodiscard]] std::vector<NodeReads> list() const {
    std::vector<NodeReads> all;
    std::vector<std::pair<std::uint32_t, std::uint64_t>> level{{0, 0}}, next;  // node, address
    for (int depth = 0; !level.empty(); ++depth, level.swap(next), next.clear())
      for (const auto& [node, address] : level)
        for (unsigned octant = 0; octant < 8; ++octant) {
          const std::uint32_t below = nodes_[node].children[octant];
          if (below == 0) continue;
          next.emplace_back(below, address * 8 + octant);
          all.push_back({depth, next.back().second, nodes_[below].reads});
        }
    return all;
  }

 private:
  struct Node {
    std::array<std::uint32_t, 8> children{};  ///< 0: none yet
    std::uint64_t reads = 0;
  };

  std::uint32_t child(std::uint32_t node, unsigned octant) {
    const std::uint32_t known = nodes_[node].children[octant];
    if (known != 0) return known;
    const auto made = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].children[octant] = made;
    nodes_.emplace_back();
    return made;
  }

  std::vector<Node> nodes_;
};

std::vector<NodeReads> sum_of(const std::vector<NodeReads>& a, const std::vector<NodeReads>& b) {
  std::vector<NodeReads> sum;
  sum.reserve(std::max(a.size(), b.size()));
  auto at = b.begin();
  for (const NodeReads& node : a) {
    while (at != b.end() && at->address < node.address) sum.push_back(*at++);
    sum.push_back(node);
    if (at != b.end() && at->address == node.address) sum.back().reads += at++->reads;
  }
  sum.insert(sum.end(), at, b.end());
  return sum;
}

}  // namespace

std::vector<NodeReads> count_node_reads(const Trace& trace) {
  const std::size_t height = trace.shape().height;
  std::vector<NodeReads> all;
  std::mutex mutex;
  parallel_chunks(0, height, 1 + height / thread_count(), [&](std::size_t begin, std::size_t end) {
    CountingTree tree;
    for (std::size_t y = begin; y < end; ++y)
      tree.add(trace.row_reads(static_cast<std::uint32_t>(y)));
    const std::vector<NodeReads> part = tree.list();
    const std::lock_guard lock(mutex);
    all = sum_of(all, part);
  });
  return all;
}

}  // namespace relumbre
