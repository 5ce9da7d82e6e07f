/// The reader that a table on the CPU asks for.
#pragma once

#include <utility>
#include <variant>

#include "relumbre/sat/box_reader.h"
#include "relumbre/sat/summed_area_table.h"

namespace relumbre {

/// Calls use(reader) with the reader for the table's type.
template <class Use>
auto with_reader(const SummedAreaTable& table, Use&& use) {
  return std::visit(
      [&]<class T>(const HugeArray<T>& sums) {
        return use(BoxReader<T>(table.layout(), sums.data(), table.fixed_point(), table.mean()));
      },
      table.storage());
}

}  // namespace relumbre
