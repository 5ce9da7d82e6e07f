#include "relumbre/base/vec3.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/box.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

TEST(Vec3, CrossIsPerpendicularToBoth) {
  const Vec3d a{1, 2, 3}, b{-4, 0.5, 2};
  EXPECT_EQ(dot(cross(a, b), a), 0);
  EXPECT_EQ(dot(cross(a, b), b), 0);
  EXPECT_EQ(cross(Vec3d{1, 0, 0}, Vec3d{0, 1, 0}), (Vec3d{0, 0, 1}));
}

TEST(Vec3, NormalizedHasUnitLengthAndKeepsZero) {
  EXPECT_NEAR(length(normalized(Vec3f{3, -4, 12})), 1, 1e-6);
  EXPECT_EQ(normalized(Vec3f{}), Vec3f{});
}

TEST(Vec3, ArithmeticIsComponentwise) {
  const Vec3f a{1, 2, 3}, b{4, 5, 6};
  EXPECT_EQ(a + b, (Vec3f{5, 7, 9}));
  EXPECT_EQ(b - a, (Vec3f{3, 3, 3}));
  EXPECT_EQ(a * b, (Vec3f{4, 10, 18}));
  EXPECT_EQ(2.0F * a / 2.0F, a);
  EXPECT_EQ(-a, (Vec3f{-1, -2, -3}));
  EXPECT_EQ(max_component(b), 6);
}

TEST(Vec3, LuminanceOfWhiteIsOne) { EXPECT_NEAR(luminance(Vec3d(1.0)), 1, 1e-12); }

TEST(Vec3, NonFiniteComponentIsSeen) {
  EXPECT_TRUE(is_finite(Vec3f{1, 2, 3}));
  EXPECT_FALSE(is_finite(Vec3f{1, std::numeric_limits<float>::quiet_NaN(), 3}));
  EXPECT_FALSE(is_finite(Vec3f{1, 2, std::numeric_limits<float>::infinity()}));
}

void expect_right_handed(const Vec3f& n) {
  const Frame f(n);
  EXPECT_NEAR(length(f.t), 1, 1e-5);
  EXPECT_NEAR(length(f.b), 1, 1e-5);
  EXPECT_NEAR(dot(f.t, f.b), 0, 1e-5);
  EXPECT_NEAR(dot(f.t, f.n), 0, 1e-5);
  EXPECT_NEAR(dot(f.b, f.n), 0, 1e-5);
  EXPECT_NEAR(length(cross(f.t, f.b) - f.n), 0, 1e-5);
}

TEST(Frame, IsRightHandedAndOrthonormalForEveryNormal) {
  for (const float s : {1.0F, -1.0F}) {
    expect_right_handed({s, 0, 0});
    expect_right_handed({0, s, 0});
    expect_right_handed({0, 0, s});
    expect_right_handed(normalized(Vec3f{1e-4F, -1e-4F, s}));
    expect_right_handed(normalized(Vec3f{1, 1, s * 1e-7F}));
  }
  RandomStream random(1);
  for (int i = 0; i < 1000; ++i) {
    const float u = random.uniform(), v = random.uniform();
    expect_right_handed(normalized(square_to_sphere(u, v)));
  }
}

TEST(Frame, TakesZToItsNormal) {
  const Vec3f n = normalized(Vec3f{1, -2, -3});
  EXPECT_NEAR(length(Frame(n).to_world({0, 0, 1}) - n), 0, 1e-6);
}

TEST(Box, HoldsItsPointsAndNoMore) {
  const std::vector<Vec3f> points = {{1, 5, -2}, {0, 7, 3}};
  const Box box = bounds(points);
  EXPECT_EQ(box.lower, (Vec3f{0, 5, -2}));
  EXPECT_EQ(box.upper, (Vec3f{1, 7, 3}));
  EXPECT_TRUE(Box{}.empty());
  EXPECT_EQ(Box{}.size(), Vec3f{});
}

}  // namespace
}  // namespace relumbre
