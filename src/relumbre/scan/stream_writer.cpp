#include "relumbre/scan/stream_writer.h"

#include <cstring>

#include <unistd.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

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

#if defined(__SSE2__)

void stream_lines(const std::byte* from, std::size_t lines, std::byte* to) {
  const auto* source = reinterpret_cast<const __m128i*>(from);
  auto* target = reinterpret_cast<__m128i*>(to);
  for (std::size_t i = 0; i < 4 * lines; ++i)
    _mm_stream_si128(target + i, _mm_loadu_si128(source + i));
}

void end_streaming() { _mm_sfence(); }

#else

void stream_lines(const std::byte* from, std::size_t lines, std::byte* to) {
  std::memcpy(to, from, 64 * lines);
}

void end_streaming() {}

#endif

bool outgrows_cache(std::size_t bytes) {
  static const std::size_t cache = last_level_cache();
  return bytes > cache;
}

}  // namespace relumbre
