#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/cuda/testing.h"
#include "relumbre/radiosity/random_transport.h"
#include "relumbre/radiosity/relight_operator_cuda.h"

namespace relumbre::cuda {
namespace {

constexpr CountFormat kFormats[] = {CountFormat::kCounts8, CountFormat::kCounts16,
                                    CountFormat::kFloat16};

double largest_difference(const std::vector<float>& a, const std::vector<double>& b) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double off = std::abs(static_cast<double>(a[i]) - b[i]);
    worst = off <= worst ? worst : off;
    largest = std::max(largest, std::abs(b[i]));
  }
  return worst / largest;
}

TEST(RelightOperatorCuda, IsTheDenseTwinAndTheCpusOperator) {
  RELUMBRE_NEEDS_DEVICE();
  for (const std::size_t n : {7, 101, 333}) {
    for (const std::size_t k : {1, 13, 64}) {
      if (k > n) continue;
      const RandomTransport t = random_transport({.elements = n, .patches = k, .rays = 4096});
      const std::vector<float> emission = random_emission(3 * n, 3);
      const std::vector<double> twin = dense_relight(t, emission);
      for (const CountFormat format : kFormats) {
        std::vector<float> there(3 * n), here(3 * n);
        cuda::make_compressed_operator(t.input(), format, 0)->apply(emission, there);
        relumbre::make_compressed_operator(t.input(), format)->apply(emission, here);
        const std::string what =
            std::to_string(n) + " x " + std::to_string(k) + ", " + std::string(to_string(format));
        EXPECT_LE(largest_difference(there, twin), 1e-5) << what;
        EXPECT_LE(largest_difference(there, {here.begin(), here.end()}), 1e-5) << what;
      }
    }
  }
}

TEST(RelightOperatorCuda, AlbedoEditEqualsANewOperator) {
  RELUMBRE_NEEDS_DEVICE();
  RandomTransport t = random_transport({.elements = 90, .patches = 17});
  const auto edited = cuda::make_compressed_operator(t.input(), CountFormat::kCounts8, 0);
  t.reflectance = random_reflectance(90, 0.5F, 99);
  edited->set_reflectance(t.reflectance);
  const auto anew = cuda::make_compressed_operator(t.input(), CountFormat::kCounts8, 0);
  const std::vector<float> emission = random_emission(270, 5);
  std::vector<float> a(270), b(270);
  edited->apply(emission, a);
  anew->apply(emission, b);
  EXPECT_EQ(a, b);
  EXPECT_THROW(edited->set_reflectance(std::vector<Rgb>(90, Rgb(1.0F))), ValueError);
}

TEST(RelightOperatorCuda, EmissionAndRadiosityMayBeTheSame) {
  RELUMBRE_NEEDS_DEVICE();
  const RandomTransport t = random_transport({.elements = 50, .patches = 9});
  const auto op = cuda::make_compressed_operator(t.input(), CountFormat::kCounts16, 0);
  std::vector<float> field = random_emission(450, 7), radiosity(450);
  op->apply(field, radiosity, 3);
  op->apply(field, field, 3);
  EXPECT_EQ(field, radiosity);
}

}  // namespace
}  // namespace relumbre::cuda
