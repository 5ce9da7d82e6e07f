#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <string>

#include "relumbre/base/error.h"
#include "relumbre/visibility/bvh.h"
#include "relumbre/visibility/embree.h"
#include "relumbre/visibility/ray_scene.h"
#include "relumbre/visibility/ray_tracer.h"

namespace relumbre {

namespace {

std::atomic<std::int64_t> embree_bytes{0};

bool count_bytes(void*, ssize_t bytes, bool) {
  embree_bytes += bytes;
  return true;
}

const char* reason_of(RTCError error) {
  switch (error) {
    case RTC_ERROR_OUT_OF_MEMORY:
      return "out of memory";
    case RTC_ERROR_UNSUPPORTED_CPU:
      return "this CPU is not supported";
    case RTC_ERROR_INVALID_ARGUMENT:
      return "invalid argument";
    case RTC_ERROR_INVALID_OPERATION:
      return "invalid operation";
    default:
      return "unknown error";
  }
}

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) throw Error(std::string("Embree: ") + reason_of(error));
}

/// One device for the process: making one takes longer than building a small scene.
class Device {
 public:
  static RTCDevice get() {
    static const Device shared;
    return shared.device_;
  }

 private:
  Device() : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr) check(nullptr);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, nullptr);
  }
  ~Device() { rtcReleaseDevice(device_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  RTCDevice device_;
};

/// Copies `values` into a buffer of the geometry, which Embree pads as its vector loads need.
template <class T>
void set_buffer(RTCDevice device, RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                const std::vector<T>& values) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), values.size());
  if (buffer == nullptr) check(device);
  std::memcpy(buffer, values.data(), values.size() * sizeof(T));
}

void attach(RTCDevice device, RTCScene scene, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const std::unique_ptr<RTCGeometryTy, decltype(&rtcReleaseGeometry)> owner(geometry,
                                                                            rtcReleaseGeometry);
  set_buffer(device, geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.positions);
  set_buffer(device, geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.triangles);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
}

RTCRay to_embree(const Ray& ray) {
  RTCRay result{};
  result.org_x = ray.origin.x, result.org_y = ray.origin.y, result.org_z = ray.origin.z;
  result.dir_x = ray.direction.x, result.dir_y = ray.direction.y, result.dir_z = ray.direction.z;
  result.tnear = ray.t_min, result.tfar = ray.t_max;
  result.mask = ~0U;
  return result;
}

/// Lane i takes rays[i]; lanes beyond the end repeat the last ray.
RayPacket gather(std::span<const Ray> rays) {
  RayPacket packet;
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const Ray& ray = rays[std::min(i, rays.size() - 1)];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      packet.origin[axis][i] = ray.origin[axis];
      packet.direction[axis][i] = ray.direction[axis];
    }
    packet.t_min[i] = ray.t_min;
    packet.t_max[i] = ray.t_max;
  }
  return packet;
}

void fill(RTCRay16& to, const RayPacket& from) {
  static_assert(sizeof(to.org_x) == sizeof(RayPacket::Lanes));
  constexpr std::size_t bytes = sizeof(RayPacket::Lanes);
  std::memcpy(to.org_x, from.origin[0].data(), bytes);
  std::memcpy(to.org_y, from.origin[1].data(), bytes);
  std::memcpy(to.org_z, from.origin[2].data(), bytes);
  std::memcpy(to.dir_x, from.direction[0].data(), bytes);
  std::memcpy(to.dir_y, from.direction[1].data(), bytes);
  std::memcpy(to.dir_z, from.direction[2].data(), bytes);
  std::memcpy(to.tnear, from.t_min.data(), bytes);
  std::memcpy(to.tfar, from.t_max.data(), bytes);
  std::fill_n(to.time, RayPacket::kSize, 0.0F);
  std::fill_n(to.mask, RayPacket::kSize, ~0U);
  std::fill_n(to.id, RayPacket::kSize, 0U);
  std::fill_n(to.flags, RayPacket::kSize, 0U);
}

/// Embree leaves primID alone on a miss, so it is what tells a hit: there is one geometry.
void read_hits(const RTCRayHit16& from, HitPacket& hits) {
  constexpr std::size_t bytes = sizeof(RayPacket::Lanes);
  std::memcpy(hits.triangle.data(), from.hit.primID, bytes);
  std::memcpy(hits.t.data(), from.ray.tfar, bytes);
  std::memcpy(hits.u.data(), from.hit.u, bytes);
  std::memcpy(hits.v.data(), from.hit.v, bytes);
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const float along = from.ray.dir_x[i] * from.hit.Ng_x[i] +
                        from.ray.dir_y[i] * from.hit.Ng_y[i] + from.ray.dir_z[i] * from.hit.Ng_z[i];
    hits.back[i] = along > 0 ? 1 : 0;
  }
}

struct alignas(64) Valid {
  std::array<int, RayPacket::kSize> lanes{};
  explicit Valid(std::size_t active) {
    std::fill_n(lanes.begin(), std::min(active, RayPacket::kSize), -1);
  }
};

class EmbreeTracer final : public RayTracer {
 public:
  explicit EmbreeTracer(const TriangleMesh& mesh) {
    RTCDevice device = Device::get();
    const std::int64_t before = embree_bytes;
    scene_.reset(rtcNewScene(device));
    if (scene_ == nullptr) check(device);
    rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    if (!mesh.triangles.empty()) attach(device, scene_.get(), mesh);
    rtcCommitScene(scene_.get());
    check(device);
    bytes_ = static_cast<std::size_t>(std::max<std::int64_t>(0, embree_bytes - before));
  }

  [[nodiscard]] Hit closest(const Ray& ray) const override;
  [[nodiscard]] bool occluded(const Ray& ray) const override;
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const override;
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const override;
  void closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const override;
  [[nodiscard]] std::size_t bytes() const override { return bytes_; }

 private:
  struct Release {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCSceneTy, Release> scene_;
  std::size_t bytes_ = 0;
};

Hit EmbreeTracer::closest(const Ray& ray) const {
  RTCRayHit query{};
  query.ray = to_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::intersect_one(scene_.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const Vec3f normal{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
  return {query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v,
          dot(ray.direction, normal) > 0};
}

bool EmbreeTracer::occluded(const Ray& ray) const {
  RTCRay query = to_embree(ray);
  embree::occluded_one(scene_.get(), query);
  return query.tfar < 0;  // Embree sets it to minus infinity on a hit
}

void EmbreeTracer::closest(const RayPacket& rays, HitPacket& hits, std::size_t active) const {
  const Valid valid(active);
  RTCRayHit16 query;
  fill(query.ray, rays);
  std::fill_n(query.hit.primID, RayPacket::kSize, kNone);
  std::fill_n(query.hit.geomID, RayPacket::kSize, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(query.hit.instID[0], RayPacket::kSize, RTC_INVALID_GEOMETRY_ID);
  std::memset(query.hit.Ng_x, 0, 5 * sizeof(query.hit.Ng_x));  // and Ng_y, Ng_z, u, v behind it
  embree::intersect_sixteen(valid.lanes.data(), scene_.get(), query);
  read_hits(query, hits);
}

void EmbreeTracer::closest(std::span<const Ray> rays, std::span<Hit> hits) const {
  HitPacket found;
  for (std::size_t first = 0; first < rays.size(); first += RayPacket::kSize) {
    const std::size_t active = std::min(RayPacket::kSize, rays.size() - first);
    closest(gather(rays.subspan(first, active)), found, active);
    for (std::size_t i = 0; i < active; ++i) {
      hits[first + i] = found.triangle[i] == kNone ? Hit{}
                                                   : Hit{found.triangle[i], found.t[i], found.u[i],
                                                         found.v[i], found.back[i] != 0};
    }
  }
}

void EmbreeTracer::occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
  RTCRay16 query;
  for (std::size_t first = 0; first < rays.size(); first += RayPacket::kSize) {
    const std::size_t active = std::min(RayPacket::kSize, rays.size() - first);
    const Valid valid(active);
    fill(query, gather(rays.subspan(first, active)));
    embree::occluded_sixteen(valid.lanes.data(), scene_.get(), query);
    for (std::size_t i = 0; i < active; ++i) blocked[first + i] = query.tfar[i] < 0 ? 1 : 0;
  }
}

}  // namespace

std::unique_ptr<const RayTracer> make_embree_tracer(const TriangleMesh& mesh) {
  if (mesh.triangles.size() >= kNone) throw ValueError("the mesh has 2^32 triangles or more");
  check_positions(mesh);
  return std::make_unique<EmbreeTracer>(mesh);
}

RayScene::RayScene(const TriangleMesh& mesh)
    : RayScene(make_embree_tracer(mesh), ray_epsilon(mesh)) {}

const char* RayScene::implementation() { return "Embree " RTC_VERSION_STRING; }

}  // namespace relumbre
