#include "relumbre/scene/scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/image/srgb.h"

namespace relumbre {
namespace {

std::array<float, 256> make_linear_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = srgb_decode(static_cast<float>(i) / 255.0F);
  }
  return table;
}

Rgb texel(const Texture& texture, std::uint32_t x, std::uint32_t y) {
  static const std::array<float, 256> linear = make_linear_table();
  const std::uint8_t* rgb = texture.rgb.data() + 3 * (std::size_t{y} * texture.width + x);
  return {linear[rgb[0]], linear[rgb[1]], linear[rgb[2]]};
}

/// The two texels around a coordinate that wraps around, and the second one's weight.
struct Neighbours {
  std::uint32_t first, second;
  float weight;
};

Neighbours neighbours(float coordinate, std::uint32_t size) {
  float wrapped = coordinate - std::floor(coordinate);
  if (!(wrapped >= 0 && wrapped < 1)) wrapped = 0;
  const float position = wrapped * static_cast<float>(size) - 0.5F;
  const float below = std::floor(position);
  const auto last = size - 1;
  const std::uint32_t first = below < 0 ? last : std::min(static_cast<std::uint32_t>(below), last);
  return {first, first == last ? 0 : first + 1, position - below};
}

template <class T>
T mix(const T& a, const T& b, float t) {
  return a * (1 - t) + b * t;
}

constexpr std::size_t kHashChunk = std::size_t{1} << 16;

/// Hash of `count` items by their 32-bit words; chunks are hashed in parallel and then chained.
template <class Words>
std::uint64_t hash_items(std::size_t count, std::uint64_t seed, const Words& words) {
  std::vector<std::uint64_t> parts((count + kHashChunk - 1) / kHashChunk);
  parallel_chunks(0, count, kHashChunk, [&](std::size_t begin, std::size_t end) {
    std::uint64_t h = hash64(begin);
    for (std::size_t i = begin; i < end; ++i) {
      for (const std::uint32_t word : words(i)) h = hash64(h ^ word);
    }
    parts[begin / kHashChunk] = h;
  });
  std::uint64_t h = hash64(seed, count);
  for (const std::uint64_t part : parts) h = hash64(h, part);
  return h;
}

}  // namespace

Rgb Texture::sample(Vec2f uv) const {
  if (width == 0 || height == 0) return Rgb(1.0F);
  const Neighbours x = neighbours(uv.x, width), y = neighbours(uv.y, height);
  const Rgb top = mix(texel(*this, x.first, y.first), texel(*this, x.second, y.first), x.weight);
  const Rgb low = mix(texel(*this, x.first, y.second), texel(*this, x.second, y.second), x.weight);
  return mix(top, low, y.weight);
}

Rgb Scene::reflectance(std::uint32_t triangle, float u, float v) const {
  const Material& material = material_of(triangle);
  const Index3& corners = mesh.triangles[triangle];
  const auto interpolated = [&](const auto& values) {
    return values[corners[0]] * (1 - u - v) + values[corners[1]] * u + values[corners[2]] * v;
  };
  Rgb result = material.reflectance;
  if (!colors.empty()) result *= interpolated(colors);
  if (material.texture != kNone && !texcoords.empty())
    result *= textures[material.texture].sample(interpolated(texcoords));
  return result;
}

std::uint64_t Scene::geometry_hash() const {
  const auto positions = hash_items(mesh.positions.size(), 1, [&](std::size_t i) {
    const Vec3f& p = mesh.positions[i];
    return std::array{std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                      std::bit_cast<std::uint32_t>(p.z)};
  });
  const auto triangles =
      hash_items(mesh.triangles.size(), 2, [&](std::size_t i) { return mesh.triangles[i]; });
  const auto sides = hash_items(mesh.two_sided.size(), 3, [&](std::size_t i) {
    return std::array{std::uint32_t{mesh.two_sided[i]}};
  });
  return hash64(hash64(positions, triangles), sides);
}

}  // namespace relumbre
