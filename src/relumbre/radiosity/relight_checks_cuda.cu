#include <string>

#include "relumbre/base/error.h"
#include "relumbre/radiosity/operator_input.h"
#include "relumbre/radiosity/relight_checks_cuda.h"

namespace relumbre::cuda {

void check_parts(const RelightParts& parts) {
  check_operator_input({parts.counts, parts.patch_offsets, parts.weight, parts.reflectance});
  const std::size_t n = parts.counts.rows(), k = parts.counts.columns;
  check_transport(parts.transport, k);
  if (n > (std::size_t{1} << 31)) throw ValueError(std::to_string(n) + " elements exceed 2^31");
  if (parts.patch_offsets.front() != 0 || parts.patch_offsets.back() != n)
    throw ShapeError("patch offsets must go from 0 to " + std::to_string(n));
  for (std::size_t p = 0; p < k; ++p)
    if (parts.patch_offsets[p] > parts.patch_offsets[p + 1])
      throw ShapeError("patch offsets descend at patch " + std::to_string(p));
}

void check_transport(const std::array<std::span<const double>, 3>& transport, std::size_t patches) {
  for (const auto& channel : transport)
    if (channel.size() != patches * patches)
      throw ShapeError("the exchange between patches has " + std::to_string(channel.size()) +
                       " values, not " + std::to_string(patches) + " x " + std::to_string(patches));
}

}  // namespace relumbre::cuda
