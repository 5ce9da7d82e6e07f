#include "relumbre/experiment/machine_trace.h"

#include "relumbre/archsim/trace_recorder.h"
#include "relumbre/base/parallel.h"
#include "relumbre/octree/geometry_unit.h"
#include "relumbre/render/grid_rays.h"

namespace relumbre {

namespace {

static_assert(kMaxDepth <= kMaxTraceLevels);

/// An observer of traversals that writes a row of a trace.
struct RowObserver {
  TraceRecorder::Row& row;

  void begin_ray(const GridRay&) { row.begin_ray(); }
  void visit(LocationCode, int) { row.task(); }
  void read(LocationCode code, int level) { row.read(code, level); }
  void restart() {}
};
static_assert(TraversalObserver<RowObserver>);

void trace_ray(const Octree& octree, const CastRay& ray, const std::optional<Traversal>& traversal,
               RowObserver& observer) {
  if (traversal)
    (void)trace(octree, GridRay(ray.origin, ray.direction), *traversal, observer);
  else
    (void)trace_geometry_unit(octree, ray.origin, ray.direction, observer);
}

}  // namespace

Trace machine_trace(const Octree& octree, const Cube& cube, const Camera& camera,
                    const MachineTraceConfig& config, Progress& progress) {
  const GridRays rays(cube, static_cast<unsigned>(octree.depth()), camera, config.width,
                      config.height);
  TraceRecorder recorder({config.width, config.height, octree.depth()});
  progress.begin("traverse", config.height);
  parallel_for(0, config.height, 1, [&](std::size_t i) {
    progress.check();
    const auto y = static_cast<std::uint32_t>(i);
    TraceRecorder::Row row = recorder.row(y);
    RowObserver observer{row};
    for (std::uint32_t x = 0; x < config.width; ++x)
      trace_ray(octree, rays.through_center(x, y), config.traversal, observer);
    row.finish();
    progress.advance(1);
  });
  return recorder.finish();
}

}  // namespace relumbre
