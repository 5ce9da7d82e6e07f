#include "relumbre/scan/stream_writer.h"

#include <unistd.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/scan/stream_writer.cpp"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on
#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A line in one store, where the vectors are long enough, leaves the most time for scanning.
void stream_bytes(const std::uint8_t* from, std::size_t bytes, std::uint8_t* to) {
  const hn::CappedTag<std::uint8_t, 64> d;
  for (std::size_t i = 0; i < bytes; i += hn::Lanes(d))
    hn::Stream(hn::LoadU(d, from + i), d, to + i);
}

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumbre {

namespace {

std::size_t last_level_cache() {
#ifdef _SC_LEVEL3_CACHE_SIZE
  const long bytes = sysconf(_SC_LEVEL3_CACHE_SIZE);
  if (bytes > 0) return static_cast<std::size_t>(bytes);
#endif
  return std::size_t{32} << 20;
}

}  // namespace

HWY_EXPORT(stream_bytes);

void stream_lines(const std::byte* from, std::size_t lines, std::byte* to) {
  HWY_DYNAMIC_DISPATCH(stream_bytes)
  (reinterpret_cast<const std::uint8_t*>(from), 64 * lines, reinterpret_cast<std::uint8_t*>(to));
}

void end_streaming() { hwy::FlushStream(); }

bool outgrows_cache(std::size_t bytes) {
  static const std::size_t cache = last_level_cache();
  return bytes > cache;
}

}  // namespace relumbre
#endif  // HWY_ONCE
