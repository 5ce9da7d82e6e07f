/// Internal: the few calls in which Embree 3 and Embree 4 differ, under one name each.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relumbre::embree {

#if RTC_VERSION_MAJOR >= 4

inline void intersect_one(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, nullptr); }

inline void occluded_one(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }

/// `valid` is -1 for each lane to trace and 0 for the others.
inline void intersect_sixteen(const int* valid, RTCScene scene, RTCRayHit16& rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &rays, &arguments);
}

inline void occluded_sixteen(const int* valid, RTCScene scene, RTCRay16& rays) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded16(valid, scene, &rays, &arguments);
}

#else

inline RTCIntersectContext context(RTCIntersectContextFlags flags) {
  RTCIntersectContext result;
  rtcInitIntersectContext(&result);
  result.flags = flags;
  return result;
}

inline void intersect_one(RTCScene scene, RTCRayHit& ray) {
  RTCIntersectContext incoherent = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect1(scene, &incoherent, &ray);
}

inline void occluded_one(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext incoherent = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcOccluded1(scene, &incoherent, &ray);
}

/// `valid` is -1 for each lane to trace and 0 for the others.
inline void intersect_sixteen(const int* valid, RTCScene scene, RTCRayHit16& rays) {
  RTCIntersectContext coherent = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcIntersect16(valid, scene, &coherent, &rays);
}

inline void occluded_sixteen(const int* valid, RTCScene scene, RTCRay16& rays) {
  RTCIntersectContext coherent = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcOccluded16(valid, scene, &coherent, &rays);
}

#endif

}  // namespace relumbre::embree
