#include "relumbre/radiosity/relight_operator.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "relumbre/base/error.h"

namespace relumbre {

void RelightOperator::apply(std::span<const float> emission, std::span<float> radiosity,
                            std::size_t sources) const {
  const std::size_t per_source = 3 * elements();
  const bool fits = sources == 0
                        ? emission.empty()
                        : emission.size() % sources == 0 && emission.size() / sources == per_source;
  if (!fits)
    throw ShapeError(fmt::format("emission has {} values, not {} sources x {} elements x 3",
                                 emission.size(), sources, elements()));
  if (radiosity.size() != emission.size())
    throw ShapeError(fmt::format("radiosity has {} values but emission has {}", radiosity.size(),
                                 emission.size()));
  if (sources > 0) apply_checked(emission, radiosity, sources);
}

std::string_view to_string(CountFormat format) {
  switch (format) {
    case CountFormat::kFloat32:
      return "float32";
    case CountFormat::kFloat16:
      return "float16";
    case CountFormat::kCounts16:
      return "counts16";
    case CountFormat::kCounts8:
      break;
  }
  return "counts8";
}

CountFormat smallest_format(const SparseCounts& counts) {
  constexpr std::uint64_t overflow_bytes = 12;  // row, column, excess
  std::uint64_t beyond_8 = 0, beyond_16 = 0;
  for (const std::uint32_t count : counts.count) {
    beyond_8 += count > std::numeric_limits<std::uint8_t>::max();
    beyond_16 += count > std::numeric_limits<std::uint16_t>::max();
  }
  // The table of 16 bits has one byte an entry more.
  const auto entries = static_cast<double>(counts.rows()) * static_cast<double>(counts.columns);
  const auto saved = static_cast<double>(overflow_bytes * (beyond_8 - beyond_16));
  return saved > entries ? CountFormat::kCounts16 : CountFormat::kCounts8;
}

}  // namespace relumbre
