#include "relumbre/dof/surface_edges.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace relumbre {
namespace {

constexpr std::array<std::array<int, 2>, 8> kNeighbours{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

struct Circles {
  std::size_t width, height;
  std::vector<float> values;

  Circles(std::size_t w, std::size_t h) : width(w), height(h), values(w * h) {}
  template <class Function>
  Circles(std::size_t w, std::size_t h, Function&& at) : Circles(w, h) {
    for (std::size_t i = 0; i < w * h; ++i)
      values[i] = at(static_cast<float>(i % w), static_cast<float>(i / w));
  }
  [[nodiscard]] SurfaceEdges edges() const { return {values, width, height}; }
};

std::size_t jumps(const Circles& circles) {
  const SurfaceEdges edges = circles.edges();
  std::size_t count = 0;
  for (std::size_t i = 0; i < circles.values.size(); ++i)
    for (const auto& [dx, dy] : kNeighbours)
      count += edges.jump(i % circles.width, i / circles.width, dx, dy) ? 1 : 0;
  return count;
}

/// True if the line through a pixel and its neighbour has a third pixel, from which it can be told
/// whether a step goes on. Diagonals across a corner have none.
bool goes_on(const Circles& circles, std::size_t i, int dx, int dy) {
  const auto inside = [&](int steps) {
    const int x = static_cast<int>(i % circles.width) + steps * dx,
              y = static_cast<int>(i / circles.width) + steps * dy;
    return x >= 0 && y >= 0 && x < static_cast<int>(circles.width) &&
           y < static_cast<int>(circles.height);
  };
  return inside(-1) || inside(2);
}

TEST(SurfaceEdges, APlaneHasNoJumpHoweverSteep) {
  for (const float right : {0.0F, 1.0F, 5.0F, -40.0F}) {
    for (const float down : {0.0F, 0.7F, -3.0F, 100.0F}) {
      const Circles circles(23, 17, [&](float x, float y) { return 3 + right * x + down * y; });
      const SurfaceEdges edges = circles.edges();
      for (std::size_t i = 0; i < circles.values.size(); ++i) {
        for (const auto& [dx, dy] : kNeighbours) {
          if (!goes_on(circles, i, dx, dy)) continue;
          ASSERT_FALSE(edges.jump(i % 23, i / 23, dx, dy)) << right << "," << down << " " << i;
        }
        const Vec2f slope = edges.slope(i % 23, i / 23);
        ASSERT_NEAR(slope.x, right, 1e-3F);
        ASSERT_NEAR(slope.y, down, 1e-3F);
      }
    }
  }
}

TEST(SurfaceEdges, StepsOfOneSurfaceAreNoJump) {
  const Circles circles(16, 4, [](float x, float) { return x < 8 ? 0 : kOneSurface; });
  EXPECT_EQ(jumps(circles), 0U);
}

TEST(SurfaceEdges, JumpsBetweenTwoPlanesAndNowhereElse) {
  for (const float slope : {0.0F, 2.0F, -7.0F}) {
    const Circles circles(
        20, 9, [&](float x, float y) { return x < 11 ? slope * y - 5 : slope * y + 9 + 0.5F * x; });
    const SurfaceEdges edges = circles.edges();
    for (std::size_t y = 0; y < 9; ++y) {
      for (std::size_t x = 0; x < 20; ++x) {
        EXPECT_EQ(edges.jump(x, y, 1, 0), x == 10) << x << "," << y;
        EXPECT_EQ(edges.jump(x, y, -1, 0), x == 11) << x << "," << y;
        EXPECT_FALSE(edges.jump(x, y, 0, 1));
        EXPECT_FALSE(edges.jump(x, y, 0, -1));
      }
    }
  }
}

TEST(SurfaceEdges, AJumpIsSeenFromBothSides) {
  const Circles circles(31, 29, [](float x, float y) {
    return std::hypot(x - 14, y - 13) < 8 ? -9 - 0.3F * x : 12 + 2 * y;
  });
  const SurfaceEdges edges = circles.edges();
  for (int y = 0; y < 29; ++y) {
    for (int x = 0; x < 31; ++x) {
      for (const auto& [dx, dy] : kNeighbours) {
        const int u = x + dx, v = y + dy;
        if (u < 0 || v < 0 || u >= 31 || v >= 29) continue;
        EXPECT_EQ(edges.jump(static_cast<std::size_t>(x), static_cast<std::size_t>(y), dx, dy),
                  edges.jump(static_cast<std::size_t>(u), static_cast<std::size_t>(v), -dx, -dy));
      }
    }
  }
}

TEST(SurfaceEdges, AFoldIsNoJump) {
  const Circles circles(21, 5, [](float x, float) { return 4 * std::abs(x - 10); });
  const SurfaceEdges edges = circles.edges();
  for (std::size_t i = 0; i < circles.values.size(); ++i)
    for (const int dx : {-1, 1}) EXPECT_FALSE(edges.jump(i % 21, i / 21, dx, 0)) << i;
}

TEST(SurfaceEdges, NothingLiesBeyondTheBorder) {
  const Circles circles(5, 4, [](float x, float y) { return 30 * x * y; });
  const SurfaceEdges edges = circles.edges();
  for (std::size_t x = 0; x < 5; ++x) {
    for (const int dx : {-1, 0, 1}) {
      EXPECT_FALSE(edges.jump(x, 0, dx, -1));
      EXPECT_FALSE(edges.jump(x, 3, dx, 1));
    }
  }
  for (std::size_t y = 0; y < 4; ++y) {
    EXPECT_FALSE(edges.jump(0, y, -1, 0));
    EXPECT_FALSE(edges.jump(4, y, 1, 0));
  }
}

TEST(SurfaceEdges, AJumpBesideTheBorderIsFound) {
  const Circles circles(12, 3, [](float x, float) { return x < 1 ? -20.0F : 5.0F; });
  EXPECT_TRUE(circles.edges().jump(0, 1, 1, 0));
  EXPECT_TRUE(circles.edges().jump(1, 1, -1, 0));
}

TEST(SurfaceEdges, TheSlopeEndsAtAJump) {
  const Circles circles(20, 3, [](float x, float) { return x < 10 ? 2 * x : 100 - 3 * x; });
  const SurfaceEdges edges = circles.edges();
  EXPECT_NEAR(edges.slope(9, 1).x, 2, 1e-5);
  EXPECT_NEAR(edges.slope(10, 1).x, -3, 1e-5);
}

TEST(SurfaceEdges, PixelsBesideAJumpAreMarked) {
  Circles circles(11, 9, [](float, float) { return 8.0F; });
  circles.values[4 * 11 + 5] = -8;
  const std::vector<std::uint8_t> marked = circles.edges().pixels();
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 11; ++x) {
      const bool near = std::abs(x - 5) <= 1 && std::abs(y - 4) <= 1;
      EXPECT_EQ(marked[static_cast<std::size_t>(y * 11 + x)], near ? 1 : 0) << x << "," << y;
    }
  }
}

TEST(SurfaceEdges, AwkwardSizesWork) {
  for (const auto& [width, height] : {std::pair{1U, 1U}, {1U, 9U}, {9U, 1U}, {2U, 1U}, {2U, 2U}}) {
    const Circles flat(width, height);
    EXPECT_EQ(jumps(flat), 0U);
    const SurfaceEdges edges = flat.edges();
    EXPECT_EQ(edges.slope(width - 1, height - 1).x, 0);
    EXPECT_EQ(edges.pixels(), std::vector<std::uint8_t>(std::size_t{width} * height));
  }
  Circles column(1, 9, [](float, float y) { return y < 4 ? 0.0F : 30.0F; });
  EXPECT_EQ(jumps(column), 2U);
  Circles pair(2, 1, [](float x, float) { return 30 * x; });
  EXPECT_EQ(jumps(pair), 2U);
}

}  // namespace
}  // namespace relumbre
