#include "bare_embree.h"

#include <array>

namespace relumbre::bench {

namespace {

RTCRayHit query_of(const Ray& ray) {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
  query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y;
  query.ray.dir_z = ray.direction.z;
  query.ray.tfar = ray.t_max, query.ray.mask = ~0U;
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

/// Fills packets of 8 or 16 with consecutive rays.
template <class Packet>
void fill(Packet& query, std::span<const Ray> rays) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    query.ray.org_x[i] = rays[i].origin.x, query.ray.dir_x[i] = rays[i].direction.x;
    query.ray.org_y[i] = rays[i].origin.y, query.ray.dir_y[i] = rays[i].direction.y;
    query.ray.org_z[i] = rays[i].origin.z, query.ray.dir_z[i] = rays[i].direction.z;
    query.ray.tnear[i] = 0, query.ray.tfar[i] = rays[i].t_max, query.ray.time[i] = 0;
    query.ray.mask[i] = ~0U, query.ray.id[i] = 0, query.ray.flags[i] = 0;
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
}

template <int kRays>
struct Packet;
template <>
struct Packet<8> {
  using Query = RTCRayHit8;
  static constexpr auto intersect = rtcIntersect8;
};
template <>
struct Packet<16> {
  using Query = RTCRayHit16;
  static constexpr auto intersect = rtcIntersect16;
};

template <int kRays, bool coherent>
void by_packets(RTCScene scene, std::span<const Ray> rays) {
  alignas(64) std::array<int, kRays> valid;
  valid.fill(-1);
  typename Packet<kRays>::Query query;
  for (std::size_t i = 0; i < rays.size(); i += kRays) {
    fill(query, rays.subspan(i, kRays));
#if RTC_VERSION_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    Packet<kRays>::intersect(valid.data(), scene, &query, &arguments);
#else
    RTCIntersectContext context = embree::context(coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                           : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    Packet<kRays>::intersect(valid.data(), scene, &context, &query);
#endif
  }
}

#if RTC_VERSION_MAJOR < 4
/// Embree 3 only: a stream of all rays of an element.
void by_stream(RTCScene scene, std::span<const Ray> rays) {
  thread_local std::vector<RTCRayHit> queries;
  queries.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) queries[i] = query_of(rays[i]);
  RTCIntersectContext context = embree::context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcIntersect1M(scene, &context, queries.data(), static_cast<unsigned>(queries.size()),
                 sizeof(RTCRayHit));
}
#endif

}  // namespace

void one_by_one(RTCScene scene, std::span<const Ray> rays) {
  for (const Ray& ray : rays) {
    RTCRayHit query = query_of(ray);
    embree::intersect_one(scene, query);
  }
}

void by_sixteen(RTCScene scene, std::span<const Ray> rays) { by_packets<16, true>(scene, rays); }

void by_sixteen_incoherent(RTCScene scene, std::span<const Ray> rays) {
  by_packets<16, false>(scene, rays);
}

std::vector<NamedLoop> loops() {
  return {
    {"rtcIntersect1", one_by_one}, {"rtcIntersect8, incoherent", by_packets<8, false>},
        {"rtcIntersect8, coherent", by_packets<8, true>},
#if RTC_VERSION_MAJOR < 4
        {"rtcIntersect1M, coherent", by_stream},
#endif
    {
      "rtcIntersect16, coherent", by_sixteen
    }
  };
}

}  // namespace relumbre::bench
