/// Scans by the vector kernels: of arrays that stay in the caches, and of arrays that outgrow them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include "relumbre/scan/chained.h"
#include "relumbre/scan/kernels.h"
#include "relumbre/scan/monoid.h"
#include "relumbre/scan/scan_kind.h"
#include "relumbre/scan/stream_writer.h"

namespace relumbre {

namespace scan_detail {

/// Tiles fit the second-level cache beside what else is there.
inline constexpr std::size_t kTileBytes = std::size_t{64} << 10;

/// A whole number of granules.
template <class In>
inline constexpr std::size_t kTile =
    std::max<std::size_t>(kTileBytes / sizeof(In) / kRunGranule, 1) * kRunGranule;

/// Where a tile takes a microsecond, threads meet at shorter ones.
template <class In>
inline constexpr std::size_t kKernelTile = kTile<In> / 4;

/// What both kinds of work share: the kernel and its arrays.
template <ScanKind kKind, class In, class M, class Out>
class KernelWork {
 public:
  static constexpr std::size_t kWorthThreads = 16, kGroup = 4;
  static constexpr auto kMember = kKernel<In, M, Out>;
  using Kernel = std::remove_cvref_t<decltype(std::declval<ScanKernels>().*kMember)>;
  using Value = typename Kernel::carry_type;
  using Combine =
      std::conditional_t<std::is_same_v<M, Plus<typename M::value_type>>, Plus<Value>, M>;

  KernelWork(std::span<const In> in, std::span<Out> out)
      : kernel_(best_scan_kernels().*kMember), in_(in), out_(out) {}

  [[nodiscard]] Value identity() const { return Combine().identity(); }
  [[nodiscard]] Value combine(Value a, Value b) const { return Combine()(a, b); }

 protected:
  Value run(std::size_t first, std::size_t last, Out* to, Value prefix, Value local) const {
    const auto scan = kKind == ScanKind::kInclusive ? kernel_.inclusive : kernel_.exclusive;
    return scan(in_.data() + first, last - first, to, prefix, local);
  }

  const Kernel& kernel_;
  std::span<const In> in_;
  std::span<Out> out_;
};

/// In the caches time is computation: a scan's own result spares the fold.
template <ScanKind kKind, class In, class M, class Out>
class CachedWork : public KernelWork<kKind, In, M, Out> {
 public:
  using Base = KernelWork<kKind, In, M, Out>;
  using Value = typename Base::Value;
  static constexpr bool kOnePass = true;
  using Base::Base;

  [[nodiscard]] Value fold(std::size_t first, std::size_t last) const {
    return this->kernel_.fold(this->in_.data() + first, last - first, this->identity());
  }
  Value scan(std::size_t first, std::size_t last, Value prefix) const {
    Out* to = this->out_.data() + first;
    return this->combine(prefix, this->run(first, last, to, prefix, this->identity()));
  }
};

/// Beyond them time is memory's: every tile is folded, in the quickest order, as it comes in, then
/// scanned while the next ones are fetched, and written past the caches.
template <ScanKind kKind, class In, class M, class Out>
class StreamedWork : public KernelWork<kKind, In, M, Out> {
 public:
  using Base = KernelWork<kKind, In, M, Out>;
  using Value = typename Base::Value;
  static constexpr bool kOnePass = false;
  using Base::Base;

  [[nodiscard]] Value fold(std::size_t first, std::size_t last) const {
    return this->kernel_.quick_fold(this->in_.data() + first, last - first);
  }
  Value scan(std::size_t first, std::size_t last, Value prefix) const {
    return scan(first, last, prefix, this->in_.size());
  }
  Value scan(std::size_t first, std::size_t last, Value prefix, std::size_t ahead) const {
    return this->combine(prefix, in_place() ? scan_in_place(first, last, prefix, ahead)
                                            : stream(first, last, prefix, ahead));
  }
  void end_thread() const { end_streaming(); }

 private:
  static constexpr std::size_t kRun = StreamWriter<Out>::kRun;

  [[nodiscard]] bool in_place() const {
    return static_cast<const void*>(this->in_.data()) ==
           static_cast<const void*>(this->out_.data());
  }
  Value scan_in_place(std::size_t first, std::size_t last, Value prefix, std::size_t ahead) const {
    Value local = this->identity();
    for (std::size_t i = first; i < last; i += kRun, ahead += kRun) {
      fetch(ahead);
      local = this->run(i, std::min(i + kRun, last), this->out_.data() + i, prefix, local);
    }
    return local;
  }
  Value stream(std::size_t first, std::size_t last, Value prefix, std::size_t ahead) const {
    StreamWriter<Out> writer(this->out_.data() + first);
    Value local = this->identity();
    for (std::size_t i = first; i < last; i += kRun, ahead += kRun) {
      const std::size_t end = std::min(i + kRun, last);
      fetch(ahead);
      local = this->run(i, end, writer.buffer(), prefix, local);
      writer.commit(end - i);
    }
    writer.finish();
    return local;
  }
  /// Asks for the run at `first`.
  [[gnu::always_inline]] void fetch(std::size_t first) const {
    constexpr std::size_t kLine = 64 / sizeof(In);
    const std::size_t last = std::min(this->in_.size(), first + kRun);
    for (std::size_t i = first; i < last; i += kLine)
      __builtin_prefetch(this->in_.data() + i, 0, 2);
  }
};

template <ScanKind kKind, class In, class M, class Out>
auto scan_by_kernel(std::span<const In> in, std::span<Out> out) {
  const bool in_place = static_cast<const void*>(in.data()) == static_cast<const void*>(out.data());
  const chained::Tiles tiles{in.size(), kKernelTile<In>};
  if (outgrows_cache(in.size_bytes() + (in_place ? 0 : out.size_bytes()))) {
    StreamedWork<kKind, In, M, Out> work(in, out);
    return chained::scan_tiles(tiles, false, work);
  }
  CachedWork<kKind, In, M, Out> work(in, out);
  return chained::scan_tiles(tiles, !in_place, work);
}

}  // namespace scan_detail
}  // namespace relumbre
