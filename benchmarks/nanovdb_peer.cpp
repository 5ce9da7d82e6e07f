#include "nanovdb_peer.h"

#ifdef RELUMBRE_BENCH_NANOVDB

#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/Ray.h>

namespace relumbre::bench {

namespace {

using Ray = nanovdb::Ray<float>;

nanovdb::GridHandle<> build(const VoxelTree& tree) {
  // Its builder makes no grids of masks alone; marching reads no values.
  nanovdb::GridBuilder<float, nanovdb::Fp4> builder(0);
  auto accessor = builder.getAccessor();
  for_each_voxel(tree, [&](std::uint64_t code, std::uint64_t) {
    const Cell c = morton_decode(code);
    accessor.setValue({static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)}, 1.0F);
  });
  return builder.getHandle<>();
}

nanovdb::Vec3f vector(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

struct NanoVdbPeer::Impl {
  nanovdb::GridHandle<> handle;
};

NanoVdbPeer::NanoVdbPeer(const VoxelTree& tree) : impl_(new Impl{build(tree)}) {}
NanoVdbPeer::~NanoVdbPeer() = default;

bool NanoVdbPeer::is_there() { return true; }

void NanoVdbPeer::cast(std::span<const CastRay> rays, std::span<Cell> cells) const {
  auto accessor = impl_->handle.grid<nanovdb::Fp4>()->tree().getAccessor();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray ray(vector(rays[i].origin), vector(normalized(rays[i].direction)));  // it moves on by t + 1
    nanovdb::Coord ijk;
    float t = 0;
    const bool is_hit = nanovdb::firstActive(ray, accessor, ijk, t);
    cells[i] = is_hit ? Cell{static_cast<std::uint32_t>(ijk[0]), static_cast<std::uint32_t>(ijk[1]),
                             static_cast<std::uint32_t>(ijk[2])}
                      : kMiss;
  }
}

}  // namespace relumbre::bench

#else

namespace relumbre::bench {

struct NanoVdbPeer::Impl {};
NanoVdbPeer::NanoVdbPeer(const VoxelTree&) {}
NanoVdbPeer::~NanoVdbPeer() = default;
bool NanoVdbPeer::is_there() { return false; }
void NanoVdbPeer::cast(std::span<const CastRay>, std::span<Cell>) const {}

}  // namespace relumbre::bench

#endif
