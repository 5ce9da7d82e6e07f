#include "cli/reference.h"

#include <cmath>
#include <map>

#include "relumbre/base/error.h"
#include "relumbre/radiosity/form_factors.h"

namespace relumbre::cli {

namespace {

const std::map<std::string, SolveMethod> kMethods = {{"jacobi", SolveMethod::kJacobi},
                                                     {"gauss-seidel", SolveMethod::kGaussSeidel},
                                                     {"bicgstab", SolveMethod::kBiCgStab}};

/// √Σ area·|a − b|², over elements and channels.
double area_norm(const std::vector<float>& area, const std::vector<Rgb>& a,
                 const std::vector<Rgb>* b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec3d d = b == nullptr ? Vec3d(a[i]) : Vec3d(a[i]) - Vec3d((*b)[i]);
    sum += static_cast<double>(area[i]) * dot(d, d);
  }
  return std::sqrt(sum);
}

double largest_value(const std::vector<Rgb>& values) {
  double largest = 0;
  for (const Rgb& v : values) {
    largest =
        std::max({largest, std::abs(double{v.x}), std::abs(double{v.y}), std::abs(double{v.z})});
  }
  return largest;
}

double ratio(double a, double b) { return b > 0 ? a / b : 0; }

void set_emission(const OpenedStore& store, Reference& reference, Session& session) {
  const std::size_t n = store.baked.tessellation.elements();
  reference.lamps.assign(n, Rgb{});
  if (!store.has_emission()) {
    reference.emission = store.reflected(session);
    reference.lamps = scaled_emission(store.baked.scene, store.baked.tessellation,
                                      store.baked.emission, store.lights);
    return;
  }
  const FloatArray emission = store.read_emission();
  if (emission.shape.size() == 3 && emission.shape[0] != 1) {
    throw ShapeError("--emission: the reference solution takes one source vector, not " +
                     std::to_string(emission.shape[0]));
  }
  reference.emission.resize(n);
  std::copy(emission.data.begin(), emission.data.end(), flat(reference.emission).begin());
}

}  // namespace

void add_reference_options(CLI::App& command, ReferenceOptions& o) {
  command.add_option("--method", o.method, "Iteration")
      ->check(CLI::IsMember({"bicgstab", "gauss-seidel", "jacobi"}))
      ->capture_default_str();
  command.add_option("--tolerance", o.solve.tolerance, "Residual to reach, relative to E")
      ->capture_default_str();
  command.add_option("--max-iterations", o.solve.max_iterations, "Give up after as many")
      ->capture_default_str();
}

Reference solve_reference(const OpenedStore& store, const ReferenceOptions& options,
                          Session& session) {
  Reference reference;
  set_emission(store, reference, session);

  const Stopwatch tracing;
  const FormFactorConfig config = {.rays = store.baked.counts.rays,
                                   .seed = store.baked.settings.seed};
  reference.counts = trace_form_factors(store.baked.tessellation, store.rays, config,
                                        Binning::kElements, session.progress)
                         .counts;
  session.progress.clear();
  session.report.section("reference", "Element-to-element reference");
  session.report.figure("nonzeros", "counts", reference.counts.nonzeros(),
                        grouped(reference.counts.nonzeros()));
  session.report.figure("trace_s", "traced in", tracing.seconds(), seconds_text(tracing.seconds()));

  const Stopwatch solving;
  SolveConfig solve = options.solve;
  solve.method = kMethods.at(options.method);
  SolveResult result = solve_radiosity(reference.counts, store.baked.reflectance,
                                       reference.emission, solve, session.progress);
  session.progress.clear();
  reference.radiosity = std::move(result.radiosity);
  session.report.figure("iterations", "iterations", result.iterations);
  session.report.figure("residual", "relative residual", result.residual,
                        fmt::format("{:.2e}", result.residual));
  session.report.figure("solve_s", "solved in", solving.seconds(), seconds_text(solving.seconds()));
  return reference;
}

CompressionError compressed_error(const OpenedStore& store, const Reference& reference,
                                  Session& session) {
  const auto& area = store.baked.tessellation.area;
  const auto& reflectance = store.baked.reflectance;
  std::vector<Rgb> compressed(reference.emission.size());
  store.make_operator(session)->apply(flat(reference.emission), flat(compressed));

  std::vector<Rgb> difference = compressed;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= reference.radiosity[i];
  const std::vector<Rgb> r =
      residual(reference.counts, reflectance, reference.emission, compressed);

  CompressionError error;
  const double distance = area_norm(area, difference, nullptr);
  error.later_l2 = ratio(distance, area_norm(area, reference.radiosity, &reference.emission));
  error.reflected_l2 = ratio(distance, area_norm(area, reference.radiosity, nullptr));
  error.largest = ratio(largest_value(difference), largest_value(reference.radiosity));
  error.residual = ratio(area_norm(area, r, nullptr), area_norm(area, reference.emission, nullptr));
  // ‖(I − RF)⁻¹‖∞ ≤ 1 / (1 − max ρ), since the rows of F sum to at most 1.
  error.bound =
      ratio(largest_value(r) / (1 - largest_value(reflectance)), largest_value(compressed));
  return error;
}

void report_error(const CompressionError& error, Session& session) {
  Report& report = session.report;
  report.figure("reflected_l2", "error of reflected light, L2", error.reflected_l2,
                percent_text(error.reflected_l2));
  report.figure("later_l2", "of later bounces alone, L2", error.later_l2,
                percent_text(error.later_l2));
  report.figure("largest", "largest error over largest B", error.largest,
                percent_text(error.largest));
  report.figure("residual", "relative residual", error.residual, percent_text(error.residual));
  report.figure("bound", "a-posteriori bound, max norm", error.bound, percent_text(error.bound));
}

}  // namespace relumbre::cli
