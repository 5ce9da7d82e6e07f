#include "relumbre/radiosity/solver.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"

namespace relumbre {

namespace {

using Field = std::vector<Vec3d>;  // one value an element, three channels

constexpr std::size_t kRowGrain = 128;
constexpr std::size_t kVectorGrain = 4096;

template <class Function>
Vec3d per_channel(Function&& function) {
  return {function(0), function(1), function(2)};
}

/// a / b, and 0 where there is nothing to divide by: a channel that has converged to zero.
Vec3d ratio(const Vec3d& a, const Vec3d& b) {
  return per_channel([&](std::size_t c) { return b[c] != 0 ? a[c] / b[c] : 0.0; });
}

Vec3d square_root(const Vec3d& a) {
  return per_channel([&](std::size_t c) { return std::sqrt(a[c]); });
}

/// Σ term(i), summed chunk by chunk in an order that does not depend on the threads.
template <class Term>
Vec3d ordered_sum(std::size_t n, Term&& term) {
  std::vector<Vec3d> partial((n + kVectorGrain - 1) / kVectorGrain);
  parallel_chunks(0, n, kVectorGrain, [&](std::size_t first, std::size_t last) {
    Vec3d sum;
    for (std::size_t i = first; i < last; ++i) sum += term(i);
    partial[first / kVectorGrain] = sum;
  });
  Vec3d total;
  for (const Vec3d& p : partial) total += p;
  return total;
}

Vec3d dot(const Field& a, const Field& b) {
  return ordered_sum(a.size(), [&](std::size_t i) { return a[i] * b[i]; });
}

Field widened(std::span<const Rgb> values) {
  Field field(values.size());
  std::transform(values.begin(), values.end(), field.begin(),
                 [](const Rgb& v) { return Vec3d(v); });
  return field;
}

std::vector<Rgb> narrowed(const Field& field) {
  std::vector<Rgb> values(field.size());
  std::transform(field.begin(), field.end(), values.begin(), [](const Vec3d& v) { return Rgb(v); });
  return values;
}

/// R F of one scene, applied row by row.
class Transport {
 public:
  Transport(const SparseCounts& counts, std::span<const Rgb> reflectance)
      : counts_(counts),
        reflectance_(reflectance),
        scale_(counts.rays > 0 ? 1.0 / counts.rays : 0.0) {}

  /// (R F x)_i
  [[nodiscard]] Vec3d row(std::size_t i, const Field& x) const {
    Vec3d sum;
    for (std::uint64_t e = counts_.row_offsets[i]; e < counts_.row_offsets[i + 1]; ++e) {
      sum += x[counts_.column[e]] * static_cast<double>(counts_.count[e]);
    }
    return sum * Vec3d(reflectance_[i]) * scale_;
  }

  /// y = (I − RF) x
  void apply(const Field& x, Field& y) const {
    parallel_for(0, x.size(), kRowGrain, [&](std::size_t i) { y[i] = x[i] - row(i, x); });
  }

  /// r = E − (I − RF) x
  void residual(const Field& emission, const Field& x, Field& r) const {
    parallel_for(0, x.size(), kRowGrain,
                 [&](std::size_t i) { r[i] = emission[i] - (x[i] - row(i, x)); });
  }

 private:
  const SparseCounts& counts_;
  std::span<const Rgb> reflectance_;
  double scale_;
};

/// Measures residuals against ‖E‖, reports progress by their logarithm, and stops at the cap.
class Convergence {
 public:
  Convergence(const Field& emission, const SolveConfig& config, Progress& progress)
      : norm_(square_root(dot(emission, emission))), config_(config), progress_(progress) {
    progress_.begin("solve", kUnits);
  }

  /// ‖r‖ / ‖E‖ of each channel. Where nothing is emitted, nothing is left to do.
  [[nodiscard]] Vec3d relative(const Field& r) const {
    return ratio(square_root(dot(r, r)), norm_);
  }
  [[nodiscard]] bool reached(double relative) const { return relative <= config_.tolerance; }
  [[nodiscard]] bool reached(const Vec3d& relative) const {
    return reached(max_component(relative));
  }

  /// One more iteration is about to start from this residual. Throws Error at the cap.
  void next(const Vec3d& relative) {
    progress_.check();
    const double worst = max_component(relative);
    if (iterations_ == config_.max_iterations) {
      throw Error(fmt::format(
          "{} stopped at a relative residual of {:.3g} after {} iterations (tolerance {:.3g})",
          to_string(config_.method), worst, iterations_, config_.tolerance));
    }
    ++iterations_;
    report(worst);
  }

  [[nodiscard]] SolveResult result(const Field& x, const Vec3d& relative) {
    report(config_.tolerance);
    return {narrowed(x), iterations_, max_component(relative)};
  }

 private:
  void report(double worst) {
    if (first_ == 0) first_ = worst;
    const double whole = std::log(first_ / config_.tolerance);
    const double part = whole > 0 ? std::log(first_ / worst) / whole : 1.0;
    if (!(part > 0)) return;  // no better than the start, or not a number
    const auto units = static_cast<std::uint64_t>(std::min(part, 1.0) * kUnits);
    if (units <= reported_) return;
    progress_.advance(units - reported_);
    reported_ = units;
  }

  static constexpr std::uint64_t kUnits = 1000;
  Vec3d norm_;
  const SolveConfig& config_;
  Progress& progress_;
  std::size_t iterations_ = 0;
  double first_ = 0;
  std::uint64_t reported_ = 0;
};

SolveResult solve_jacobi(const Transport& transport, const Field& emission,
                         Convergence& convergence) {
  Field x = emission, r(x.size());
  for (;;) {
    transport.residual(emission, x, r);
    const Vec3d relative = convergence.relative(r);
    if (convergence.reached(relative)) return convergence.result(x, relative);
    convergence.next(relative);
    parallel_for(0, x.size(), kVectorGrain, [&](std::size_t i) { x[i] += r[i]; });
  }
}

/// One sweep in place; `change` receives what it added to each element.
void gauss_seidel_sweep(const Transport& transport, const Field& emission, Field& x,
                        Field& change) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3d fresh = emission[i] + transport.row(i, x);
    change[i] = fresh - x[i];
    x[i] = fresh;
  }
}

SolveResult solve_gauss_seidel(const Transport& transport, const Field& emission,
                               Convergence& convergence) {
  Field x = emission, r(x.size());
  transport.residual(emission, x, r);
  Vec3d relative = convergence.relative(r);
  while (!convergence.reached(relative)) {
    convergence.next(relative);
    gauss_seidel_sweep(transport, emission, x, r);
    relative = convergence.relative(r);
    if (!convergence.reached(relative)) continue;
    // The change of a sweep is small, so the residual probably is: only now is it worth a pass.
    transport.residual(emission, x, r);
    relative = convergence.relative(r);
  }
  return convergence.result(x, relative);
}

/// The vectors of BiCGSTAB, named as by van der Vorst 1992.
struct Krylov {
  Field r, shadow, p, v, t;
  Vec3d rho;

  explicit Krylov(std::size_t n) : r(n), shadow(n), p(n), v(n), t(n) {}
  /// Starts afresh from the residual that is in r.
  void restart() {
    shadow = r;
    p = r;
    rho = dot(r, r);
  }
};

/// Per channel, 1 while it still has to converge. A frozen channel keeps x and r as they are.
Vec3d still_active(const Convergence& convergence, const Vec3d& relative) {
  return per_channel([&](std::size_t c) { return convergence.reached(relative[c]) ? 0.0 : 1.0; });
}

/// One step of the recurrences; returns false if they broke down and need a restart.
bool bicgstab_step(const Transport& transport, const Vec3d& active, Krylov& k, Field& x) {
  const std::size_t n = x.size();
  transport.apply(k.p, k.v);
  const Vec3d alpha = active * ratio(k.rho, dot(k.shadow, k.v));
  parallel_for(0, n, kVectorGrain, [&](std::size_t i) { k.r[i] -= alpha * k.v[i]; });
  transport.apply(k.r, k.t);
  const Vec3d omega = active * ratio(dot(k.t, k.r), dot(k.t, k.t));
  parallel_for(0, n, kVectorGrain, [&](std::size_t i) {
    x[i] += alpha * k.p[i] + omega * k.r[i];
    k.r[i] -= omega * k.t[i];
  });
  const Vec3d rho = dot(k.shadow, k.r);
  const Vec3d beta = ratio(rho, k.rho) * ratio(alpha, omega);
  k.rho = rho;
  parallel_for(0, n, kVectorGrain,
               [&](std::size_t i) { k.p[i] = k.r[i] + beta * (k.p[i] - omega * k.v[i]); });
  for (std::size_t c = 0; c < 3; ++c) {
    if (active[c] != 0 && (alpha[c] == 0 || omega[c] == 0 || !std::isfinite(beta[c]))) return false;
  }
  return true;
}

SolveResult solve_bicgstab(const Transport& transport, const Field& emission,
                           Convergence& convergence) {
  Field x = emission;
  Krylov k(x.size());
  bool recurrences_hold = false;
  for (;;) {
    Vec3d relative = convergence.relative(k.r);
    if (!recurrences_hold || convergence.reached(relative)) {
      // The recurrences drift from the true residual, so that alone decides.
      transport.residual(emission, x, k.r);
      relative = convergence.relative(k.r);
      if (convergence.reached(relative)) return convergence.result(x, relative);
      k.restart();
    }
    convergence.next(relative);
    recurrences_hold = bicgstab_step(transport, still_active(convergence, relative), k, x);
  }
}

void require_size(std::string_view what, std::size_t size, std::size_t n) {
  if (size == n) return;
  throw ShapeError(fmt::format("{} has {} elements, the counts have {} rows", what, size, n));
}

bool in_unit_interval(const Rgb& v) {
  return v.x >= 0 && v.x < 1 && v.y >= 0 && v.y < 1 && v.z >= 0 && v.z < 1;
}

void require_finite(std::string_view what, std::span<const Rgb> values) {
  const auto bad = std::find_if_not(values.begin(), values.end(), is_finite<float>);
  if (bad == values.end()) return;
  throw ValueError(fmt::format("{} of element {} is not finite", what, bad - values.begin()));
}

void check_system(const SparseCounts& counts, std::span<const Rgb> reflectance,
                  std::span<const Rgb> emission) {
  validate(counts);
  if (counts.columns != counts.rows()) {
    throw ShapeError(fmt::format("element-to-element counts must be square, these are {} x {}",
                                 counts.rows(), counts.columns));
  }
  require_size("the reflectance", reflectance.size(), counts.rows());
  require_size("the emission", emission.size(), counts.rows());
  const auto bad = std::find_if_not(reflectance.begin(), reflectance.end(), in_unit_interval);
  if (bad != reflectance.end()) {
    throw ValueError(fmt::format("reflectance of element {} is outside [0, 1): {}, {}, {}",
                                 bad - reflectance.begin(), bad->x, bad->y, bad->z));
  }
  require_finite("emission", emission);
}

}  // namespace

std::string_view to_string(SolveMethod method) {
  switch (method) {
    case SolveMethod::kJacobi:
      return "jacobi";
    case SolveMethod::kGaussSeidel:
      return "gauss-seidel";
    case SolveMethod::kBiCgStab:
      return "bicgstab";
  }
  return "unknown";
}

SolveResult solve_radiosity(const SparseCounts& counts, std::span<const Rgb> reflectance,
                            std::span<const Rgb> emission, const SolveConfig& config,
                            Progress& progress) {
  check_system(counts, reflectance, emission);
  if (!(config.tolerance > 0)) {
    throw ValueError(fmt::format("the tolerance must be positive, not {}", config.tolerance));
  }
  const Transport transport(counts, reflectance);
  const Field source = widened(emission);
  Convergence convergence(source, config, progress);
  switch (config.method) {
    case SolveMethod::kJacobi:
      return solve_jacobi(transport, source, convergence);
    case SolveMethod::kGaussSeidel:
      return solve_gauss_seidel(transport, source, convergence);
    case SolveMethod::kBiCgStab:
      break;
  }
  return solve_bicgstab(transport, source, convergence);
}

std::vector<Rgb> residual(const SparseCounts& counts, std::span<const Rgb> reflectance,
                          std::span<const Rgb> emission, std::span<const Rgb> radiosity) {
  check_system(counts, reflectance, emission);
  require_size("the radiosity", radiosity.size(), counts.rows());
  require_finite("radiosity", radiosity);
  Field r(radiosity.size());
  Transport(counts, reflectance).residual(widened(emission), widened(radiosity), r);
  return narrowed(r);
}

}  // namespace relumbre
