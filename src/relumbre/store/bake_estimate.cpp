#include <algorithm>

#include "relumbre/base/parallel.h"
#include "relumbre/store/bake.h"

namespace relumbre {

namespace {

// Measured on rooms, an apartment and teapots of 36 to 520,000 triangles, rounded up.
constexpr std::uint64_t kCutBytesPerFacet = 200;        // 150 to 200 while clustering
constexpr std::uint64_t kTracerBytesPerTriangle = 160;  // Embree's high-quality build: 110 to 150
constexpr std::uint64_t kProgramBytes = 48 << 20;       // of a small bake's peak: 30 to 45 MB
constexpr std::uint64_t kFixedDiskBytes = 4 << 20;

// What trace_form_factors() promises: tasks of 4 rows, at most 64 a thread, two waves of them.
constexpr std::uint64_t kRowsInFlightPerThread = 2 * 64 * 4;

constexpr std::uint64_t kBytesPerCount = 8;      // SparseCounts
constexpr std::uint64_t kBytesPerExchange = 16;  // a pair of patches, in EnergyAudit

template <class T>
std::uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::uint64_t scene_bytes(const Scene& scene) {
  const TriangleMesh& mesh = scene.mesh;
  std::uint64_t bytes = bytes_of(mesh.positions) + bytes_of(mesh.triangles) +
                        bytes_of(mesh.material) + bytes_of(mesh.object) + bytes_of(mesh.two_sided) +
                        bytes_of(scene.texcoords) + bytes_of(scene.shading_normals) +
                        bytes_of(scene.colors);
  for (const Texture& texture : scene.textures) bytes += bytes_of(texture.rgb);
  return bytes;
}

/// Every reflecting side is a facet; reaching n elements cuts about n / 2 facets into four.
std::uint64_t expected_facets(const Scene& scene, std::uint64_t elements) {
  const auto two_sided = static_cast<std::uint64_t>(
      std::count(scene.mesh.two_sided.begin(), scene.mesh.two_sided.end(), 1));
  return scene.mesh.triangles.size() + two_sided + elements * 3 / 2;
}

/// Facets with half a corner each, locator, and what an element has of its own.
std::uint64_t tessellation_bytes(std::uint64_t facets, std::uint64_t triangles,
                                 std::uint64_t elements) {
  constexpr std::uint64_t facet = sizeof(Facet) + sizeof(Vec3f) / 2;
  constexpr std::uint64_t element = 2 * sizeof(std::uint32_t) + 4 * sizeof(Vec3f) + 16 / 2;
  return facets * facet + triangles * 2 * sizeof(std::int32_t) + elements * element;
}

/// Columns, counts and row lengths of the journal; the same again in the store, which only shrinks.
std::uint64_t counts_on_disk(const BakeConfig& config, std::uint64_t nonzeros) {
  const std::uint64_t entry = (config.patches <= 65536 ? 2 : 4) + (config.rays <= 65535 ? 2 : 4);
  return 2 * nonzeros * entry + config.elements * (sizeof(std::uint32_t) + sizeof(std::uint64_t));
}

}  // namespace

BakeEstimate estimate_bake(const Scene& scene, const BakeConfig& config) {
  const std::uint64_t triangles = scene.mesh.triangles.size();
  const std::uint64_t facets = expected_facets(scene, config.elements);
  const std::uint64_t row = std::min<std::uint64_t>(config.rays, config.patches);
  const std::uint64_t nonzeros = config.elements * row;
  const std::uint64_t rows_in_flight = thread_count() * kRowsInFlightPerThread + config.row_block;
  const std::uint64_t pairs =
      std::min<std::uint64_t>(nonzeros, std::uint64_t{config.patches} * config.patches);

  BakeEstimate estimate;
  estimate.program_bytes = kProgramBytes;
  estimate.scene_bytes = scene_bytes(scene);
  estimate.tessellation_bytes = tessellation_bytes(facets, triangles, config.elements);
  estimate.tessellate_bytes = facets * kCutBytesPerFacet;
  estimate.trace_bytes =
      triangles * kTracerBytesPerTriangle + facets * sizeof(std::uint32_t) +
      std::min<std::uint64_t>(rows_in_flight, config.elements) * row * kBytesPerCount +
      thread_count() * config.patches * sizeof(std::uint32_t);
  estimate.counts_bytes = nonzeros * kBytesPerCount + config.elements * sizeof(std::uint64_t);
  estimate.report_bytes = pairs * kBytesPerExchange + config.row_block * row * kBytesPerCount;
  estimate.disk_bytes = kFixedDiskBytes + estimate.scene_bytes + estimate.tessellation_bytes +
                        counts_on_disk(config, nonzeros);
  return estimate;
}

}  // namespace relumbre
