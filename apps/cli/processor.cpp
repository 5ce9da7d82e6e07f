#include "cli/processor.h"

#include <thread>

#include "cli/cuda_processor.h"
#include "relumbre/base/error.h"

namespace relumbre::cli {

void add_device_option(CLI::App& command, std::string& device) {
  device = "cpu";
  command.add_option("--device", device, "cpu, or a GPU: cuda, cuda:1 (see info --devices)")
      ->capture_default_str();
}

std::unique_ptr<Processor> make_processor(const std::string& device, Session& session) {
  if (device == "cpu") return std::make_unique<Processor>();
  if (device != "cuda" && !device.starts_with("cuda:"))
    throw ValueError("--device " + device + ": not cpu, cuda or cuda:N");
  std::unique_ptr<Processor> processor = make_cuda_processor(device);
  session.report.figure("device", "device", processor->name());
  return processor;
}

void report_devices(Session& session) {
  session.report.section("devices", "Devices");
  const unsigned threads = std::thread::hardware_concurrency();
  session.report.figure("cpu_threads", "cpu", threads, fmt::format("{} threads", threads));
  report_cuda_devices(session);
}

}  // namespace relumbre::cli
