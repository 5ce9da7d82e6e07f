#include "emulator/machine.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <random>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <boost/context/fiber.hpp>
#include <boost/context/pooled_fixedsize_stack.hpp>

namespace emulator {

namespace {

constexpr std::size_t kResidentBlocks = 3;
constexpr std::size_t kStackBytes = std::size_t{256} << 10;
/// Threads that only yield, so many times in a row, wait for something that never comes.
constexpr std::size_t kPatience = std::size_t{20} << 20;

struct Block;

struct Thread {
  uint3 index;
  unsigned linear = 0;
  Block* block = nullptr;
  boost::context::fiber fibre, machine;
  bool finished = false, waiting = false;
};

struct Warp {
  std::list<Exchange> open;
  unsigned live = 0;  ///< lanes that have not ended
};

struct Block {
  uint3 index;
  std::unique_ptr<std::byte[]> shared;
  std::vector<std::unique_ptr<Thread>> threads;
  std::vector<Warp> warps;
  std::vector<Thread*> at_barrier;
  Site barrier_site;
  std::size_t live = 0;
};

std::string place(const Site& site) {
  std::ostringstream text;
  text << site.file_name() << ':' << site.line() << " in " << site.function_name();
  return text.str();
}

class Machine {
 public:
  Machine(dim3 grid, dim3 block, std::size_t shared_bytes, const std::function<void()>& kernel,
          std::uint64_t seed)
      : block_(block), shared_bytes_(shared_bytes), kernel_(kernel), random_(seed) {
    for (unsigned z = 0; z < grid.z; ++z)
      for (unsigned y = 0; y < grid.y; ++y)
        for (unsigned x = 0; x < grid.x; ++x) to_come_.push_back({x, y, z});
    std::ranges::shuffle(to_come_, random_);
  }

  /// Threads that have not ended cannot be ended: unwinding their stacks is more than the address
  /// sanitizer follows. They stay where they are.
  ~Machine() {
    static auto& graveyard = *new std::vector<std::unique_ptr<Block>>;
    for (auto& block : resident_) graveyard.push_back(std::move(block));
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  void run() {
    for (std::size_t idle = 0;;) {
      while (resident_.size() < kResidentBlocks && !to_come_.empty()) start_block();
      if (resident_.empty()) return;
      if (ready_.empty()) throw_stuck();
      Thread& thread = draw();
      const std::size_t before = progress_;
      resume(thread);
      if (error_) std::rethrow_exception(error_);
      idle = progress_ == before ? idle + 1 : 0;
      if (idle > kPatience) throw std::logic_error("emulator: threads wait for ever");
      if (thread.finished)
        end(thread);
      else if (!thread.waiting)
        ready_.push_back(&thread);
    }
  }

  /// In a thread, where nothing may be thrown: it stops here for ever, and the machine throws.
  void fail(const std::string& what) {
    error_ = std::make_exception_ptr(std::logic_error("emulator: " + what));
    for (;;) pause();
  }

  [[nodiscard]] Thread* running() const { return running_; }

  void pause() {
    Thread* self = running_;
    self->machine = std::move(self->machine).resume();
  }

  void wait_at_barrier(const Site& site) {
    Block& block = *running_->block;
    if (block.at_barrier.empty()) {
      block.barrier_site = site;
    } else if (site.line() != block.barrier_site.line() ||
               std::strcmp(site.file_name(), block.barrier_site.file_name()) != 0) {
      fail("threads of one block at different barriers: " + place(site) + " and " +
           place(block.barrier_site));
    }
    ++progress_;
    Thread* self = running_;
    self->waiting = true;
    block.at_barrier.push_back(self);
    release_barrier(block);
    if (self->waiting) pause();
    // The last one to arrive also gives way.
    else
      ready_.push_back(self), self->waiting = true, pause(), self->waiting = false;
  }

  void exchange(unsigned mask, const void* value, std::size_t bytes, const Site& site,
                const std::function<void(const Exchange&)>& take) {
    Thread* self = running_;
    const unsigned lane = self->linear % 32, bit = 1U << lane;
    Warp& warp = self->block->warps[self->linear / 32];
    if ((mask & bit) == 0) fail("a lane outside its mask, " + place(site));
    if ((mask & ~warp.live) != 0) fail("the mask has lanes that have ended, " + place(site));
    auto open = std::ranges::find_if(
        warp.open, [&](const Exchange& e) { return e.mask == mask && (e.arrived & bit) == 0; });
    if (open == warp.open.end()) {
      open = warp.open.insert(warp.open.end(), Exchange{});
      open->mask = mask, open->site = site;
    } else if (open->site.line() != site.line()) {
      fail("lanes of one mask at different places: " + place(site) + " and " + place(open->site));
    }
    std::memcpy(open->values[lane].data(), value, bytes);
    open->arrived |= bit;
    ++progress_;
    if (open->arrived == mask)
      wake(*self->block, self->linear / 32, mask & ~bit);
    else
      self->waiting = true, pause();
    take(*open);
    open->read |= bit;
    if (open->read == mask) warp.open.erase(open);
  }

 private:
  void start_block() {
    auto block = std::make_unique<Block>();
    block->index = to_come_.back();
    to_come_.pop_back();
    block->shared = std::make_unique_for_overwrite<std::byte[]>(shared_bytes_);
    std::fill_n(block->shared.get(), shared_bytes_, std::byte{0xFF});
    block->live = std::size_t{block_.x} * block_.y * block_.z;
    block->warps.resize((block->live + 31) / 32);
    for (unsigned i = 0; i < block->live; ++i) {
      auto thread = std::make_unique<Thread>();
      thread->index = {i % block_.x, i / block_.x % block_.y, i / block_.x / block_.y};
      thread->linear = i;
      thread->block = block.get();
      thread->fibre = boost::context::fiber(std::allocator_arg, stacks(),
                                            [this, t = thread.get()](auto&& machine) {
                                              t->machine = std::move(machine);
                                              kernel_();
                                              t->finished = true;
                                              return std::move(t->machine);
                                            });
      block->warps[i / 32].live |= 1U << i % 32;
      ready_.push_back(thread.get());
      block->threads.push_back(std::move(thread));
    }
    resident_.push_back(std::move(block));
  }

  static boost::context::pooled_fixedsize_stack& stacks() {
    static auto& pool = *new boost::context::pooled_fixedsize_stack(kStackBytes);
    return pool;
  }

  Thread& draw() {
    const std::size_t at =
        std::uniform_int_distribution<std::size_t>(0, ready_.size() - 1)(random_);
    std::swap(ready_[at], ready_.back());
    Thread& thread = *ready_.back();
    ready_.pop_back();
    return thread;
  }

  void resume(Thread& thread) {
    running_ = &thread;
    threadIdx = thread.index;
    blockIdx = thread.block->index;
    thread.fibre = std::move(thread.fibre).resume();
    running_ = nullptr;
  }

  void end(Thread& thread) {
    Block& block = *thread.block;
    ++progress_;
    Warp& warp = block.warps[thread.linear / 32];
    warp.live &= ~(1U << thread.linear % 32);
    for (const Exchange& e : warp.open)
      if ((e.mask & ~e.arrived & (1U << thread.linear % 32)) != 0)
        throw std::logic_error("emulator: a lane of the mask has ended, " + place(e.site));
    --block.live;
    if (block.live > 0) return release_barrier(block);
    std::erase_if(resident_, [&](const auto& b) { return b.get() == &block; });
  }

  void release_barrier(Block& block) {
    if (block.at_barrier.size() < block.live) return;
    for (Thread* t : block.at_barrier) {
      t->waiting = false;
      if (t != running_) ready_.push_back(t);
    }
    block.at_barrier.clear();
  }

  void wake(Block& block, std::size_t warp, unsigned mask) {
    for (; mask != 0; mask &= mask - 1) {
      Thread& t = *block.threads[warp * 32 + static_cast<unsigned>(std::countr_zero(mask))];
      t.waiting = false;
      ready_.push_back(&t);
    }
  }

  [[noreturn]] void throw_stuck() const {
    for (const auto& block : resident_) {
      if (!block->at_barrier.empty())
        throw std::logic_error("emulator: not all threads of the block reach " +
                               place(block->barrier_site));
      for (const Warp& warp : block->warps)
        for (const Exchange& e : warp.open)
          throw std::logic_error("emulator: not all lanes of the mask reach " + place(e.site));
    }
    throw std::logic_error("emulator: stuck");
  }

  dim3 block_;
  std::size_t shared_bytes_;
  const std::function<void()>& kernel_;
  std::mt19937_64 random_;
  std::vector<uint3> to_come_;
  std::vector<std::unique_ptr<Block>> resident_;
  std::vector<Thread*> ready_;
  Thread* running_ = nullptr;
  std::exception_ptr error_;
  std::size_t progress_ = 0;
};

std::mutex one_grid;
std::uint64_t next_seed = 1;
Machine* machine = nullptr;

}  // namespace

void run_grid(dim3 grid, dim3 block, std::size_t shared_bytes,
              const std::function<void()>& kernel) {
  const std::lock_guard lock(one_grid);
  gridDim = grid, blockDim = block;
  Machine here(grid, block, shared_bytes, kernel, next_seed++);
  machine = &here;
  try {
    here.run();
  } catch (...) {
    machine = nullptr;
    throw;
  }
  machine = nullptr;
}

bool in_kernel() { return machine != nullptr && machine->running() != nullptr; }
void* shared_memory() { return machine->running()->block->shared.get(); }
void barrier(Site site) { machine->wait_at_barrier(site); }
void yield() { machine->pause(); }
unsigned lane() { return machine->running()->linear % 32; }
void set_seed(std::uint64_t seed) { next_seed = seed; }

void exchange(unsigned mask, const void* value, std::size_t bytes, Site site,
              const std::function<void(const Exchange&)>& take) {
  machine->exchange(mask, value, bytes, site, take);
}

}  // namespace emulator
