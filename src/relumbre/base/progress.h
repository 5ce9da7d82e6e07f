/// How long work reports what it has done, and hears that it should stop.
#pragma once

#include <cstdint>
#include <string_view>

namespace relumbre {

/// Receives progress. advance() and cancelled() may be called from any thread.
/// The default does nothing and never cancels.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A stage of `total` units of work begins; it replaces the stage before it.
  virtual void begin(std::string_view stage, std::uint64_t total);
  /// `units` more of the current stage are done.
  virtual void advance(std::uint64_t units);
  /// True when the caller wants the work to stop; the work then throws Cancelled.
  [[nodiscard]] virtual bool cancelled() const;

  /// Throws Cancelled if cancelled().
  void check() const;
};

/// For parts of a stage: hears that the work should stop, and tells nothing.
class QuietProgress : public Progress {
 public:
  explicit QuietProgress(const Progress& whole) : whole_(whole) {}
  [[nodiscard]] bool cancelled() const override { return whole_.cancelled(); }

 private:
  const Progress& whole_;
};

/// A Progress that ignores everything.
Progress& no_progress();

}  // namespace relumbre
