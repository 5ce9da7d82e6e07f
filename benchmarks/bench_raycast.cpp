// Rays through voxels: ours against the thesis's traversals and NanoVDB's marcher on the same
// voxels and rays, and against Embree on the triangles that they were made from.
//
// 1280 x 720 primary rays in squares of 16 x 16 pixels, in Morton order within, and from each hit
// one diffuse ray out of the voxel's face. Everything runs on all threads, the same rays in the
// same order, made beforehand. A trace from the root of the octree of words decides what is right.
#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "bare_embree.h"
#include "nanovdb_peer.h"
#include "packed_scene.h"
#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/octree/cast_kernels.h"
#include "relumbre/octree/traverse.h"
#include "relumbre/octree/tree_cast.h"
#include "relumbre/render/camera_rays.h"
#include "report.h"
#include "voxel_scene.h"

namespace relumbre::bench {
namespace {

constexpr std::size_t kWidth = 1280, kHeight = 720, kGrain = 4096;

// ------------------------------------------------------------------------------------ the rays

/// The same rays in voxels and in metres; a number that 16 divides.
struct Rays {
  std::vector<CastRay> voxels;
  std::vector<Ray> metres;
  double pixel = 0;  ///< voxels that one is wide, per t; none of diffuse rays
};

void add(Rays& rays, const VoxelTree& tree, const Ray& ray) {
  const double scale = std::ldexp(1.0, static_cast<int>(tree.depth())) / tree.cube().edge;
  rays.metres.push_back(ray);
  rays.voxels.push_back({.origin = tree.cube().to_voxels(Vec3d(ray.origin), tree.depth()),
                         .direction = Vec3d(ray.direction) * scale});
}

Rays primary_rays(const Scene& scene, const VoxelTree& tree) {
  constexpr std::size_t kTile = 16;
  const CameraRays camera(near_camera(scene), kWidth, kHeight);
  Rays rays;
  rays.pixel = std::ldexp(1.0, static_cast<int>(tree.depth())) / tree.cube().edge /
               camera.pixels_per_tangent();
  for (std::size_t y = 0; y < kHeight; y += kTile)
    for (std::size_t x = 0; x < kWidth; x += kTile)
      for (std::uint32_t i = 0; i < kTile * kTile; ++i) {
        std::size_t column = 0, row = 0;
        for (unsigned bit = 0; bit < 4; ++bit) {
          column |= (i >> 2 * bit & 1U) << bit;
          row |= (i >> (2 * bit + 1) & 1U) << bit;
        }
        add(rays, tree,
            camera.through(static_cast<float>(x + column) + 0.5F,
                           static_cast<float>(y + row) + 0.5F));
      }
  return rays;
}

/// From where the ray comes into the voxel, about the face's normal.
CastRay diffuse_ray(const CastRay& ray, const VoxelHit& hit, RandomStream& random) {
  const auto axis = static_cast<std::size_t>(hit.axis);
  const bool is_up = ray.direction[axis] > 0;
  const Vec3d lower(hit.cell.x, hit.cell.y, hit.cell.z);
  Vec3d origin = ray.origin + ray.direction * hit.t;
  origin[axis] = lower[axis] + (is_up ? 0 : 1);
  const float u = random.uniform(), v = random.uniform();
  const Vec3d local(square_to_cosine_hemisphere(u, v));
  Vec3d direction;
  direction[axis] = is_up ? -local.z : local.z;
  direction[(axis + 1) % 3] = local.x, direction[(axis + 2) % 3] = local.y;
  return {.origin = origin, .direction = direction};
}

Rays diffuse_rays(const VoxelTree& tree, const Rays& primary) {
  const double metres = tree.cube().edge / std::ldexp(1.0, static_cast<int>(tree.depth()));
  std::vector<TreeHit> hits(primary.voxels.size());
  cast(tree, primary.voxels, hits);
  Rays rays;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i] || hits[i].voxel.axis < 0) continue;
    RandomStream random(i);
    const CastRay ray = diffuse_ray(primary.voxels[i], hits[i].voxel, random);
    rays.voxels.push_back(ray);
    rays.metres.push_back({.origin = Vec3f(tree.cube().corner + ray.origin * metres),
                           .direction = Vec3f(ray.direction * metres)});
  }
  const std::size_t count = rays.voxels.size() / 16 * 16;
  rays.voxels.resize(count), rays.metres.resize(count);
  return rays;
}

// --------------------------------------------------------------------------------- the contest

Octree words_of(const VoxelTree& tree) {
  return {voxel_codes(tree), static_cast<int>(tree.depth())};
}

struct Contestant {
  std::string name;
  std::function<void()> run;
};

class Contest {
 public:
  Contest(Report& report, const Scene& scene, const VoxelTree& tree)
      : report_(report),
        tree_(tree),
        words_(words_of(tree)),
        triangles_(scene.mesh, RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_NONE) {
    if (NanoVdbPeer::is_there()) nanovdb_ = std::make_unique<NanoVdbPeer>(tree);
  }

  void compare(const std::string& name, const Rays& rays) {
    hits_.resize(rays.voxels.size());
    cells_.resize(rays.voxels.size());
    const std::vector<Contestant> all = contestants(rays);
    std::vector<std::function<void()>> runs;
    for (const Contestant& contestant : all) runs.push_back(contestant.run);
    const std::vector<double> seconds = median_seconds(runs, 3);
    report_.heading(name);
    for (std::size_t i = 1; i < all.size(); ++i)
      report_.add({name, 1e3 * seconds[0], all[i].name, 1e3 * seconds[i], {}, kNotMeasured});
    const auto rays_m = static_cast<double>(rays.voxels.size()) * 1e-6;
    for (std::size_t i = 0; i < all.size(); ++i)
      report_.figure(name + ": " + all[i].name, rays_m / seconds[i], "Mray/s");
    report_.figure(name + ": rays", rays_m * 1e6, "");
    check(name, rays);
  }

 private:
  std::vector<Contestant> contestants(const Rays& rays) {
    std::vector<Contestant> all = {{"ours, batch", [&] { cast(tree_, rays.voxels, hits_); }},
                                   {"ours, one by one", [&] {
                                      parallel_for(0, hits_.size(), kGrain, [&](std::size_t i) {
                                        const CastRay& ray = rays.voxels[i];
                                        hits_[i] = cast(tree_, ray);
                                      });
                                    }}};
    for (const CastKernel& kernel : available_cast_kernels()) {
      if (kernel.name != "AVX2" || kernel.name == best_cast_kernel().name) continue;
      all.push_back({"ours, AVX2", [&, kernel] {
                       parallel_chunks(0, hits_.size(), kGrain, [&](std::size_t a, std::size_t b) {
                         kernel.cast(tree_, std::span(rays.voxels).subspan(a, b - a),
                                     std::span(hits_).subspan(a, b - a));
                       });
                     }});
    }
    if (rays.pixel > 0) {
      widened_ = rays.voxels;
      for (CastRay& ray : widened_) ray.spread = rays.pixel;
      all.push_back({"ours, nodes of up to a pixel", [&] { cast(tree_, widened_, hits_); }});
    }
    if (nanovdb_) {
      all.push_back({"NanoVDB", [&] {
                       parallel_chunks(0, cells_.size(), kGrain, [&](std::size_t a, std::size_t b) {
                         nanovdb_->cast(std::span(rays.voxels).subspan(a, b - a),
                                        std::span(cells_).subspan(a, b - a));
                       });
                     }});
    }
    add_embree(all, rays, "Embree, one by one", one_by_one);
    add_embree(all, rays, "Embree, 16", by_sixteen_incoherent);
    add_embree(all, rays, "Embree, 16, coherent", by_sixteen);
    add_words(all, rays, "restart", {Traversal::Kind::kRestart});
    add_words(all, rays, "backtrack", {Traversal::Kind::kBacktrack});
    add_words(all, rays, "full stack", {Traversal::Kind::kFullStack});
    add_words(all, rays, "short stack of 4", {Traversal::Kind::kShortStack, 4});
    return all;
  }

  void add_embree(std::vector<Contestant>& all, const Rays& rays, const char* name, Loop loop) {
    all.push_back({name, [&, loop] {
                     parallel_chunks(
                         0, rays.metres.size(), kGrain, [&](std::size_t a, std::size_t b) {
                           loop(triangles_.get(), std::span(rays.metres).subspan(a, b - a));
                         });
                   }});
  }

  void add_words(std::vector<Contestant>& all, const Rays& rays, const char* name,
                 const Traversal& traversal) {
    all.push_back({name, [&, traversal] { words(rays, traversal); }});
  }

  void words(const Rays& rays, const Traversal& traversal) {
    expected_.resize(rays.voxels.size());
    parallel_for(0, expected_.size(), kGrain, [&](std::size_t i) {
      expected_[i] =
          trace(words_, GridRay(rays.voxels[i].origin, rays.voxels[i].direction), traversal);
    });
  }

  /// Every ray of ours and of NanoVDB's against the trace with a full stack.
  void check(const std::string& name, const Rays& rays) {
    words(rays, {Traversal::Kind::kFullStack});
    std::size_t found = 0, wrong_batch = 0, wrong_single = 0, wrong_nanovdb = 0;
    cast(tree_, rays.voxels, hits_);
    if (nanovdb_) nanovdb_->cast(rays.voxels, cells_);
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const auto& expected = expected_[i];
      const CastRay& ray = rays.voxels[i];
      const TreeHit single = cast(tree_, ray);
      const auto differs = [&](const TreeHit& hit) {
        return bool{hit} != expected.has_value() || (expected && hit.voxel != *expected);
      };
      found += expected.has_value();
      wrong_batch += differs(hits_[i]);
      wrong_single += differs(single) || single != hits_[i];
      wrong_nanovdb += cells_[i] != (expected ? expected->cell : NanoVdbPeer::kMiss);
    }
    report_.figure(name + ": rays that hit", static_cast<double>(found), "");
    report_.figure(name + ": wrong, ours, batch", static_cast<double>(wrong_batch), "");
    report_.figure(name + ": wrong, ours, one by one", static_cast<double>(wrong_single), "");
    if (nanovdb_) report_.figure(name + ": wrong, NanoVDB", static_cast<double>(wrong_nanovdb), "");
  }

  Report& report_;
  const VoxelTree& tree_;
  Octree words_;
  BareScene triangles_;
  std::unique_ptr<NanoVdbPeer> nanovdb_;
  std::vector<CastRay> widened_;
  std::vector<TreeHit> hits_;
  std::vector<Cell> cells_;
  std::vector<std::optional<VoxelHit>> expected_;
};

void compare(Report& report, const std::string& name, const Scene& scene, unsigned depth) {
  const std::string label = fmt::format("{}, depth {}", name, depth);
  if (report.option("only", label) != label) return;
  const VoxelTree tree = build_voxels(scene, {.depth = depth, .surface = {}});
  report.figure(label + ": bytes a voxel",
                static_cast<double>(tree.geometry_bytes()) / static_cast<double>(tree.voxels()),
                "");
  Contest contest(report, scene, tree);
  const Rays primary = primary_rays(scene, tree);
  contest.compare(label + ", primary", primary);
  contest.compare(label + ", diffuse", diffuse_rays(tree, primary));
}

// -------------------------------------------------------------------- against a walk of all voxels

/// The first voxel by the definition of a hit (grid_ray.h) alone: every voxel is compared with the
/// ray, by the times at which it passes the grid's planes.
class BruteForce {
 public:
  explicit BruteForce(const VoxelTree& tree) : edge_(std::size_t{1} << tree.depth()) {
    for (const std::uint64_t code : voxel_codes(tree)) cells_.push_back(morton_decode(code));
  }

  [[nodiscard]] std::optional<VoxelHit> first_hit(const GridRay& ray) const {
    std::array<std::vector<double>, 3> near, far;  // of the cells of a coordinate
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < edge_; ++k) {
        const auto time = [&](std::size_t plane) {
          return (static_cast<double>(plane) - ray.origin()[axis]) * ray.inverse()[axis];
        };
        near[axis].push_back(std::min(time(k), time(k + 1)));
        far[axis].push_back(std::max(time(k), time(k + 1)));
      }
    }
    const Cell* first = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const Cell& c : cells_) {
      const double enter = std::max({0.0, near[0][c.x], near[1][c.y], near[2][c.z]});
      const double exit = std::min({far[0][c.x], far[1][c.y], far[2][c.z]});
      if (enter < exit && enter < least) least = enter, first = &c;
    }
    return first != nullptr ? intersect_voxel(ray, *first) : std::nullopt;
  }

 private:
  std::size_t edge_;
  std::vector<Cell> cells_;
};

/// A million random rays through the cube of this edge and around it, and a tenth as many along
/// axes, faces, edges and diagonals of cells and through their corners.
std::vector<CastRay> rays_of_all_sorts(double edge) {
  std::vector<CastRay> rays(1'100'000);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RandomStream random(i);
    const auto point = [&] { return Vec3d(random.uniform(), random.uniform(), random.uniform()); };
    const auto whole = [](Vec3d p) {
      return Vec3d(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    };
    const Vec3d from = point() * 2.0 * edge - Vec3d(edge / 2), to = point() * edge;
    if (i % 11 != 10)
      rays[i] = {.origin = from, .direction = to - from};
    else  // from multiples of a half, by -1, 0 or 1 along each axis
      rays[i] = {.origin = whole(from * 2.0) / 2.0, .direction = whole(point() * 3.0) - Vec3d(1)};
  }
  return rays;
}

/// Every traversal on the bunny at depth 7.
void check_all_voxels(Report& report, const Scene& scene) {
  const VoxelTree tree = build_voxels(scene, {.depth = 7, .surface = {}});
  const Octree words = words_of(tree);
  const BruteForce brute_force(tree);
  const std::vector<CastRay> rays = rays_of_all_sorts(128);
  std::vector<std::optional<VoxelHit>> expected(rays.size());
  parallel_for(0, rays.size(), 64, [&](std::size_t i) {
    expected[i] = brute_force.first_hit(GridRay(rays[i].origin, rays[i].direction));
  });
  const std::string label = "bunny, depth 7, every voxel against every ray: ";
  const auto count = [&](const std::string& name, const auto& hit) {
    std::atomic<std::size_t> wrong = 0;
    parallel_for(0, rays.size(), kGrain, [&](std::size_t i) { wrong += hit(i) != expected[i]; });
    report.figure(label + name + ", wrong", static_cast<double>(wrong), "");
  };
  const auto voxel = [](const TreeHit& hit) {
    return hit ? std::optional(hit.voxel) : std::nullopt;
  };
  std::vector<TreeHit> hits(rays.size());
  cast(tree, rays, hits);
  report.figure(label + "rays", static_cast<double>(rays.size()), "");
  report.figure(label + "hits",
                static_cast<double>(std::ranges::count_if(
                    expected, [](const auto& hit) { return hit.has_value(); })),
                "");
  count("ours, batch", [&](std::size_t i) { return voxel(hits[i]); });
  count("ours, one by one", [&](std::size_t i) { return voxel(cast(tree, rays[i])); });
  using enum Traversal::Kind;
  const std::pair<const char*, Traversal> kTraversals[] = {{"restart", {kRestart}},
                                                           {"backtrack", {kBacktrack}},
                                                           {"full stack", {kFullStack}},
                                                           {"short stack of 4", {kShortStack, 4}}};
  for (const auto& [name, traversal] : kTraversals)
    count(name, [&, t = traversal](std::size_t i) {
      return trace(words, GridRay(rays[i].origin, rays[i].direction), t);
    });
}

int run(int argc, char** argv) {
  Report report("raycast", argc, argv);
  const auto bunny = read_packed_scene("stanford/bun_zipper.ply");
  const auto dragon = read_packed_scene("stanford/dragon_q11.ply");
  if (!bunny || !dragon) {
    report.note("skipped: RELUMBRE_DATA has no stanford/bun_zipper.ply.xz, dragon_q11.ply.xz");
    return report.finish();
  }
  if (!NanoVdbPeer::is_there()) report.note("built without libnanovdb-dev: that peer is left out");
  compare(report, "bunny", *bunny, 10);
  compare(report, "dragon", *dragon, 10);
  compare(report, "dragon", *dragon, 11);
  check_all_voxels(report, *bunny);
  return report.finish();
}

}  // namespace
}  // namespace relumbre::bench

int main(int argc, char** argv) {
  return relumbre::bench::run_benchmark(relumbre::bench::run, argc, argv);
}
