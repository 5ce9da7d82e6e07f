// The loops of parallel.h on std::thread: slower, but ThreadSanitizer sees how they synchronise,
// which it does not with oneTBB's uninstrumented library. The tsan preset uses it instead of
// parallel.cpp.

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

std::atomic<std::size_t> limit = 0;  // 0: all the machine has
thread_local bool inside_loop = false;

/// Runs chunks until none is left or one has thrown.
class Loop {
 public:
  Loop(std::size_t chunks, const std::function<void(std::size_t)>& chunk)
      : chunks_(chunks), chunk_(chunk) {}

  void work() {
    const bool outer = inside_loop;
    inside_loop = true;
    for (std::size_t c = next_++; c < chunks_ && !failed_; c = next_++) run(c);
    inside_loop = outer;
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void run(std::size_t c) {
    try {
      chunk_(c);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
  }

  std::size_t chunks_;
  const std::function<void(std::size_t)>& chunk_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

void parallel_chunks(std::size_t begin, std::size_t end, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (begin >= end) return;
  grain = std::clamp<std::size_t>(grain, 1, end - begin);
  const std::size_t chunks = (end - begin - 1) / grain + 1;
  const std::function<void(std::size_t)> chunk = [&](std::size_t c) {
    const std::size_t first = begin + c * grain;
    body(first, first + std::min(grain, end - first));
  };
  Loop loop(chunks, chunk);
  std::vector<std::thread> helpers;
  const std::size_t threads = inside_loop ? 1 : std::min(thread_count(), chunks);
  for (std::size_t t = 1; t < threads; ++t) helpers.emplace_back([&loop] { loop.work(); });
  loop.work();
  for (std::thread& helper : helpers) helper.join();
  loop.rethrow();
}

std::size_t thread_count() {
  const std::size_t set = limit;
  return set > 0 ? set : std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

struct ThreadLimit::Control {
  explicit Control(std::size_t threads) : before(limit.exchange(threads)) {}
  ~Control() { limit = before; }
  std::size_t before;
};

ThreadLimit::ThreadLimit(std::size_t threads) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  control_ = std::make_unique<Control>(threads);
}
ThreadLimit::~ThreadLimit() = default;
ThreadLimit::ThreadLimit(ThreadLimit&&) noexcept = default;
ThreadLimit& ThreadLimit::operator=(ThreadLimit&&) noexcept = default;

}  // namespace relumbre
