/// A GPU that runs on the CPU: every thread of a grid is a fibre.
///
/// For tests. Threads run one at a time; which one goes on is drawn at random at every barrier,
/// every exchange within a warp and every yield, from a few blocks that are resident at once and
/// start in random order. So what depends on an order that a real GPU does not promise fails here
/// sooner or later. Memory is sequentially consistent: missing fences go unnoticed.
///
/// What is reported as a std::logic_error: threads that wait for ever, a barrier or an exchange
/// that a thread of the block or of the mask never reaches, a lane that is not in its own mask, a
/// barrier that threads of one block reach at different places.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <source_location>

struct uint3 {
  unsigned x = 0, y = 0, z = 0;
};

struct dim3 {
  unsigned x, y, z;
  constexpr dim3(unsigned x_ = 1, unsigned y_ = 1, unsigned z_ = 1) : x(x_), y(y_), z(z_) {}
};

namespace emulator {

using Site = std::source_location;

/// Runs a kernel to its end. One grid at a time, whoever asks.
void run_grid(dim3 grid, dim3 block, std::size_t shared_bytes, const std::function<void()>& kernel);

/// Whether the caller is a thread of a grid.
bool in_kernel();
/// Of the block that runs.
void* shared_memory();
void barrier(Site site);
/// Another thread's turn.
void yield();
unsigned lane();

/// Seeds the order of threads and blocks of the grids to come.
void set_seed(std::uint64_t seed);

/// What the lanes of a mask gave, 16 bytes each.
struct Exchange {
  std::array<std::array<std::byte, 16>, 32> values;
  unsigned mask = 0, arrived = 0, read = 0;
  Site site;
};

/// Waits for all lanes of the mask; `take` then sees what they gave.
void exchange(unsigned mask, const void* value, std::size_t bytes, Site site,
              const std::function<void(const Exchange&)>& take);

template <class T>
T value_of(const Exchange& all, unsigned lane) {
  T value;
  std::memcpy(&value, all.values[lane % 32].data(), sizeof(T));
  return value;
}

/// result(all) once all lanes of the mask have given their value.
template <class T, class Result>
auto exchange(unsigned mask, const T& value, Site site, Result&& result) {
  static_assert(sizeof(T) <= 16);
  decltype(result(std::declval<const Exchange&>())) answer{};
  exchange(mask, &value, sizeof(T), site, [&](const Exchange& all) { answer = result(all); });
  return answer;
}

}  // namespace emulator

inline uint3 threadIdx, blockIdx;
inline dim3 blockDim, gridDim;
inline constexpr int warpSize = 32;
