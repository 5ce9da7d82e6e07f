/// The store: one HDF5 file a baked scene.
///
/// n elements, k patches, t triangles, v vertices, f facets. Arrays are chunked, shuffled, deflated
/// and followed by Fletcher-32 checksums; numbers are little-endian. A seal lies in the first 512
/// bytes (seal.h), which HDF5 skips.
///
///   /                     attributes format = "relumbre-store", version = 1, producer
///   /settings             attributes scene, method ("hierarchy" | "cluster"), patches, elements,
///                         rays, seed
///   /scene                attribute geometry_hash
///     positions           f32 (v, 3)     metres
///     triangles           u32 (t, 3)     counter-clockwise from the front
///     material, object    u32 (t)        into the lists of description
///     two_sided           u8 (t)
///     texcoords           f32 (v, 2)     or (0, 2)
///     shading_normals     f32 (v, 3)     or (0, 3)
///     colors              f32 (v, 3)     or (0, 3), or missing: factors of the reflectance
///     description         text           materials, objects, textures, lights, cameras as JSON
///                                        (scene_json.h)
///   /textures
///     0, 1, ...           u8 (h, w, 3)   sRGB
///   /elements             ordered by patch
///     positions           f32 (·, 3)     corners of facets
///     facets              u32 (f, 5)     three corners, source triangle, 1 for its back
///     facet_offsets       u32 (n + 1)    facets of element i: [facet_offsets[i], [i + 1])
///     patch_offsets       u32 (k + 1)    elements of patch p: [patch_offsets[p], [p + 1])
///     patch               u32 (n)        the same, patch of each element
///     area                f32 (n)        m²
///     centroid, normal    f32 (n, 3)
///     reflectance         f32 (n, 3)     linear Rec. 709
///     emission            f32 (n, 3)     W/m²
///     locator_roots       i32 (2t)       FacetLocator
///     locator_nodes       i32 (·)
///   /counts               attributes rays, columns = k
///     row_offsets         u64 (n + 1)    row i: [row_offsets[i], [i + 1]) of the next two
///     patch               u16 (nnz)      ascending in a row; u32 where k > 65,536
///     count               u16 (nnz)      rays of element i that arrived at that patch; u32 where
///     one
///                                        exceeds 65,535
///   /energy               attributes: the fields of EnergyReport
///
/// F_{i→p} = count / rays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "relumbre/base/progress.h"
#include "relumbre/store/baked_scene.h"

namespace relumbre {

/// Counts that are handed over in blocks of consecutive rows, so that they need not be in memory.
struct CountsStream {
  std::uint64_t rows = 0, columns = 0;
  std::uint32_t rays = 0;
  std::uint64_t nonzeros = 0;
  std::uint32_t largest_count = 0;
  /// Calls the visitor with each block, in order.
  std::function<void(const std::function<void(const SparseCounts&)>&)> for_each_block;
};

/// A BakedScene in parts that stay where they are.
struct StoreContents {
  const Scene& scene;
  const Tessellation& tessellation;
  std::span<const Rgb> reflectance, emission;
  const BakeSettings& settings;
  const EnergyReport& energy;
  CountsStream counts;
};

/// Writes the store; it appears whole or not at all. Needs a few MB beside what it is given.
/// Throws FileError naming the file (a full disk, an unwritable folder), ValueError where the
/// contents break what validate() asks for, Cancelled.
void write_store(const std::filesystem::path& file, const StoreContents& contents,
                 Progress& progress = no_progress());
void write_store(const std::filesystem::path& file, const BakedScene& baked,
                 Progress& progress = no_progress());

/// Reads and validates the whole store. Throws FileError: missing, not a store, of a newer version,
/// truncated, altered, or breaking any rule of validate().
BakedScene read_store(const std::filesystem::path& file);

/// What a store holds, without its arrays.
struct StoreSummary {
  BakeSettings settings;
  EnergyReport energy;
  std::uint64_t triangles = 0, vertices = 0, facets = 0;
  std::uint64_t nonzeros = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t geometry_hash = 0;
  std::uint64_t content_hash = 0;  ///< of the whole file: tells stores apart
  /// Names and values only: no arrays, no texels.
  Scene description;
};

/// Reads the file once to verify its seal, and little of it after that. Throws like read_store.
StoreSummary read_store_summary(const std::filesystem::path& file);

}  // namespace relumbre
