/// Scans that begin anew at every head of a segment.
///
/// As in scan.h; a segment's exclusive scan begins with the identity. The first element begins a
/// segment in any case. Both functions return the fold of the last segment (the identity if there
/// is none). Heads and keys must not overlap the output.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>

#include "relumbre/scan/scan.h"

namespace relumbre {

namespace scan_detail {

template <ScanKind kKind, class In, class Out, Monoid M, class IsHead>
typename M::value_type scan_segments(std::span<const In> in, std::span<Out> out,
                                     const IsHead& is_head, const M& m) {
  using Value = typename M::value_type;
  const Segmented<M> monoid{m};
  const auto load = [&](std::size_t i) {
    return Headed<Value>{is_head(i), static_cast<Value>(in[i])};
  };
  const auto store = [&](std::size_t i, const Headed<Value>& prefix) {
    const bool begins = kKind == ScanKind::kExclusive && is_head(i);
    out[i] = static_cast<Out>(begins ? m.identity() : prefix.value);
  };
  return scan_elements<kKind>(in.size(), kTile<In>, monoid, load, store).value;
}

template <class In, class Out, Monoid M, class IsHead>
typename M::value_type scan_segments(const char* function, std::span<const In> in,
                                     std::span<Out> out, const IsHead& is_head, const M& m,
                                     ScanKind kind) {
  check::same_size(function, "output", out.size(), in.size());
  check::in_place_or_disjoint(function, in, std::span<const Out>(out));
  return kind == ScanKind::kInclusive ? scan_segments<ScanKind::kInclusive>(in, out, is_head, m)
                                      : scan_segments<ScanKind::kExclusive>(in, out, is_head, m);
}

}  // namespace scan_detail

/// heads[i] ≠ 0: a segment begins at i.
template <Array In, Array Heads, Array Out,
          Monoid M = DefaultPlus<std::ranges::range_value_t<In>, std::ranges::range_value_t<Out>>>
requires std::integral<std::ranges::range_value_t<Heads>>
typename M::value_type segmented_scan(const In& in, const Heads& heads, Out&& out, const M& m = {},
                                      ScanKind kind = ScanKind::kInclusive) {
  const auto flags = scan_detail::input(heads);
  check::same_size("segmented_scan", "heads", flags.size(), std::ranges::size(in));
  check::disjoint("segmented_scan", flags, scan_detail::input(out));
  const auto is_head = [flags](std::size_t i) { return flags[i] != 0; };
  return scan_detail::scan_segments("segmented_scan", scan_detail::input(in),
                                    scan_detail::output(out), is_head, m, kind);
}

/// A segment begins wherever a key differs from the one before it.
template <Array Keys, Array In, Array Out,
          Monoid M = DefaultPlus<std::ranges::range_value_t<In>, std::ranges::range_value_t<Out>>>
requires std::equality_comparable<std::ranges::range_value_t<Keys>>
typename M::value_type scan_by_key(const Keys& keys, const In& in, Out&& out, const M& m = {},
                                   ScanKind kind = ScanKind::kInclusive) {
  const auto key = scan_detail::input(keys);
  check::same_size("scan_by_key", "keys", key.size(), std::ranges::size(in));
  check::disjoint("scan_by_key", key, scan_detail::input(out));
  const auto is_head = [key](std::size_t i) { return i == 0 || !(key[i] == key[i - 1]); };
  return scan_detail::scan_segments("scan_by_key", scan_detail::input(in), scan_detail::output(out),
                                    is_head, m, kind);
}

}  // namespace relumbre
