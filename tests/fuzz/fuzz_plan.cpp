// Feeds arbitrary text to the reader of experiment plans: it must return a plan whose cells can be
// listed, or throw an Error of one line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "relumbre/base/error.h"
#include "relumbre/experiment/plan.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    // A folder that does not exist: the meshes that plans name must not be found.
    const auto plan = relumbre::parse_plan(text, "fuzz.toml", "/nonexistent/folder");
    const std::size_t cells = relumbre::cell_count(plan);
    if (cells == 0 || relumbre::cell_at(plan, cells - 1).scene + 1 != plan.scenes.size())
      std::abort();
    if (relumbre::canonical_text(plan).empty()) std::abort();
  } catch (const relumbre::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
