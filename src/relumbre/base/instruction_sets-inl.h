// Highway's run-time dispatch, for every instruction set in turn.

#pragma once

#include <cstdint>
#include <vector>

#include <hwy/highway.h>

namespace relumbre {

/// What `dispatched()`, which calls by HWY_DYNAMIC_DISPATCH, returns on each instruction set that
/// this CPU has, best first. For tests: not thread-safe.
template <class Dispatched>
auto on_every_instruction_set(const Dispatched& dispatched) {
  const auto dispatch_anew = [] { hwy::GetChosenTarget().Update(hwy::SupportedTargets()); };
  std::vector<decltype(dispatched())> all;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    dispatch_anew();
    all.push_back(dispatched());
  }
  hwy::SetSupportedTargetsForTest(0);
  dispatch_anew();
  return all;
}

}  // namespace relumbre
