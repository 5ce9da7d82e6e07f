#include "cli/terminal_progress.h"

#include <csignal>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/report.h"

namespace relumbre::cli {

namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void note_interrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);  // a second one ends the program at once
}

constexpr int kBarWidth = 24;

}  // namespace

TerminalProgress::TerminalProgress() : terminal_(isatty(STDERR_FILENO) != 0) {}

void TerminalProgress::catch_interrupts() {
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);
}

bool TerminalProgress::cancelled() const { return interrupted != 0; }

void TerminalProgress::begin(std::string_view stage, std::uint64_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  total_ = total;
  done_ = 0;
  start_ = last_drawn_ = Clock::now();
  if (terminal_) draw(0);
}

void TerminalProgress::advance(std::uint64_t units) {
  const std::uint64_t done = done_ += units;
  if (!terminal_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || Clock::now() - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = Clock::now();
  draw(done);
}

void TerminalProgress::draw(std::uint64_t done) {
  const double fraction =
      total_ == 0 ? 0.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
  const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
  const auto filled = static_cast<std::size_t>(fraction * kBarWidth);
  const std::string remaining =
      fraction > 0.01 ? seconds_text(elapsed * (1 - fraction) / fraction) + " left" : "";
  fmt::print(stderr, "\r\x1b[K{:<18} [{}{}] {:3.0f} %  {}", stage_, std::string(filled, '#'),
             std::string(kBarWidth - filled, '.'), fraction * 100, remaining);
  std::fflush(stderr);
}

void TerminalProgress::clear() {
  if (!terminal_) return;
  const std::lock_guard lock(mutex_);
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
}

}  // namespace relumbre::cli
