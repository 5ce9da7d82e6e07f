// Compiled once for each instruction set; the one that the machine has is called.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/radiosity/ray_generator.cpp"
#include "relumbre/radiosity/ray_generator.h"

#include <bit>
#include <limits>
#include <numbers>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, RayPacket::kSize>;
using Words = hn::RebindToUnsigned<Floats>;
using Indices = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;

/// Where each lane's ray starts: EmittingSurface's records, transposed.
struct alignas(64) RecordLanes {
  std::array<RayPacket::Lanes, EmittingSurface::kFloats> value;
};

void set_all(RecordLanes& lanes, const EmittingSurface::Record& record) {
  for (std::size_t k = 0; k < record.size(); ++k) lanes.value[k].fill(record[k]);
}

using FacetLanes = std::array<std::int32_t, RayPacket::kSize>;

void gather(const EmittingSurface& surface, const FacetLanes& facet, RecordLanes& lanes) {
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const EmittingSurface::Record& record = surface.records()[static_cast<std::size_t>(facet[i])];
    for (std::size_t k = 0; k < record.size(); ++k) lanes.value[k][i] = record[k];
  }
}

/// Coordinate `d` of the shifted points, at the middles of 2^23 cells of (0, 1).
HWY_INLINE V coordinate(const RayPattern& pattern, const DigitalShift& shift, std::size_t d,
                        std::size_t at) {
  const Words words;
  const auto bits = hn::Xor(hn::LoadU(words, pattern.coordinate(d) + at), hn::Set(words, shift[d]));
  const auto in_1_2 = hn::Or(hn::ShiftRight<9>(bits), hn::Set(words, 0x3F800000U));
  return hn::Sub(hn::BitCast(Floats(), in_1_2), hn::Set(Floats(), 1.0F - 0x1p-24F));
}

/// c0 + x (c1 + x (c2 + ...))
HWY_INLINE V polynomial(V x, std::span<const float> c) {
  V sum = hn::Set(Floats(), c.back());
  for (std::size_t i = c.size() - 1; i-- > 0;) sum = hn::MulAdd(sum, x, hn::Set(Floats(), c[i]));
  return sum;
}

/// Unit square to the cosine hemisphere about +z. On [-π/4, π/4] the Taylor polynomials of sine and
/// cosine are exact to float rounding.
HWY_INLINE void cosine_hemisphere(V u, V v, V& x, V& y, V& z) {
  constexpr std::array<float, 5> sine = {1, -1 / 6.0F, 1 / 120.0F, -1 / 5040.0F, 1 / 362880.0F};
  constexpr std::array<float, 5> cosine = {1, -0.5F, 1 / 24.0F, -1 / 720.0F, 1 / 40320.0F};
  const Floats d;
  const V one = hn::Set(d, 1.0F), two = hn::Set(d, 2.0F);
  const V a = hn::MulSub(two, u, one), b = hn::MulSub(two, v, one);
  const auto wide = hn::Gt(hn::Abs(a), hn::Abs(b));
  const V radius = hn::IfThenElse(wide, a, b), other = hn::IfThenElse(wide, b, a);
  // Neither coordinate is ever 0: they are the middles of cells.
  const V angle = hn::Mul(hn::Div(other, radius), hn::Set(d, std::numbers::pi_v<float> / 4));
  const V square = hn::Mul(angle, angle);
  const V s = hn::Mul(angle, polynomial(square, sine)), c = polynomial(square, cosine);
  x = hn::Mul(radius, hn::IfThenElse(wide, c, s));
  y = hn::Mul(radius, hn::IfThenElse(wide, s, c));
  z = hn::Sqrt(hn::Max(hn::Zero(d), hn::NegMulAdd(radius, radius, one)));
}

/// Chooses each lane's facet by `x` in [0, 1), and stretches x over that facet's share.
HWY_INLINE hn::Vec<Indices> choose_facet(const EmittingSurface& surface, V& x) {
  const Floats d;
  const Indices indices;
  auto facet = hn::Zero(indices);
  for (auto step = static_cast<std::int32_t>(std::bit_ceil(surface.size()) / 2); step > 0;
       step /= 2) {
    const auto candidate = hn::Add(facet, hn::Set(indices, step));
    const V bound = hn::GatherIndex(d, surface.cumulative(), candidate);
    facet = hn::IfThenElse(hn::RebindMask(indices, hn::Ge(x, bound)), candidate, facet);
  }
  const V lower = hn::GatherIndex(d, surface.cumulative(), facet);
  const V upper = hn::GatherIndex(d, surface.cumulative() + 1, facet);
  x = hn::Div(hn::Sub(x, lower), hn::Sub(upper, lower));
  return facet;
}

/// The first half of a packet's work: where its rays start.
struct alignas(64) Starts {
  RayPacket::Lanes x;  ///< coordinate 0, or what is left of it after the choice of the facet
  RecordLanes records;
};

HWY_INLINE void start(const RayPattern& pattern, const EmittingSurface& surface,
                      const DigitalShift& shift, std::size_t at, Starts& starts) {
  const Floats d;
  alignas(64) FacetLanes facet;
  for (std::size_t i = 0; i < RayPacket::kSize; i += hn::Lanes(d)) {
    V x = coordinate(pattern, shift, 0, at + i);
    if (surface.size() > 1) hn::Store(choose_facet(surface, x), Indices(), facet.data() + i);
    hn::Store(x, d, starts.x.data() + i);
  }
  if (surface.size() > 1) gather(surface, facet, starts.records);
}

/// From the normal's own frame, that of base/vec3.h, to the world.
HWY_INLINE void to_world(V nx, V ny, V nz, V& x, V& y, V& z) {
  const Floats d;
  const V one = hn::Set(d, 1.0F), sign = hn::CopySign(one, nz);
  const V a = hn::Neg(hn::Div(one, hn::Add(sign, nz)));
  const V c = hn::Mul(hn::Mul(nx, ny), a);
  const V tx = hn::MulAdd(hn::Mul(sign, nx), hn::Mul(nx, a), one), ty = hn::Mul(sign, c);
  const V tz = hn::Neg(hn::Mul(sign, nx)), by = hn::MulAdd(hn::Mul(ny, ny), a, sign);
  const V wx = hn::MulAdd(x, tx, hn::MulAdd(y, c, hn::Mul(z, nx)));
  const V wy = hn::MulAdd(x, ty, hn::MulAdd(y, by, hn::Mul(z, ny)));
  z = hn::MulAdd(x, tz, hn::NegMulAdd(y, ny, hn::Mul(z, nz)));
  x = wx, y = wy;
}

/// The second half: the rays themselves.
HWY_INLINE void finish(const RayPattern& pattern, const DigitalShift& shift, std::size_t at,
                       const Starts& starts, RayPacket& packet) {
  const Floats d;
  const V half = hn::Set(d, 0.5F);
  for (std::size_t i = 0; i < RayPacket::kSize; i += hn::Lanes(d)) {
    const V p = hn::Load(d, starts.x.data() + i), q = coordinate(pattern, shift, 1, at + i);
    const V fold = hn::Mul(half, hn::Min(p, q));
    const V s = hn::Sub(p, fold), t = hn::Sub(q, fold);
    const auto record = [&](std::size_t k) {
      return hn::Load(d, starts.records.value[k].data() + i);
    };
    V x, y, z;
    cosine_hemisphere(coordinate(pattern, shift, 2, at + i), coordinate(pattern, shift, 3, at + i),
                      x, y, z);
    to_world(record(9), record(10), record(11), x, y, z);
    hn::Store(x, d, packet.direction[0].data() + i);
    hn::Store(y, d, packet.direction[1].data() + i);
    hn::Store(z, d, packet.direction[2].data() + i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const V along2 = hn::MulAdd(t, record(6 + axis), record(axis));
      hn::Store(hn::MulAdd(s, record(3 + axis), along2), d, packet.origin[axis].data() + i);
    }
  }
  packet.t_min.fill(0);
  packet.t_max.fill(std::numeric_limits<float>::infinity());
}

void generate(const RayPattern& pattern, const EmittingSurface& surface, const DigitalShift& shift,
              std::size_t first, std::span<RayPacket> rays) {
  // The next packet is started before this one is finished: wide loads of what was just stored in
  // parts would wait for the stores.
  std::array<Starts, 2> starts;
  for (Starts& s : starts) set_all(s.records, surface.records()[0]);
  start(pattern, surface, shift, RayPacket::kSize * first, starts[0]);
  for (std::size_t p = 0; p < rays.size(); ++p) {
    const std::size_t at = RayPacket::kSize * (first + p);
    if (p + 1 < rays.size()) {
      start(pattern, surface, shift, at + RayPacket::kSize, starts[(p + 1) % 2]);
    }
    finish(pattern, shift, at, starts[p % 2], rays[p]);
  }
}

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumbre {

HWY_EXPORT(generate);

void generate_rays(const RayPattern& pattern, const EmittingSurface& surface,
                   const DigitalShift& shift, std::size_t first, std::span<RayPacket> rays) {
  HWY_DYNAMIC_DISPATCH(generate)(pattern, surface, shift, first, rays);
}

}  // namespace relumbre
#endif
