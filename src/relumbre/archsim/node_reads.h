/// How often each address of a trace is read.
#pragma once

#include <cstdint>
#include <vector>

#include "relumbre/archsim/trace.h"

namespace relumbre {

struct NodeReads {
  int level = 0;
  std::uint64_t address = 0, reads = 0;
  friend bool operator==(const NodeReads&, const NodeReads&) = default;
};

/// Of every address that is read at all, in growing order, which is level by level. Threaded; a few
/// nanoseconds a read, and some 100 bytes an address and thread meanwhile.
std::vector<NodeReads> count_node_reads(const Trace& trace);

}  // namespace relumbre
