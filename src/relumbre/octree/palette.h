/// A few colours for many.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace relumbre {

using Srgb8 = std::array<std::uint8_t, 3>;

/// Counts colours, then chooses some by median cut (Heckbert 1982) over 32 levels a channel.
class Palette {
 public:
  void count(const Srgb8& color);
  /// At most `size` colours; call once, when all are counted.
  void choose(std::size_t size);

  [[nodiscard]] const std::vector<Srgb8>& colors() const { return colors_; }
  /// Of a colour that was counted: its place in colors().
  [[nodiscard]] std::size_t index(const Srgb8& color) const { return index_[bin_of(color)]; }

 private:
  static constexpr std::size_t kBins = 32 * 32 * 32;
  struct Bin {
    std::uint64_t count = 0;
    std::array<std::uint64_t, 3> sum{};  // of the colours in it
  };
  /// Bins [first, last) of order_.
  struct Range {
    std::size_t first, last;
  };
  static std::size_t bin_of(const Srgb8& c) {
    return static_cast<std::size_t>(c[0] >> 3) << 10 | static_cast<std::size_t>(c[1] >> 3) << 5 |
           c[2] >> 3;
  }
  [[nodiscard]] unsigned longest_axis(const Range& range, unsigned& extent) const;
  [[nodiscard]] std::size_t split(const Range& range, unsigned axis);
  void add_color(const Range& range);

  std::vector<Bin> bins_ = std::vector<Bin>(kBins);
  std::vector<std::uint16_t> order_;  // bins that have colours
  std::vector<Srgb8> colors_;
  std::vector<std::uint16_t> index_ = std::vector<std::uint16_t>(kBins);
};

}  // namespace relumbre
