#include "relumbre/render/lens_samples.h"

#include <algorithm>

#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/render/element_points.h"
#include "relumbre/render/view_tiles.h"

namespace relumbre {

namespace {

constexpr std::size_t kSets = 64;

constexpr std::uint32_t reversed_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0xFF00FF00U) >> 8) | ((x & 0x00FF00FFU) << 8);
  x = ((x & 0xF0F0F0F0U) >> 4) | ((x & 0x0F0F0F0FU) << 4);
  x = ((x & 0xCCCCCCCCU) >> 2) | ((x & 0x33333333U) << 2);
  return ((x & 0xAAAAAAAAU) >> 1) | ((x & 0x55555555U) << 1);
}

/// A random permutation of indices that maps every aligned run of 2^m of them onto another one, so
/// that two sequences can be paired without losing the stratification of either. Source: Burley
/// 2020, "Practical Hash-based Owen Scrambling", with the hash of Laine and Karras 2011.
constexpr std::uint32_t shuffled(std::uint32_t index, std::uint32_t seed) {
  std::uint32_t x = reversed_bits(index) + seed;
  x ^= x * 0x6C50B47CU;
  x ^= x * 0xB82F1E52U;
  x ^= x * 0xC7AFE638U;
  x ^= x * 0x8D22F6E6U;
  return reversed_bits(x);
}

/// 10 bits to every other of 20.
constexpr std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | (x << 8)) & 0x00FF00FFU;
  x = (x | (x << 4)) & 0x0F0F0F0FU;
  x = (x | (x << 2)) & 0x33333333U;
  return (x | (x << 1)) & 0x55555555U;
}

std::uint32_t morton(const Vec2f& lens) {
  const auto cell = [](float v) {
    return static_cast<std::uint32_t>(std::clamp((v + 1) * 512, 0.0F, 1023.0F));
  };
  return spread_bits(cell(lens.x)) | (spread_bits(cell(lens.y)) << 1);
}

std::vector<LensSample> make_set(const Aperture& aperture, std::uint32_t samples,
                                 std::uint64_t seed) {
  const ScrambledSobol lens(seed), pixel(hash64(seed, 1));
  const auto order = static_cast<std::uint32_t>(hash64(seed, 2));
  std::vector<LensSample> set(samples);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const std::array<float, 4> u = lens(i), v = pixel(shuffled(i, order));
    set[i] = {aperture.point(u[0], u[1]), {tent(v[0]), tent(v[1])}, i};
  }
  std::sort(set.begin(), set.end(), [](const LensSample& a, const LensSample& b) {
    const std::uint32_t p = morton(a.lens), q = morton(b.lens);
    return p != q ? p < q : a.index < b.index;
  });
  return set;
}

}  // namespace

LensSamples::LensSamples(const Aperture& aperture, std::uint32_t samples, std::uint64_t seed)
    : sets_(kSets), seed_(seed) {
  parallel_for(0, kSets, 1,
               [&](std::size_t i) { sets_[i] = make_set(aperture, samples, hash64(seed, i)); });
}

std::span<const LensSample> LensSamples::of_pixel(std::size_t pixel) const {
  return sets_[hash64(seed_, ~pixel) % kSets];
}

}  // namespace relumbre
