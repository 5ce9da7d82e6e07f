/// A RayScene that traces long batches on a GPU.
#pragma once

#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre::cuda {

/// Batches of 1,024 rays and more go to device number `device`; single rays, packets and shorter
/// batches go through the same Bvh on the CPU, with the same result. Threads do not wait for each
/// other: each has a stream and buffers of its own, of 2^18 rays (25 MB, half of it page-locked on
/// the host). Throws what build_bvh() throws, OutOfDeviceMemory, and DeviceError.
RayScene make_ray_scene(const TriangleMesh& mesh, int device);

}  // namespace relumbre::cuda
