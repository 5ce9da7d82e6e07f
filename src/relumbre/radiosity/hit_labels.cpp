// Compiled once for each instruction set; the one that the machine has is called.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "relumbre/radiosity/hit_labels.cpp"
#include "relumbre/radiosity/hit_labels.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumbre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, RayPacket::kSize>;
using Indices = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using I = hn::Vec<Indices>;

/// enter_child() of geometry/descend.h, lane by lane. All its products and sums are exact but
/// 1-u-v, which is rounded in the same order, so that the choices are the same.
HWY_INLINE I enter_child(V& u, V& v) {
  const Floats d;
  const Indices indices;
  const V half = hn::Set(d, 0.5F), one = hn::Set(d, 1.0F), zero = hn::Zero(d);
  const auto at_b = hn::Ge(u, half);
  const auto at_c = hn::AndNot(at_b, hn::Ge(v, half));
  const auto at_a = hn::AndNot(hn::Or(at_b, at_c), hn::Ge(hn::Sub(hn::Sub(one, u), v), half));
  const auto middle = hn::Not(hn::Or(at_a, hn::Or(at_b, at_c)));
  const V scale = hn::IfThenElse(middle, hn::Set(d, -2.0F), hn::Set(d, 2.0F));
  const V add = hn::IfThenElse(middle, one, zero);
  u = hn::Add(hn::Mul(scale, u), hn::IfThenElse(at_b, hn::Neg(one), add));
  v = hn::Add(hn::Mul(scale, v), hn::IfThenElse(at_c, hn::Neg(one), add));
  I child = hn::IfThenElse(hn::RebindMask(indices, middle), hn::Set(indices, 3), hn::Zero(indices));
  child = hn::IfThenElse(hn::RebindMask(indices, at_b), hn::Set(indices, 1), child);
  return hn::IfThenElse(hn::RebindMask(indices, at_c), hn::Set(indices, 2), child);
}

/// The negative entry that each lane's descent ends at.
HWY_INLINE I descend(const std::int32_t* nodes, I node, V u, V v) {
  const Indices indices;
  const I minus_one = hn::Set(indices, -1);
  for (auto inner = hn::Gt(node, minus_one); !hn::AllFalse(indices, inner);
       inner = hn::Gt(node, minus_one)) {
    const I block = hn::ShiftLeft<2>(hn::IfThenElseZero(inner, node));
    const I next = hn::GatherIndex(indices, nodes, hn::Add(block, enter_child(u, v)));
    node = hn::IfThenElse(inner, next, node);
  }
  return node;
}

void find(const LabelLocator& locator, const HitPacket& hits, HitLabels& labels) {
  const Floats d;
  const Indices indices;
  // Lanes that are done from the start carry ~label: negative, like a leaf.
  const I escaped = hn::Set(indices, ~static_cast<std::int32_t>(kEscaped));
  const I absorbed = hn::Set(indices, ~static_cast<std::int32_t>(kAbsorbed));
  for (std::size_t i = 0; i < labels.size(); i += hn::Lanes(d)) {
    const auto load = [&](const auto& lanes) {
      return hn::BitCast(indices, hn::Load(hn::RebindToUnsigned<Floats>(), lanes.data() + i));
    };
    const I triangle = load(hits.triangle), back = load(hits.back);
    const auto hit = hn::Gt(triangle, hn::Set(indices, -1));
    const I side = hn::Add(hn::ShiftLeft<1>(triangle), back);
    const I root = hn::GatherIndex(indices, locator.roots.data(), hn::IfThenElseZero(hit, side));
    const auto missing = hn::Eq(root, hn::Set(indices, FacetLocator::kMissing));
    I node = hn::IfThenElse(missing, absorbed, root);
    node = hn::IfThenElse(hit, node, escaped);
    const V u = hn::Load(d, hits.u.data() + i), v = hn::Load(d, hits.v.data() + i);
    const auto turned = hn::RebindMask(d, hn::Ne(back, hn::Zero(indices)));
    node = descend(locator.nodes.data(), node, hn::IfThenElse(turned, v, u),
                   hn::IfThenElse(turned, u, v));
    hn::Store(hn::BitCast(hn::RebindToUnsigned<Floats>(), hn::Not(node)),
              hn::RebindToUnsigned<Floats>(), labels.data() + i);
  }
}

}  // namespace
}  // namespace relumbre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumbre {

HWY_EXPORT(find);

void find_labels(const LabelLocator& locator, const HitPacket& hits, HitLabels& labels) {
  HWY_DYNAMIC_DISPATCH(find)(locator, hits, labels);
}

}  // namespace relumbre
#endif
