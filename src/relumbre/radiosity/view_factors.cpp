#include "relumbre/radiosity/view_factors.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/ray_generator.h"

namespace relumbre {

namespace {

constexpr std::size_t kPacketsPerBatch = 32;

void check(const TriangleMesh& mesh, std::size_t objects, const ViewFactorConfig& config) {
  const std::size_t triangles = mesh.triangles.size();
  if (mesh.object.size() != triangles || mesh.two_sided.size() != triangles) {
    throw ShapeError(fmt::format("view factors: {} triangles, {} objects of them, {} sides",
                                 triangles, mesh.object.size(), mesh.two_sided.size()));
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    if (mesh.object[t] < objects) continue;
    throw ValueError(
        fmt::format("view factors: triangle {} is of object {} of {}", t, mesh.object[t], objects));
  }
  if (config.replicates < 2) {
    throw ValueError(fmt::format("view factors: {} replicates, 2 are needed", config.replicates));
  }
}

std::uint32_t rays_per_replicate(const ViewFactorConfig& config) {
  const std::uint64_t each =
      config.rays / config.replicates + (config.rays % config.replicates != 0 ? 1 : 0);
  if (each < 1 || each > (1U << 26)) {
    throw ValueError(fmt::format("view factors: {} rays in {} replicates: must be 1 to 2^26 each",
                                 config.rays, config.replicates));
  }
  return static_cast<std::uint32_t>(each);
}

/// The triangles of each object, one object after the other.
struct ObjectTriangles {
  std::vector<std::size_t> offsets;
  std::vector<std::uint32_t> triangles;

  ObjectTriangles(const TriangleMesh& mesh, std::size_t objects) : offsets(objects + 1) {
    for (const std::uint32_t object : mesh.object) ++offsets[object + 1];
    for (std::size_t o = 0; o < objects; ++o) offsets[o + 1] += offsets[o];
    std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
    triangles.resize(mesh.triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) triangles[next[mesh.object[t]]++] = t;
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t object) const {
    return std::span(triangles).subspan(offsets[object], offsets[object + 1] - offsets[object]);
  }
};

EmittingSurface surface_of(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
                           float clearance) {
  EmittingSurface surface;
  for (const std::uint32_t t : triangles) {
    const Vec3f a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    surface.add(a, b, c, clearance);
    if (mesh.two_sided[t] != 0) surface.add(a, c, b, clearance);
  }
  surface.finish();
  return surface;
}

/// How many rays of one replicate arrived at each object, then at a back, then nowhere.
class Replicates {
 public:
  Replicates(std::size_t replicates, std::size_t objects)
      : replicates_(replicates), bins_(objects + 2), hits_(replicates * bins_) {}

  [[nodiscard]] std::span<std::uint32_t> of(std::size_t replicate) {
    return std::span(hits_).subspan(replicate * bins_, bins_);
  }
  void clear() { std::fill(hits_.begin(), hits_.end(), 0U); }

  struct Estimate {
    double mean, standard_error;
  };
  /// Of a bin's count over the replicates.
  [[nodiscard]] Estimate estimate(std::size_t bin) const {
    const auto r = static_cast<double>(replicates_);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < replicates_; ++i) sum += hits_[i * bins_ + bin];
    for (std::size_t i = 0; i < replicates_; ++i) {
      const double deviation = hits_[i * bins_ + bin] - sum / r;
      squares += deviation * deviation;
    }
    return {sum / r, std::sqrt(squares / (r * (r - 1)))};
  }

 private:
  std::size_t replicates_, bins_;
  std::vector<std::uint32_t> hits_;
};

/// Traces one replicate of one object into `bins`.
void trace(const TriangleMesh& mesh, const RayScene& scene, const RayPattern& pattern,
           const EmittingSurface& surface, const DigitalShift& shift,
           std::span<std::uint32_t> bins) {
  const std::size_t back_face = bins.size() - 2, escaped = bins.size() - 1;
  std::vector<RayPacket> packets(std::min(kPacketsPerBatch, pattern.packets()));
  HitPacket hits;
  for (std::size_t first = 0; first < pattern.packets(); first += packets.size()) {
    const std::size_t count = std::min(packets.size(), pattern.packets() - first);
    generate_rays(pattern, surface, shift, first, std::span(packets).first(count));
    for (std::size_t p = 0; p < count; ++p) {
      const std::size_t active = pattern.active(first + p);
      scene.closest(packets[p], hits, active);
      for (std::size_t i = 0; i < active; ++i) {
        const std::uint32_t t = hits.triangle[i];
        if (t == kNone) {
          ++bins[escaped];
        } else {
          const bool absorbed = hits.back[i] != 0 && mesh.two_sided[t] == 0;
          ++bins[absorbed ? back_face : mesh.object[t]];
        }
      }
    }
  }
}

void store_row(const Replicates& hits, double rays, std::size_t object, ViewFactorResult& result) {
  const std::size_t objects = result.objects;
  for (std::size_t j = 0; j < objects; ++j) {
    const auto [mean, standard_error] = hits.estimate(j);
    result.factor[object * objects + j] = mean / rays;
    result.standard_error[object * objects + j] = standard_error / rays;
  }
  result.back_face[object] = hits.estimate(objects).mean / rays;
  result.escaped[object] = hits.estimate(objects + 1).mean / rays;
}

ViewFactorResult empty_result(std::size_t objects, std::uint64_t rays) {
  ViewFactorResult result;
  result.objects = objects;
  result.rays = rays;
  result.area.resize(objects), result.back_face.resize(objects), result.escaped.resize(objects);
  result.factor.resize(objects * objects), result.standard_error.resize(objects * objects);
  return result;
}

}  // namespace

ViewFactorResult view_factors(const TriangleMesh& mesh, std::size_t objects, const RayScene& rays,
                              const ViewFactorConfig& config, Progress& progress) {
  check(mesh, objects, config);
  const RayPattern pattern(rays_per_replicate(config));
  const ObjectTriangles triangles(mesh, objects);
  ViewFactorResult result =
      empty_result(objects, std::uint64_t{pattern.rays()} * config.replicates);
  Replicates hits(config.replicates, objects);
  progress.begin("view factors", objects * std::uint64_t{config.replicates});
  for (std::size_t object = 0; object < objects; ++object) {
    const EmittingSurface surface = surface_of(mesh, triangles.of(object), rays.epsilon());
    result.area[object] = surface.area();
    if (surface.size() == 0) continue;
    hits.clear();
    parallel_for(0, config.replicates, 1, [&](std::size_t replicate) {
      progress.check();
      const DigitalShift shift = digital_shift(hash64(config.seed, object), replicate);
      trace(mesh, rays, pattern, surface, shift, hits.of(replicate));
      progress.advance(1);
    });
    store_row(hits, pattern.rays(), object, result);
  }
  return result;
}

}  // namespace relumbre
