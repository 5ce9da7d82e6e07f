/// Stands in for src/relumbre/cuda/launch.cuh: kernels run on the emulator.
#pragma once

#include <tuple>
#include <type_traits>

#include <cuda_runtime.h>

#include "relumbre/cuda/stream.h"

namespace relumbre::cuda {

struct Grid {
  dim3 blocks, threads;
  std::size_t shared_bytes = 0;
};

template <class... Parameters, class... Arguments>
void launch(void (*kernel)(Parameters...), const Grid& grid, const Stream& stream,
            Arguments&&... arguments) {
  if (grid.blocks.x == 0 || grid.blocks.y == 0 || grid.blocks.z == 0) return;
  std::tuple<std::decay_t<Parameters>...> values(static_cast<Parameters>(arguments)...);
  emulator::enqueue(stream.get(), [kernel, grid, values] {
    emulator::run_grid(grid.blocks, grid.threads, grid.shared_bytes,
                       [&] { std::apply(kernel, values); });
  });
}

template <class... Parameters>
int resident_blocks(void (*)(Parameters...), unsigned, std::size_t = 0) {
  return 4;
}

template <class T>
T& shared_as() {
  return *static_cast<T*>(emulator::shared_memory());
}

}  // namespace relumbre::cuda
