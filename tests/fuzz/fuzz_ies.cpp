// Feeds arbitrary text to the IES reader: a profile with values in [0, 1] or an Error must come of
// it.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "relumbre/base/error.h"
#include "relumbre/scene/ies.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const relumbre::IesProfile profile =
        relumbre::parse_ies({reinterpret_cast<const char*>(data), size}, "fuzz.ies");
    for (const relumbre::Vec3f& direction :
         {relumbre::Vec3f(0, 0, 1), relumbre::Vec3f(0.6F, 0.8F, 0),
          relumbre::Vec3f(0, -0.6F, -0.8F)}) {
      const float value = profile.relative(direction);
      if (!(value >= 0 && value <= 1)) std::abort();
    }
  } catch (const relumbre::Error&) {
  }
  return 0;
}
