/// The scans of one run of elements by one thread, left to right. Host and device.
///
/// `load(i)` gives element i as a value of the monoid, `store(i, value)` takes a result; i goes
/// over [first, last). An element is loaded before its result is stored, so both may be one array.
/// Every function starts from `value` and returns the fold of it and all elements.
#pragma once

#include <cstddef>
#include <utility>

#include "relumbre/base/host_device.h"
#include "relumbre/scan/monoid.h"

namespace relumbre::sequential {

template <Monoid M, class Value = typename M::value_type, class Load>
RELUMBRE_HOST_DEVICE Value fold(std::size_t first, std::size_t last, Value value, const M& m,
                                const Load& load) {
  for (std::size_t i = first; i < last; ++i) value = m(value, load(i));
  return value;
}

template <Monoid M, class Value = typename M::value_type, class Load, class Store>
RELUMBRE_HOST_DEVICE Value inclusive(std::size_t first, std::size_t last, Value value, const M& m,
                                     const Load& load, const Store& store) {
  for (std::size_t i = first; i < last; ++i) {
    value = m(value, load(i));
    store(i, value);
  }
  return value;
}

template <Monoid M, class Value = typename M::value_type, class Load, class Store>
RELUMBRE_HOST_DEVICE Value exclusive(std::size_t first, std::size_t last, Value value, const M& m,
                                     const Load& load, const Store& store) {
  for (std::size_t i = first; i < last; ++i) {
    Value next = m(value, load(i));
    store(i, value);
    value = std::move(next);
  }
  return value;
}

}  // namespace relumbre::sequential
