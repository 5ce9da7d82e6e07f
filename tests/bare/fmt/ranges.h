/// Stands in for {fmt}'s ranges.h: see format.h.
#pragma once

#include <ostream>
#include <string_view>

#include "fmt/format.h"

namespace fmt {

template <class Range>
struct Joined {
  const Range& range;
  std::string_view between;
  friend std::ostream& operator<<(std::ostream& to, const Joined& joined) {
    std::string_view before;
    for (const auto& item : joined.range) {
      to << before << item;
      before = joined.between;
    }
    return to;
  }
};

template <class Range>
Joined<Range> join(const Range& range, std::string_view between) {
  return {range, between};
}

}  // namespace fmt
