// How fast a bake traces, against bare Embree loops that shoot the very same rays and drop the
// hits.
//
// Our time is the whole of trace_form_factors: making the rays, tracing, finding the patch under
// each hit, counting, compressing the rows. The loops' rays are made beforehand and not timed. All
// run by turns on all threads; rays of one element are contiguous and one task for everyone.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "bare_embree.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/geometry/test_shapes.h"
#include "relumbre/radiosity/element_sampler.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/scalar_form_factors.h"
#include "relumbre/visibility/bvh_tracer.h"
#include "report.h"

namespace relumbre::bench {
namespace {

constexpr std::size_t kRaysPerElement = 512;

// ---------------------------------------------------------------------------------- the meshes

void name_all(TriangleMesh& mesh) {
  mesh.material.assign(mesh.triangles.size(), 0);
  mesh.object.assign(mesh.triangles.size(), 0);
  mesh.two_sided.assign(mesh.triangles.size(), 0);
}

bool has_area(const TriangleMesh& mesh, const Index3& t) {
  const Vec3f a = mesh.positions[t[0]];
  return length(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) > 1e-9F;
}

/// Positions and triangles of an OBJ file packed with xz; empty if there is none.
TriangleMesh read_obj_xz(const std::string& file) {
  TriangleMesh mesh;
  if (std::FILE* there = std::fopen(file.c_str(), "rb"); there == nullptr)
    return mesh;
  else
    std::fclose(there);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(
      ::popen(("xz -dc -- '" + file + "'").c_str(), "r"), ::pclose);
  std::array<char, 512> line{};
  while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    Vec3f p;
    Index3 t;
    if (std::sscanf(line.data(), "v %f %f %f", &p.x, &p.y, &p.z) == 3) mesh.positions.push_back(p);
    if (std::sscanf(line.data(), "f %u%*[^ ] %u%*[^ ] %u", &t[0], &t[1], &t[2]) != 3 &&
        std::sscanf(line.data(), "f %u %u %u", &t[0], &t[1], &t[2]) != 3) {
      continue;
    }
    for (std::uint32_t& vertex : t) --vertex;
    if (has_area(mesh, t)) mesh.triangles.push_back(t);
  }
  name_all(mesh);
  return mesh;
}

/// A closed hall with rows of spheres and boxes in it: 100,000 triangles.
TriangleMesh furnished_hall() {
  TriangleMesh mesh;
  shapes::add_box(mesh, {0, 0, 0}, {20, 4, 20}, true);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 7; ++j) {
      const Vec3f at{2 + 2.6F * static_cast<float>(i), 0.5F, 2 + 2.6F * static_cast<float>(j)};
      shapes::add_box(mesh, at + Vec3f{-0.6F, -0.1F, -0.6F}, at + Vec3f{0.6F, 0.2F, 0.6F}, false);
      const TriangleMesh ball = shapes::sphere(23, at + Vec3f{0, 0.8F, 0}, 0.5F);
      for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
        shapes::add_triangle(mesh, ball.corner(t, 0), ball.corner(t, 1), ball.corner(t, 2));
      }
    }
  }
  return mesh;
}

// --------------------------------------------------------------------------------- the contest

std::vector<Ray> all_rays(const Tessellation& tessellation, float clearance) {
  const FormFactorConfig config;
  const ElementSampler sampler(tessellation, kRaysPerElement, config.seed, clearance);
  std::vector<Ray> rays(tessellation.elements() * kRaysPerElement);
  parallel_for(0, tessellation.elements(), 16, [&](std::size_t element) {
    EmittingSurface surface;
    std::vector<RayPacket> packets(sampler.pattern().packets());
    sampler.load(element, surface);
    sampler.generate(element, surface, 0, packets);
    for (std::size_t r = 0; r < kRaysPerElement; ++r) {
      Ray& ray = rays[element * kRaysPerElement + r];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = packets[r / 16].origin[axis][r % 16];
        ray.direction[axis] = packets[r / 16].direction[axis][r % 16];
      }
    }
  });
  return rays;
}

/// The same rays of each element, in the order in which a Sobol' sequence or a random one gives
/// them.
std::vector<Ray> without_order(std::vector<Ray> rays) {
  for (std::size_t first = 0; first < rays.size(); first += kRaysPerElement) {
    RandomStream random(first);
    for (std::size_t i = kRaysPerElement; i > 1; --i) {
      std::swap(rays[first + i - 1], rays[first + random.bits() % i]);
    }
  }
  return rays;
}

void shoot(RTCScene scene, const std::vector<Ray>& rays, Loop loop) {
  parallel_for(0, rays.size() / kRaysPerElement, 4, [&](std::size_t element) {
    loop(scene, std::span(rays).subspan(element * kRaysPerElement, kRaysPerElement));
  });
}

struct Contestant {
  std::string name;
  std::function<void()> run;
  bool same_guarantees = true;  ///< robust, and the rays in our order
};

void compare(Report& report, const std::string& name, const TriangleMesh& mesh, std::size_t n,
             std::size_t k, std::size_t rounds) {
  TessellationConfig cuts;
  cuts.elements = n, cuts.patches = k;
  const Tessellation tessellation = tessellate(mesh, cuts);
  const RayScene scene(mesh);
  FormFactorConfig config;
  config.rays = kRaysPerElement;
  const BareScene high(mesh, RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_ROBUST);
  const BareScene medium(mesh, RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_ROBUST);
  const BareScene fast(mesh, RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_NONE);
  const std::vector<Ray> rays = all_rays(tessellation, scene.epsilon());
  const std::vector<Ray> unordered = without_order(rays);

  const auto bake = [&](Binning binning) {
    trace_form_factors(tessellation, scene, config, binning, 0,
                       [](std::size_t, const SparseCounts&, const RayTally&) {});
  };
  std::vector<Contestant> all = {{"bake, patches", [&] { bake(Binning::kPatches); }},
                                 {"bake, elements", [&] { bake(Binning::kElements); }}};
  const auto add = [&](const std::string& label, const BareScene& built,
                       const std::vector<Ray>& set, Loop loop, bool same) {
    all.push_back({label, [&, loop] { shoot(built.get(), set, loop); }, same});
  };
  for (const NamedLoop& l : loops()) {
    add(std::string(l.name) + ", high", high, rays, l.loop, true);
    add(std::string(l.name) + ", medium", medium, rays, l.loop, true);
  }
  // What a GPU's benchmark has for a CPU: ours, which both sides share.
  const BvhTracer own(mesh);
  std::vector<std::uint32_t> elements(tessellation.elements());
  std::iota(elements.begin(), elements.end(), 0U);
  all.push_back({"our hierarchy, one ray after the other",
                 [&] {
                   scalar_form_factors(own, scene.epsilon(), tessellation, config,
                                       Binning::kPatches, elements);
                 },
                 false});
  add("rtcIntersect1, high, unordered rays", high, unordered, one_by_one, false);
  add("rtcIntersect16, coherent, high, not watertight", fast, rays, by_sixteen, false);

  std::vector<std::function<void()>> runs;
  for (const Contestant& contestant : all) runs.push_back(contestant.run);
  const std::vector<double> seconds = median_seconds(runs, rounds);

  std::size_t best = 2;
  for (std::size_t i = 2; i < all.size(); ++i) {
    if (all[i].same_guarantees && seconds[i] < seconds[best]) best = i;
  }
  report.heading(name);
  const auto rays_m = static_cast<double>(rays.size()) * 1e-6;
  for (std::size_t ours = 0; ours < 2; ++ours) {
    for (std::size_t i = 2; i < all.size(); ++i) {
      if (ours == 1 && i != best) continue;
      report.add({name + ": " + all[ours].name, 1e3 * seconds[ours], all[i].name, 1e3 * seconds[i],
                  "best bare loop: " + all[best].name, 1e3 * seconds[best]});
    }
    report.figure(name + ": " + all[ours].name, rays_m / seconds[ours], "Mray/s");
  }
  report.figure(name + ": " + all[best].name, rays_m / seconds[best], "Mray/s");
}

int run(int argc, char** argv) {
  Report report("bake", argc, argv);
  const std::size_t n = std::stoul(report.option("elements", "20000"));
  const std::size_t k = std::stoul(report.option("patches", "2000"));
  const std::size_t rounds = std::stoul(report.option("rounds", "7"));
  const char* data = std::getenv("RELUMBRE_DATA");
  const TriangleMesh apartment = read_obj_xz(
      std::string(data == nullptr ? "../shared/data" : data) + "/interior/apartment.obj.xz");
  report.note(std::string(RayScene::implementation()) + ", " + std::to_string(thread_count()) +
              " threads, " + std::to_string(kRaysPerElement) + " rays an element");
  if (apartment.triangles.empty()) {
    report.note("RELUMBRE_DATA has no interior/apartment.obj.xz: left out");
  } else {
    compare(report, "apartment", apartment, n, k, rounds);
  }
  compare(report, "furnished hall", furnished_hall(), n, k, rounds);
  compare(report, "two blocks in a room", shapes::blocks_in_room(), 13824, 864, rounds);
  return report.finish();
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  return relumbre::bench::run_benchmark(relumbre::bench::run, argc, argv);
}
