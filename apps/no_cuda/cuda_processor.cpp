#include "cli/cuda_processor.h"

#include "relumbre/base/error.h"

namespace relumbre::cli {

std::unique_ptr<Processor> make_cuda_processor(const std::string& device) {
  throw ValueError("--device " + device +
                   ": this relumbre was built without CUDA (see docs/cuda.md); cpu is there");
}

void report_cuda_devices(Session& session) {
  session.report.figure("cuda", "cuda", nullptr, "not built in: see docs/cuda.md");
}

}  // namespace relumbre::cli
