#include "relumbre/octree/voxel_value.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace relumbre {

namespace {

constexpr int kMantissaBits = 9, kBias = 15, kMaxExponent = 31;
constexpr float kBrightest = 511.0F / 512 * 65536;
constexpr std::uint32_t kNoNormal = 0xFFFFFFFF;
constexpr float kSteps = 65534;  // 65535 is left for "none"

/// 2^exponent, of a normal float32. ldexp, ilogb and lround are calls.
float power_of_two(int exponent) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23);
}
int log_of(float positive) {
  return static_cast<int>(std::bit_cast<std::uint32_t>(positive) >> 23) - 127;
}
/// Of what is not negative; halves upwards, as lround.
std::uint32_t nearest(float v) { return static_cast<std::uint32_t>(static_cast<double>(v) + 0.5); }

float in_range(float c) { return c > 0 ? std::min(c, kBrightest) : 0.0F; }

std::uint32_t to_steps(float c) { return nearest((std::clamp(c, -1.0F, 1.0F) + 1) / 2 * kSteps); }
float from_steps(std::uint32_t steps) { return static_cast<float>(steps) / kSteps * 2 - 1; }

/// The lower half of the octahedron is folded over the upper one's edges.
void fold(float& x, float& y) {
  const float folded_x = (1 - std::abs(y)) * std::copysign(1.0F, x);
  y = (1 - std::abs(x)) * std::copysign(1.0F, y);
  x = folded_x;
}

}  // namespace

void VoxelMean::Side::add(const Side& s) {
  color += s.color;
  weight += s.weight;
}

void VoxelMean::add(const Rgb& color, const std::optional<Rgb>& back, const Vec3f& normal,
                    float weight) {
  VoxelMean one;
  one.side_[0] = {color * weight, weight};
  if (back) one.side_[1] = {*back * weight, weight};
  one.normal_ = normal * weight;
  add(one);
}

void VoxelMean::add(const VoxelMean& other) {
  const bool turned = dot(other.normal_, normal_) < 0;
  for (std::size_t s = 0; s < 2; ++s) side_[s].add(other.side_[turned ? 1 - s : s]);
  normal_ += turned ? -other.normal_ : other.normal_;
}

void VoxelMean::add(const VoxelValue& voxel) {
  std::optional<Rgb> back;
  if (voxel.back != VoxelValue::kNoBack) back = unpack_color(voxel.back);
  add(unpack_color(voxel.color), back, unpack_normal(voxel.normal), 1);
}

VoxelValue VoxelMean::value() const {
  const std::size_t front = side_[0].weight > 0 ? 0 : 1;
  const Side &seen = side_[front], &behind = side_[1 - front];
  return {pack_color(seen.color / seen.weight),
          behind.weight > 0 ? pack_color(behind.color / behind.weight) : VoxelValue::kNoBack,
          pack_normal(front == 0 ? normal_ : -normal_)};
}

Rgb back_color(const VoxelValue& value) {
  return unpack_color(value.back == VoxelValue::kNoBack ? value.color : value.back);
}

std::uint32_t pack_color(const Rgb& color) {
  const Rgb c(in_range(color.x), in_range(color.y), in_range(color.z));
  const float most = max_component(c);
  if (most == 0) return 0;
  int exponent = std::clamp(log_of(most) + 1 + kBias, 0, kMaxExponent);
  const auto mantissa = [&](float v) {
    return nearest(v * power_of_two(kMantissaBits + kBias - exponent));
  };
  if (mantissa(most) == 1U << kMantissaBits) ++exponent;  // it was rounded up
  return static_cast<std::uint32_t>(exponent) << 27 | mantissa(c.z) << 18 | mantissa(c.y) << 9 |
         mantissa(c.x);
}

Rgb unpack_color(std::uint32_t packed) {
  const float scale = power_of_two(static_cast<int>(packed >> 27) - kBias - kMantissaBits);
  const auto component = [&](unsigned shift) {
    return static_cast<float>(packed >> shift & 511) * scale;
  };
  return {component(0), component(9), component(18)};
}

std::uint32_t pack_normal(const Vec3f& normal) {
  const float size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  if (!(size > 0) || !std::isfinite(size)) return kNoNormal;
  float x = normal.x / size, y = normal.y / size;
  if (normal.z < 0) fold(x, y);
  return to_steps(x) | to_steps(y) << 16;
}

Vec3f unpack_normal(std::uint32_t packed) {
  if (packed == kNoNormal) return {};
  float x = from_steps(packed & 0xFFFF), y = from_steps(packed >> 16);
  const float z = 1 - std::abs(x) - std::abs(y);
  if (z < 0) fold(x, y);
  return normalized(Vec3f(x, y, z));
}

}  // namespace relumbre
