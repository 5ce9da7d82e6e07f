#include <charconv>

#include "relumbre/cuda/device.h"
#include "relumbre/cuda/error.h"

namespace relumbre::cuda {

namespace {

/// 0 where there is no driver, or no device.
int device_count() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaErrorNoDevice || status == cudaErrorInsufficientDriver) {
    cudaGetLastError();
    return 0;
  }
  check(status);
  return count;
}

DeviceInfo info_of(int index) {
  cudaDeviceProp properties{};
  check(cudaGetDeviceProperties(&properties, index));
  DeviceInfo info{.index = index,
                  .name = properties.name,
                  .major = properties.major,
                  .minor = properties.minor,
                  .multiprocessors = properties.multiProcessorCount,
                  .memory_bytes = properties.totalGlobalMem,
                  .l2_bytes = static_cast<std::size_t>(properties.l2CacheSize)};
  const UseDevice use(index);
  std::size_t total = 0;
  check(cudaMemGetInfo(&info.free_bytes, &total));
  return info;
}

std::string names_of(int count) {
  if (count == 0) return "this machine has none";
  return count == 1 ? "there is cuda:0" : "there are cuda:0 to cuda:" + std::to_string(count - 1);
}

}  // namespace

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> all;
  for (int i = 0; i < device_count(); ++i) all.push_back(info_of(i));
  return all;
}

Versions versions() {
  Versions v;
  check(cudaDriverGetVersion(&v.driver));
  check(cudaRuntimeGetVersion(&v.runtime));
  return v;
}

int parse_device(std::string_view name) {
  constexpr std::string_view kCuda = "cuda";
  int index = 0;
  if (name != kCuda) {
    const std::string_view digits =
        name.starts_with("cuda:") ? name.substr(kCuda.size() + 1) : std::string_view{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (digits.empty() || error != std::errc{} || end != digits.data() + digits.size() || index < 0)
      throw ValueError("device '" + std::string(name) + "': not cpu, cuda or cuda:N");
  }
  const int count = device_count();
  if (index >= count) throw ValueError("device '" + std::string(name) + "': " + names_of(count));
  return index;
}

UseDevice::UseDevice(int index) {
  check(cudaGetDevice(&before_));
  check(cudaSetDevice(index));
}
UseDevice::~UseDevice() { cudaSetDevice(before_); }

DeviceInfo current_device() {
  int index = 0;
  check(cudaGetDevice(&index));
  return info_of(index);
}

void expect_free(std::size_t bytes, std::string_view purpose) {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total));
  if (bytes <= free) return;
  throw OutOfDeviceMemory(std::string(purpose) + ": needs " + in_gigabytes(bytes) +
                          " on the device, " + in_gigabytes(free) + " of " + in_gigabytes(total) +
                          " are free");
}

}  // namespace relumbre::cuda
