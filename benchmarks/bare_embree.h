/// Bare Embree loops, for benchmarks: rays in, hits dropped.
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "relumbre/geometry/triangle_mesh.h"
#include "relumbre/visibility/embree.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre::bench {

/// A scene as Embree makes it, without anything of ours around it.
class BareScene {
 public:
  BareScene(const TriangleMesh& mesh, RTCBuildQuality quality, RTCSceneFlags flags)
      : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneBuildQuality(scene_, quality);
    rtcSetSceneFlags(scene_, flags);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    copy(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions);
    copy(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
    rtcSetGeometryBuildQuality(geometry, quality);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~BareScene() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }
  BareScene(const BareScene&) = delete;
  BareScene& operator=(const BareScene&) = delete;
  [[nodiscard]] RTCScene get() const { return scene_; }

 private:
  template <class T>
  static void copy(RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                   const std::vector<T>& values) {
    void* to = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), values.size());
    std::memcpy(to, values.data(), values.size() * sizeof(T));
  }

  RTCDevice device_;
  RTCScene scene_;
};

/// Of a number of rays that 16 divides.
using Loop = void (*)(RTCScene, std::span<const Ray>);

void one_by_one(RTCScene scene, std::span<const Ray> rays);
/// Packets of sixteen neighbours that go the same way, or any.
void by_sixteen(RTCScene scene, std::span<const Ray> rays);
void by_sixteen_incoherent(RTCScene scene, std::span<const Ray> rays);

struct NamedLoop {
  const char* name;
  Loop loop;
};

/// All that a bake's rays might be traced by.
std::vector<NamedLoop> loops();

}  // namespace relumbre::bench
