/// The figures of an octree, as `voxelize` and `info` print them.
#pragma once

#include "cli/command.h"
#include "relumbre/octree/rlo_file.h"

namespace relumbre::cli {

/// Cube, depth, nodes a level, bytes a voxel and build time, in the report's current section.
void report_octree(const RloFile& file, Session& session);

}  // namespace relumbre::cli
