/// Random inputs of the operators, and their slow, obvious twin in float64. For tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "relumbre/base/sampling.h"
#include "relumbre/linalg/inverse.h"
#include "relumbre/radiosity/relight_operator.h"

namespace relumbre {

struct RandomTransport {
  SparseCounts counts;
  std::vector<std::uint32_t> patch_offsets;
  std::vector<float> area;
  std::vector<Rgb> reflectance;

  [[nodiscard]] OperatorInput input() const { return {counts, patch_offsets, area, reflectance}; }
  [[nodiscard]] std::size_t elements() const { return counts.rows(); }
  [[nodiscard]] std::size_t patches() const { return counts.columns; }
};

struct RandomTransportConfig {
  std::size_t elements = 101, patches = 13;
  std::uint32_t rays = 512;
  float concentration = 0.3F;  ///< share of a row's rays that go to one column
  float escaped = 0.1F;        ///< share that goes nowhere
  bool empty_rows = true;      ///< every 7th row has no hit
  std::uint64_t seed = 1;
};

inline std::vector<Rgb> random_reflectance(std::size_t count, float largest, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Rgb> values(count);
  for (Rgb& v : values) v = Rgb(random.uniform(), random.uniform(), random.uniform()) * largest;
  return values;
}

inline void add_random_row(SparseCounts& counts, const RandomTransportConfig& config,
                           RandomStream& random) {
  std::vector<std::uint32_t> row(config.patches);
  const auto share = [&](float part) {
    return static_cast<std::uint32_t>(part * static_cast<float>(config.rays));
  };
  const std::uint32_t favoured = share(config.concentration);
  std::uint32_t rest = config.rays - favoured - share(config.escaped);
  row[random.bits() % config.patches] += favoured;
  const std::uint32_t bundle =
      std::max(rest / 1024, 1U);  // many rays need not be thrown one by one
  for (; rest >= bundle; rest -= bundle) row[random.bits() % config.patches] += bundle;
  for (std::uint32_t p = 0; p < config.patches; ++p) {
    if (row[p] == 0) continue;
    counts.column.push_back(p);
    counts.count.push_back(row[p]);
  }
}

inline RandomTransport random_transport(const RandomTransportConfig& config) {
  RandomTransport t;
  RandomStream random(config.seed);
  t.counts.columns = config.patches;
  t.counts.rays = config.rays;
  for (std::size_t i = 0; i < config.elements; ++i) {
    if (!config.empty_rows || i % 7 != 3) add_random_row(t.counts, config, random);
    t.counts.row_offsets.push_back(t.counts.column.size());
    t.area.push_back(0.5F + random.uniform());
  }
  for (std::size_t p = 0; p <= config.patches; ++p)
    t.patch_offsets.push_back(static_cast<std::uint32_t>(p * config.elements / config.patches));
  t.reflectance = random_reflectance(config.elements, 0.9F, config.seed + 1);
  return t;
}

inline std::vector<float> random_emission(std::size_t values, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<float> e(values);
  for (float& v : e) v = random.uniform() * 10;
  return e;
}

/// Vᵀ of one channel of an n × 3 field, in float64.
inline std::vector<double> patch_means(const RandomTransport& t, const std::vector<float>& field,
                                       std::size_t channel) {
  std::vector<double> mean(t.patches());
  for (std::size_t p = 0; p < t.patches(); ++p) {
    double area = 0;
    for (std::size_t i = t.patch_offsets[p]; i < t.patch_offsets[p + 1]; ++i) {
      area += static_cast<double>(t.area[i]);
      mean[p] += static_cast<double>(t.area[i]) * static_cast<double>(field[3 * i + channel]);
    }
    if (area > 0) mean[p] /= area;
  }
  return mean;
}

/// B = E + R U (I − VᵀRU)⁻¹ Vᵀ E by the definitions, dense, in float64.
inline std::vector<double> dense_relight(const RandomTransport& t,
                                         const std::vector<float>& emission) {
  const std::size_t n = t.elements(), k = t.patches();
  std::vector<double> radiosity(3 * n);
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<std::vector<double>> ru(n, std::vector<double>(k));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t e = 0; e < t.counts.row_columns(i).size(); ++e)
        ru[i][t.counts.row_columns(i)[e]] =
            static_cast<double>(t.reflectance[i][c]) * t.counts.row_counts(i)[e] / t.counts.rays;
    }
    std::vector<double> m(k * k);
    for (std::size_t p = 0; p < k; ++p) {
      double area = 0;
      for (std::size_t i = t.patch_offsets[p]; i < t.patch_offsets[p + 1]; ++i)
        area += static_cast<double>(t.area[i]);
      for (std::size_t q = 0; q < k; ++q) {
        for (std::size_t i = t.patch_offsets[p]; i < t.patch_offsets[p + 1]; ++i)
          m[p * k + q] -= static_cast<double>(t.area[i]) / area * ru[i][q];
      }
      m[p * k + p] += 1;
    }
    invert(m, k);
    const std::vector<double> mean = patch_means(t, emission, c);
    std::vector<double> y(k);
    for (std::size_t p = 0; p < k; ++p) {
      for (std::size_t q = 0; q < k; ++q) y[p] += m[p * k + q] * mean[q];
    }
    for (std::size_t i = 0; i < n; ++i) {
      radiosity[3 * i + c] = static_cast<double>(emission[3 * i + c]);
      for (std::size_t p = 0; p < k; ++p) radiosity[3 * i + c] += ru[i][p] * y[p];
    }
  }
  return radiosity;
}

/// max |a − b| / max |b|
template <class A, class B>
double relative_difference(const std::vector<A>& a, const std::vector<B>& b) {
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference =
        std::max(difference, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
    largest = std::max(largest, std::abs(static_cast<double>(b[i])));
  }
  return largest > 0 ? difference / largest : difference;
}

}  // namespace relumbre
