// Feeds arbitrary bytes to the EXR, PNG and JPEG readers: an image or an Error must come of it.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "relumbre/base/error.h"
#include "relumbre/image/exr.h"
#include "relumbre/image/raster.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    if (relumbre::is_exr(bytes)) {
      (void)relumbre::parse_exr(bytes, "fuzz.exr");
    } else {
      (void)relumbre::decode_image(bytes, "fuzz.png");
    }
  } catch (const relumbre::Error&) {
  }
  return 0;
}
