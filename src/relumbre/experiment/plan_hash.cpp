#include "relumbre/experiment/plan_hash.h"

#include <span>
#include <string>

#include "relumbre/base/content_hash.h"
#include "relumbre/base/mapped_file.h"
#include "relumbre/experiment/planned_scene.h"

namespace relumbre {

namespace {

/// Length first, so that no two lists can look like others.
template <class T>
void add(ContentHash& hash, std::span<const T> values) {
  hash.add_value(std::uint64_t{values.size()});
  hash.add_values(values);
}

}  // namespace

std::uint64_t plan_hash(const ExperimentPlan& plan) {
  ContentHash hash;
  hash.add_value(kMachineRevision);
  add(hash, std::span<const char>(canonical_text(plan)));
  for (const PlannedScene& planned : plan.scenes) {
    const TriangleMesh mesh = planned_scene(planned).mesh;
    add(hash, std::span<const Vec3f>(mesh.positions));
    add(hash, std::span<const Index3>(mesh.triangles));
  }
  if (!plan.camera_file.empty()) add(hash, MappedFile(plan.camera_file).bytes());
  return hash.digest();
}

}  // namespace relumbre
