#include "relumbre/geometry/position_index.h"

#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {
namespace {

TEST(PositionIndex, MatchesAnOrderedMap) {
  PositionIndex index;
  std::map<std::array<float, 3>, std::uint32_t> reference;
  RandomStream random(1);
  const auto coordinate = [&] { return std::round(random.uniform() * 20 - 10); };  // -0 included
  for (int i = 0; i < 20011; ++i) {
    const Vec3f p{coordinate(), coordinate(), coordinate()};
    const auto next = static_cast<std::uint32_t>(reference.size());
    const auto [at, added] = reference.try_emplace({p.x + 0, p.y + 0, p.z + 0}, next);
    EXPECT_EQ(index.find(p), added ? kNone : at->second);
    EXPECT_EQ(index.insert(p), at->second);
  }
  EXPECT_EQ(index.positions().size(), reference.size());
}

TEST(PositionIndex, NanIsAPointLikeAnother) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PositionIndex index;
  EXPECT_EQ(index.insert({nan, 0, 0}), 0U);
  EXPECT_EQ(index.insert({nan, 0, 0}), 0U);
}

TEST(PositionIndex, MidpointsAgreeFromBothEnds) {
  RandomStream random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3f a{random.uniform(), -random.uniform(), 1e-9F * random.uniform()};
    const Vec3f b{random.uniform(), random.uniform(), 1e9F * random.uniform()};
    EXPECT_EQ(midpoint(a, b), midpoint(b, a));
  }
}

}  // namespace
}  // namespace relumbre
