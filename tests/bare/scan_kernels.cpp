// scan/kernels.h and scan/stream_writer.h in plain loops, for machines without Highway.
#include <cstring>

#include "relumbre/scan/kernels.h"
#include "relumbre/scan/stream_writer.h"

namespace relumbre {

namespace {

template <class In, class M, class Out>
struct Plain {
  using Carry = typename M::value_type;
  static constexpr M kOp{};

  static Carry fold(const In* in, std::size_t count, Carry local) {
    for (std::size_t i = 0; i < count; ++i) local = kOp(local, static_cast<Carry>(in[i]));
    return local;
  }
  static Carry quick_fold(const In* in, std::size_t count) {
    return fold(in, count, kOp.identity());
  }
  static Carry inclusive(const In* in, std::size_t count, Out* out, Carry prefix, Carry local) {
    for (std::size_t i = 0; i < count; ++i) {
      local = kOp(local, static_cast<Carry>(in[i]));
      out[i] = static_cast<Out>(kOp(prefix, local));
    }
    return local;
  }
  static Carry exclusive(const In* in, std::size_t count, Out* out, Carry prefix, Carry local) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = static_cast<Carry>(in[i]);
      out[i] = static_cast<Out>(kOp(prefix, local));
      local = kOp(local, value);
    }
    return local;
  }
  static ScanKernel<In, Carry, Out> kernel() { return {fold, quick_fold, inclusive, exclusive}; }
};

template <class T>
using Sum = Plain<T, Plus<T>, T>;
template <class T>
using Least = Plain<T, Min<T>, T>;
template <class T>
using Greatest = Plain<T, Max<T>, T>;
using std::int32_t, std::int64_t, std::uint32_t, std::uint64_t;

}  // namespace

const ScanKernels& best_scan_kernels() {
  static const ScanKernels kernels{"plain",
                                   Plain<float, Plus<double>, float>::kernel(),
                                   Plain<float, Plus<double>, float>::kernel(),
                                   Plain<float, Plus<double>, double>::kernel(),
                                   Sum<double>::kernel(),
                                   Sum<int32_t>::kernel(),
                                   Sum<uint32_t>::kernel(),
                                   Sum<int64_t>::kernel(),
                                   Sum<uint64_t>::kernel(),
                                   Least<float>::kernel(),
                                   Greatest<float>::kernel(),
                                   Least<double>::kernel(),
                                   Greatest<double>::kernel(),
                                   Least<int32_t>::kernel(),
                                   Greatest<int32_t>::kernel(),
                                   Least<uint32_t>::kernel(),
                                   Greatest<uint32_t>::kernel()};
  return kernels;
}

void stream_lines(const std::byte* from, std::size_t lines, std::byte* to) {
  std::memcpy(to, from, 64 * lines);
}
void end_streaming() {}
bool outgrows_cache(std::size_t) { return false; }

}  // namespace relumbre
