/// Parallel loops over index ranges, on oneTBB.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace relumbre {

/// Calls body(begin, end) on disjoint chunks that cover [begin, end), each at most `grain` long
/// (the last may be shorter), on all threads that ThreadLimit allows. Chunk boundaries depend only
/// on the range and the grain. An exception from the body is rethrown here.
void parallel_chunks(std::size_t begin, std::size_t end, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body);

/// Calls body(i) for every i in [begin, end).
template <class Body>
void parallel_for(std::size_t begin, std::size_t end, std::size_t grain, Body&& body) {
  parallel_chunks(begin, end, grain, [&body](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

/// Threads that parallel loops use now.
std::size_t thread_count();

/// While it lives, parallel loops use at most `threads` threads (0: all the machine has).
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads);
  ~ThreadLimit();
  ThreadLimit(ThreadLimit&&) noexcept;
  ThreadLimit& operator=(ThreadLimit&&) noexcept;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace relumbre
