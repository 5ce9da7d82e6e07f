#include "relumbre/dof/aperture_kernel.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {
namespace {

struct Shape {
  BlurShape shape;
  Aperture aperture;

  [[nodiscard]] ApertureKernels kernels() const { return {shape, aperture, 200}; }
  [[nodiscard]] double area(double diameter) const {
    return std::numbers::pi / 4 * diameter * diameter *
           (shape == BlurShape::kBox ? 1 : aperture.open_fraction());
  }
};

const std::vector<Shape> kShapes{
    {BlurShape::kAperture, {}},      {BlurShape::kBox, {}},
    {BlurShape::kAperture, {6, 0}},  {BlurShape::kAperture, {8, 22.5}},
    {BlurShape::kAperture, {3, 10}}, {BlurShape::kAperture, {5, -133}}};
/// Diameters that kernels are made for exactly, small and large.
const std::vector<double> kDiameters{1.0 / 64, 0.5,     1,        1.59375, 2.5,
                                     3.984375, 6.59375, 12.90625, 132.5};

double right_of(const ApertureKernel::Span& s) {
  return s.end + static_cast<double>(s.end_fraction) - 0.5;
}
double left_of(const ApertureKernel::Span& s) {
  return s.begin + static_cast<double>(s.begin_fraction) - 0.5;
}

/// Light of every pixel (row, column), by the steps that a span stands for.
using Drawing = std::map<std::pair<int, int>, double>;
Drawing draw(const ApertureKernel& kernel) {
  Drawing drawing;
  for (int row = kernel.top; row < kernel.bottom(); ++row) {
    const auto& span = kernel.rows[static_cast<std::size_t>(row - kernel.top)];
    std::map<int, double> steps;
    steps[span.begin] += 1 - static_cast<double>(span.begin_fraction);
    steps[span.begin + 1] += static_cast<double>(span.begin_fraction);
    steps[span.end] -= 1 - static_cast<double>(span.end_fraction);
    steps[span.end + 1] -= static_cast<double>(span.end_fraction);
    double sum = 0;
    for (int x = span.begin; x <= span.end; ++x) {
      sum += steps[x];
      drawing[{row, x}] += sum * static_cast<double>(span.height) * kernel.share;
    }
  }
  return drawing;
}

TEST(ApertureKernel, HasTheOutlinesArea) {
  for (const Shape& shape : kShapes) {
    const ApertureKernels kernels = shape.kernels();
    for (const double diameter : kDiameters) {
      const ApertureKernel& kernel = kernels.of(diameter);
      double area = 0;
      for (const auto& row : kernel.rows)
        area += static_cast<double>(row.height) * (right_of(row) - left_of(row));
      // Ends of rows are floats.
      EXPECT_NEAR(area, shape.area(diameter), 1e-6 * area + 1e-6 * diameter) << diameter;
      EXPECT_NEAR(kernel.share * shape.area(diameter), 1, 1e-6) << diameter;
    }
  }
}

TEST(ApertureKernel, SharesOutAllLight) {
  for (const Shape& shape : kShapes) {
    const ApertureKernels kernels = shape.kernels();
    for (double diameter = 0; diameter < 200; diameter = diameter * 1.07 + 0.03) {
      for (const double sign : {1.0, -1.0}) {
        double sum = 0;
        for (const auto& entry : draw(kernels.of(sign * diameter))) {
          sum += entry.second;
          EXPECT_GE(entry.second, -1e-6);
        }
        EXPECT_NEAR(sum, 1, diameter < 0.1 ? 1e-4 : 1e-5) << diameter;
      }
    }
  }
}

TEST(ApertureKernel, InsideItsPixelItLeavesThePictureUntouched) {
  for (const Shape& shape : kShapes) {
    const ApertureKernels kernels = shape.kernels();
    for (const double diameter : {0.0, 1e-9, 0.2, 0.7, 1.0}) {
      // A box of the disc's area has a smaller side than the disc's diameter.
      for (const double sign : {1.0, -1.0}) {
        for (const auto& [pixel, light] : draw(kernels.of(sign * diameter))) {
          const bool center = pixel.first == 0 && pixel.second == 0;
          EXPECT_NEAR(light, center ? 1 : 0, 1e-4) << diameter;
        }
      }
    }
  }
}

/// The rows that points on the opening fall into, and where in them.
TEST(ApertureKernel, RowsAreThoseOfTheOpeningsPoints) {
  constexpr std::uint32_t kPoints = 1U << 16;
  for (const Shape& shape : kShapes) {
    if (shape.shape == BlurShape::kBox) continue;
    const ApertureKernels kernels = shape.kernels();
    for (const double diameter : {2.5, 12.90625, 23.0}) {
      const ApertureKernel& kernel = kernels.of(diameter);
      std::map<int, double> count, sum;
      for (std::uint32_t i = 0; i < kPoints; ++i) {
        const auto s = sobol4(i);
        const Vec2f p = shape.aperture.point(to_unit(s[0]), to_unit(s[1]));
        const int row =
            static_cast<int>(std::lround(-static_cast<double>(p.y) * diameter / 2));  // y is up
        count[row] += 1.0 / kPoints;
        sum[row] += static_cast<double>(p.x) * diameter / 2 / kPoints;
      }
      for (int row = kernel.top; row < kernel.bottom(); ++row) {
        const auto& span = kernel.rows[static_cast<std::size_t>(row - kernel.top)];
        const double light =
            kernel.share * static_cast<double>(span.height) * (right_of(span) - left_of(span));
        EXPECT_NEAR(count[row], light, 1e-3) << diameter << " " << row;
        EXPECT_NEAR(sum[row], light * (left_of(span) + right_of(span)) / 2, 1e-3 * diameter);
        count.erase(row);
      }
      for (const auto& missed : count) EXPECT_LT(missed.second, 1e-3);
    }
  }
}

TEST(ApertureKernel, IsASquareWithTheDiscsArea) {
  const ApertureKernels kernels = kShapes[1].kernels();
  for (const double diameter : kDiameters) {
    const ApertureKernel& kernel = kernels.of(diameter);
    const double side = std::sqrt(std::numbers::pi) / 2 * diameter;
    EXPECT_NEAR(kernel.share * side * side, 1, 1e-6);
    for (const auto& row : kernel.rows) {
      EXPECT_NEAR(right_of(row), side / 2, 1e-6 * side + 1e-7);
      EXPECT_NEAR(left_of(row), -side / 2, 1e-6 * side + 1e-7);
    }
  }
}

TEST(ApertureKernel, BeforeTheFocusItIsTurnedByHalfATurn) {
  for (const Shape& shape : kShapes) {
    const ApertureKernels kernels = shape.kernels();
    for (const double diameter : {0.3, 1.7, 5.5, 20.0, 61.0}) {
      const Drawing behind = draw(kernels.of(diameter)), before = draw(kernels.of(-diameter));
      const auto at = [](const Drawing& drawing, int row, int column) {
        const auto found = drawing.find({row, column});
        return found == drawing.end() ? 0 : found->second;
      };
      for (const auto& [pixel, light] : behind)
        EXPECT_NEAR(at(before, -pixel.first, -pixel.second), light, 1e-5);
      for (const auto& [pixel, light] : before)
        EXPECT_NEAR(at(behind, -pixel.first, -pixel.second), light, 1e-5);
    }
  }
}

TEST(ApertureKernel, ReachesNoFartherThanItSays) {
  for (const Shape& shape : kShapes) {
    const ApertureKernels kernels = shape.kernels();
    for (const double diameter : {0.3, 1.0, 1.7, 5.5, 20.0, 61.0, -1.7, -61.0}) {
      const ApertureKernel& kernel = kernels.of(diameter);
      for (const auto& [pixel, light] : draw(kernel))
        EXPECT_LE(std::abs(pixel.second), kernel.reach);
      EXPECT_LE(kernel.reach, std::abs(diameter) / 2 + 3);
    }
  }
}

TEST(ApertureKernels, LargerThanTheLargestIsTheLargest) {
  const ApertureKernels kernels(BlurShape::kAperture, {}, 50);
  EXPECT_EQ(&kernels.of(1e9), &kernels.of(50));
  EXPECT_EQ(&kernels.of(-1e9), &kernels.of(-50));
  const ApertureKernels none(BlurShape::kAperture, {}, 0);
  EXPECT_EQ(none.of(1e9).rows.size(), 1U);
}

TEST(ApertureKernels, StepsAreFine) {
  const ApertureKernels kernels(BlurShape::kAperture, {}, 300);
  for (double diameter = 1; diameter < 300; diameter *= 1.013) {
    const double made = std::sqrt(4 / (std::numbers::pi * kernels.of(diameter).share));
    EXPECT_NEAR(made, diameter, std::max(1.0 / 128, 0.002 * diameter) + 1e-6);
  }
}

TEST(ApertureKernels, RefuseWhatCannotBe) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -1.0, ApertureKernels::kLargest + 1}) {
    EXPECT_THROW(ApertureKernels(BlurShape::kBox, {}, bad), ValueError);
  }
  EXPECT_NO_THROW(ApertureKernels(BlurShape::kBox, {}, ApertureKernels::kLargest));
  EXPECT_THROW(ApertureKernels(BlurShape::kAperture, {2, 0}, 10), ValueError);
  EXPECT_THROW(ApertureKernels(BlurShape::kAperture, {6, inf}, 10), ValueError);
}

}  // namespace
}  // namespace relumbre
