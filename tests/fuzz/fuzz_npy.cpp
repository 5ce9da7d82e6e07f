// Feeds arbitrary bytes to the .npy reader: it must return an array or throw an Error.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "relumbre/base/error.h"
#include "relumbre/base/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    (void)relumbre::parse_npy({reinterpret_cast<const char*>(data), size}, "fuzz.npy");
  } catch (const relumbre::Error&) {
  }
  return 0;
}
