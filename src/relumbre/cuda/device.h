/// The GPUs of this machine.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace relumbre::cuda {

struct DeviceInfo {
  int index = 0;
  std::string name;
  int major = 0, minor = 0;  ///< compute capability
  int multiprocessors = 0;
  std::size_t memory_bytes = 0, free_bytes = 0, l2_bytes = 0;
};

/// All of them; none where there is no driver. Throws DeviceError if a driver is there and fails.
std::vector<DeviceInfo> devices();

/// Version of the driver's CUDA and of the runtime, 1000 · major + 10 · minor; 0 without a driver.
struct Versions {
  int driver = 0, runtime = 0;
};
Versions versions();

/// "cuda" is device 0, "cuda:1" device 1. Throws ValueError for another name, or naming the devices
/// that there are if it is none of them.
int parse_device(std::string_view name);

/// Makes a device that of the calling thread for as long as this lives.
class UseDevice {
 public:
  explicit UseDevice(int index);
  ~UseDevice();
  UseDevice(const UseDevice&) = delete;
  UseDevice& operator=(const UseDevice&) = delete;

 private:
  int before_ = 0;
};

/// Of the calling thread's device.
DeviceInfo current_device();

/// Throws OutOfDeviceMemory if the device has not so many bytes free: "relight operator: needs 5.20
/// GB on the device, 3.10 GB of 4.00 GB are free". Call it before allocating much.
void expect_free(std::size_t bytes, std::string_view purpose);

}  // namespace relumbre::cuda
