/// The table and the JSON that every benchmark writes.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace relumbre::bench {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// One case: ours, a peer that does the same work, and the least time that the machine could take.
struct Row {
  std::string name;
  double ours_ms = kNotMeasured;
  std::string peer;
  double peer_ms = kNotMeasured;
  std::string limit;
  double limit_ms = kNotMeasured;

  [[nodiscard]] double speedup_vs_peer() const { return peer_ms / ours_ms; }
  [[nodiscard]] double fraction_of_limit() const { return limit_ms / ours_ms; }
};

/// Collects rows and figures; prints as they come; writes JSON to the file after --output.
class Report {
 public:
  /// Reads `--output FILE` from the arguments; `option(name)` finds others.
  Report(std::string name, int argc, char** argv);

  void heading(std::string_view text);
  void add(const Row& row);
  /// A single figure beside the table.
  void figure(const std::string& key, double value, std::string_view unit);
  void note(std::string_view text);
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  /// The value after `--name`, or `otherwise`.
  [[nodiscard]] std::string option(std::string_view name, std::string otherwise) const;
  /// Writes the JSON, atomically. Returns the exit status.
  int finish();

 private:
  std::string name_, output_;
  std::vector<std::string> arguments_;
  std::vector<Row> rows_;
  nlohmann::json figures_ = nlohmann::json::object();
};

/// What a benchmark's main returns: the status of run(), or 1 and the reason on standard error.
int run_benchmark(int (*run)(int argc, char** argv), int argc, char** argv);

/// Median seconds of each of `candidates`, run by turns `rounds` times after one round of warm-up,
/// so that a drift of the machine meets all of them alike.
std::vector<double> median_seconds(std::span<const std::function<void()>> candidates,
                                   std::size_t rounds);
/// Of one run.
double seconds_of(const std::function<void()>& work);
double median(std::vector<double> values);
double geometric_mean(std::span<const double> values);

/// The processor's model, its cores, the memory: what a figure belongs to.
nlohmann::json describe_machine();

}  // namespace relumbre::bench
