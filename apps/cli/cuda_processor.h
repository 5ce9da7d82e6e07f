/// The program's only way to CUDA. apps/cuda implements it, or apps/no_cuda where Relumbre is built
/// without.
#pragma once

#include <memory>
#include <string>

#include "cli/processor.h"

namespace relumbre::cli {

/// As make_processor(), of "cuda" or "cuda:N".
std::unique_ptr<Processor> make_cuda_processor(const std::string& device);

void report_cuda_devices(Session& session);

}  // namespace relumbre::cli
