#include "relumbre/render/discrete_choice.h"

#include <algorithm>
#include <cassert>

namespace relumbre {

DiscreteChoice::DiscreteChoice(std::span<const float> weights) {
  cumulative_.reserve(weights.size() + 1);
  for (const float w : weights) cumulative_.push_back(cumulative_.back() + static_cast<double>(w));
}

DiscreteChoice::Chosen DiscreteChoice::choose(float u) const {
  assert(total() > 0);
  const double target = static_cast<double>(u) * total();
  // The first sum above the target ends the chosen interval: it is longer than 0. u < 1, but
  // u · total() may round to total(); the last interval longer than 0 is then the one.
  auto end = std::upper_bound(cumulative_.begin() + 1, cumulative_.end(), target);
  if (end == cumulative_.end()) {
    end = std::lower_bound(cumulative_.begin() + 1, cumulative_.end(), total());
  }
  const double lower = *(end - 1), width = *end - lower;
  const auto rest = static_cast<float>((target - lower) / width);
  return {static_cast<std::size_t>(end - cumulative_.begin()) - 1,
          std::clamp(rest, 0.0F, kBelowOne)};
}

}  // namespace relumbre
