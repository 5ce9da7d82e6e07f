/// A progress bar with remaining time on a terminal; Ctrl-C asks the work to stop.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

#include "relumbre/base/progress.h"

namespace relumbre::cli {

/// Draws on standard error, and only where that is a terminal.
class TerminalProgress : public Progress {
 public:
  TerminalProgress();
  void begin(std::string_view stage, std::uint64_t total) override;
  void advance(std::uint64_t units) override;
  /// True after Ctrl-C or SIGTERM.
  [[nodiscard]] bool cancelled() const override;
  /// Removes the bar.
  void clear();

  /// From now on Ctrl-C and SIGTERM set a flag that cancelled() reads; a second one kills.
  static void catch_interrupts();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(std::uint64_t done);

  bool terminal_;
  std::mutex mutex_;
  std::string stage_;
  std::atomic<std::uint64_t> done_{0};
  std::uint64_t total_ = 0;
  Clock::time_point start_, last_drawn_;
};

}  // namespace relumbre::cli
