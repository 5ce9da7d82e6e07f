#include "relumbre/base/progress.h"

#include "relumbre/base/error.h"

namespace relumbre {

void Progress::begin(std::string_view, std::uint64_t) {}
void Progress::advance(std::uint64_t) {}
bool Progress::cancelled() const { return false; }

void Progress::check() const {
  if (cancelled()) throw Cancelled("interrupted");
}

Progress& no_progress() {
  static Progress none;
  return none;
}

}  // namespace relumbre
