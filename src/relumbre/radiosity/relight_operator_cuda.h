/// The relight operator of a baked scene, on a GPU.
#pragma once

#include <memory>

#include "relumbre/radiosity/relight_operator.h"

namespace relumbre::cuda {

/// relumbre::make_compressed_operator() on device number `device`: U, V and M are there, M is made
/// here by LU in float64. Beside the device's memory (DeviceRelight::device_bytes()) it keeps a
/// table of the counts on the host, from which set_reflectance() makes M anew. Results are within
/// 1e-5 of the CPU's largest B, not the same bits. Throws also what DeviceRelight's constructor
/// throws.
std::unique_ptr<EditableOperator> make_compressed_operator(const OperatorInput& input,
                                                           CountFormat format, int device);

}  // namespace relumbre::cuda
