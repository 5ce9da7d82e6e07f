// Scans of 2^28 elements and fewer: ours, cub::DeviceScan's (told sizes as ints, its fastest way),
// and a copy on the device of as many bytes. Inputs are random and positive; all outputs are
// compared with each other before any time is taken.
#include <cstdint>
#include <random>
#include <type_traits>

#include <cub/device/device_scan.cuh>
#include <cuda/std/functional>

#include "bench.cuh"
#include "relumbre/scan/scan_cuda.cuh"
#include "relumbre/scan/segmented_cuda.cuh"

namespace relumbre::bench {
namespace {

using cuda::DeviceArray;
using cuda::Stream;

constexpr std::size_t kLargest = std::size_t{1} << 28;

/// Integers of 0 to 255, which also floats sum exactly up to 2^24.
template <class T>
DeviceArray<T> random_input(std::size_t size, const Stream& stream) {
  std::mt19937 random(1);
  std::vector<T> values(size);
  for (T& v : values) v = static_cast<T>(random() >> 24);
  return cuda::to_device(std::span<const T>(values), stream);
}

/// What CUB needs besides, made for one call with these arguments.
class CubMemory {
 public:
  template <class Call>
  explicit CubMemory(const Call& call) {
    std::size_t bytes = 0;
    cuda::check(call(nullptr, bytes));
    memory_ = DeviceArray<std::byte>(bytes);
  }
  template <class Call>
  void run(const Call& call) const {
    std::size_t bytes = memory_.size();
    cuda::check(call(memory_.data(), bytes));
  }

 private:
  DeviceArray<std::byte> memory_;
};

template <class T>
void expect_alike(const DeviceArray<T>& a, const DeviceArray<T>& b, std::size_t size,
                  const Stream& stream) {
  std::vector<T> x(size), y(size);
  cuda::copy_to_host(a.data(), x, stream);
  cuda::copy_to_host(b.data(), y, stream);
  stream.wait();
  for (std::size_t i = 0; i < size; ++i) {
    const double p = static_cast<double>(x[i]), q = static_cast<double>(y[i]);
    const double allowed = std::is_floating_point_v<T> ? 1e-4 * p : 0;
    if (!(std::abs(p - q) <= allowed))
      throw Error("element " + std::to_string(i) + " is " + std::to_string(p) + ", CUB's " +
                  std::to_string(q));
  }
}

/// Ours and CUB's write to arrays of their own; `copy` moves as many bytes.
template <class In, class Out>
Row compare(const char* name, std::size_t size, const Work& ours, const Work& cubs,
            const DeviceArray<Out>& our_out, const DeviceArray<Out>& cub_out,
            const Stream& stream) {
  ours(stream), cubs(stream);
  expect_alike(our_out, cub_out, size, stream);
  const double bytes = static_cast<double>(size * (sizeof(In) + sizeof(Out)));
  const DeviceCopy copy(size * (sizeof(In) + sizeof(Out)) / 2);
  const std::vector<Work> candidates = {ours, cubs, copy};
  const auto seconds = median_seconds(candidates, stream);
  Row row{name, seconds[0], bytes, "cub::DeviceScan", seconds[1], "copy on the device", seconds[2]};
  print(row);
  return row;
}

template <class In, class Out, class M>
Row inclusive(const char* name, std::size_t size, const M& m, const Stream& stream) {
  const auto in = random_input<In>(size, stream);
  DeviceArray<Out> our_out(size), cub_out(size);
  cuda::ScanScratch scratch;
  const auto call = [&](void* memory, std::size_t& bytes) {
    return cub::DeviceScan::InclusiveScan(memory, bytes, in.data(), cub_out.data(), m,
                                          static_cast<int>(size), stream.get());
  };
  const CubMemory cub_memory(call);
  const Work ours = [&](const Stream& s) {
    cuda::inclusive_scan(in.data(), size, our_out.data(), scratch, s, m);
  };
  const Work cubs = [&](const Stream&) { cub_memory.run(call); };
  return compare<In>(name, size, ours, cubs, our_out, cub_out, stream);
}

template <class In, class Out, class M>
Row exclusive(const char* name, std::size_t size, const M& m, const Stream& stream) {
  const auto in = random_input<In>(size, stream);
  DeviceArray<Out> our_out(size), cub_out(size);
  cuda::ScanScratch scratch;
  const auto call = [&](void* memory, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveScan(memory, bytes, in.data(), cub_out.data(), m, m.identity(),
                                          static_cast<int>(size), stream.get());
  };
  const CubMemory cub_memory(call);
  const Work ours = [&](const Stream& s) {
    cuda::exclusive_scan(in.data(), size, our_out.data(), scratch, s, m);
  };
  const Work cubs = [&](const Stream&) { cub_memory.run(call); };
  return compare<In>(name, size, ours, cubs, our_out, cub_out, stream);
}

/// Keys of which about one in 100 differs from the one before it.
Row by_key(const char* name, std::size_t size, const Stream& stream) {
  const auto in = random_input<float>(size, stream);
  std::vector<std::uint32_t> values(size);
  std::mt19937 random(2);
  std::uint32_t key = 0;
  for (auto& v : values) v = key += random() % 100 == 0 ? 1 : 0;
  const auto keys = cuda::to_device(std::span<const std::uint32_t>(values), stream);
  DeviceArray<float> our_out(size), cub_out(size);
  cuda::ScanScratch scratch;
  const auto call = [&](void* memory, std::size_t& bytes) {
    return cub::DeviceScan::InclusiveScanByKey(
        memory, bytes, keys.data(), in.data(), cub_out.data(), Plus<float>{},
        static_cast<int>(size), ::cuda::std::equal_to<>{}, stream.get());
  };
  const CubMemory cub_memory(call);
  const Work ours = [&](const Stream& s) {
    cuda::scan_by_key(keys.data(), in.data(), size, our_out.data(), scratch, s);
  };
  const Work cubs = [&](const Stream&) { cub_memory.run(call); };
  struct KeyAndValue {
    std::uint32_t key;
    float value;
  };
  return compare<KeyAndValue>(name, size, ours, cubs, our_out, cub_out, stream);
}

void run() {
  const Stream stream;
  print_heading("scan");
  const Row row = inclusive<float, float>("float32, sum, 2^28", kLargest, Plus<float>{}, stream);
  inclusive<float, float>("float32, maximum, 2^28", kLargest, Max<float>{}, stream);
  inclusive<std::uint32_t, std::uint32_t>("uint32, sum, 2^28", kLargest, Plus<std::uint32_t>{},
                                          stream);
  exclusive<std::uint32_t, std::uint32_t>("uint32, exclusive sum, 2^28", kLargest,
                                          Plus<std::uint32_t>{}, stream);
  exclusive<std::uint8_t, std::uint32_t>("uint8 into uint32, exclusive sum, 2^28", kLargest,
                                         Plus<std::uint32_t>{}, stream);
  inclusive<double, double>("float64, sum, 2^27", kLargest / 2, Plus<double>{}, stream);
  inclusive<float, float>("float32, sum, 2^24", kLargest >> 4, Plus<float>{}, stream);
  inclusive<float, float>("float32, sum, 2^20", kLargest >> 8, Plus<float>{}, stream);
  by_key("float32, sum by key, 2^27", kLargest / 2, stream);
  print_figure("scan_float32_against_cub", row.speed_of_peer(), 0.95, "x");
  print_figure("scan_float32_against_copy", row.fraction_of_limit(), 0.90, "x");
}

}  // namespace
}  // namespace relumbre::bench

int main() { return relumbre::bench::run_benchmark(relumbre::bench::run); }
