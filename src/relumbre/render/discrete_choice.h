/// Choosing one of many by weight with one uniform number, which stays uniform and stratified.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace relumbre {

/// The largest float below 1.
inline constexpr float kBelowOne = 0x1.fffffep-1F;

/// Chooses index i with probability weight[i] / total by inverting the cumulative sum.
class DiscreteChoice {
 public:
  struct Chosen {
    std::size_t index;
    float rest;  ///< the uniform number's place within that index, in [0, 1)
  };

  DiscreteChoice() = default;
  /// Weights must be finite and at least 0. All zero, or none at all, is fine if nothing is chosen.
  explicit DiscreteChoice(std::span<const float> weights);
  [[nodiscard]] double total() const { return cumulative_.back(); }
  /// `u` in [0, 1); total() must be above 0. Never an index of weight 0. O(log n).
  [[nodiscard]] Chosen choose(float u) const;

 private:
  std::vector<double> cumulative_{0.0};
};

}  // namespace relumbre
