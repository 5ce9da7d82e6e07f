#include "relumbre/render/sky_light.h"

#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/sampling.h"

namespace relumbre {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Cosine of the polar angle at the upper edge of a row.
float row_cosine(std::size_t row, std::size_t height) {
  return std::cos(kPi * static_cast<float>(row) / static_cast<float>(height));
}

float texel_solid_angle(std::size_t row, std::size_t width, std::size_t height) {
  return 2 * kPi / static_cast<float>(width) *
         (row_cosine(row, height) - row_cosine(row + 1, height));
}

/// x − floor(x), in [0, 1).
float fraction(float x) { return std::min(x - std::floor(x), kBelowOne); }

/// Where `x` in [0, 1) falls among `count` cells.
std::size_t cell(float x, std::size_t count) {
  return std::min(static_cast<std::size_t>(x * static_cast<float>(count)), count - 1);
}

/// The image's texels. Throws ValueError for one that is not finite.
std::vector<Rgb> read_texels(const Light& light) {
  std::vector<Rgb> texels(light.sky->pixels());
  const auto r = light.sky->channel("R"), g = light.sky->channel("G"), b = light.sky->channel("B");
  for (std::size_t i = 0; i < texels.size(); ++i) {
    texels[i] = max(Rgb(r[i], g[i], b[i]), Rgb{});
    if (!is_finite(Rgb(r[i], g[i], b[i]))) {
      throw ValueError(
          fmt::format("sky of light '{}' {} has a value that is not finite at pixel {}", light.name,
                      light.file, i));
    }
  }
  return texels;
}

}  // namespace

SkyMap::SkyMap(const Light& light) : turn_(light.rotation_deg / 360) {
  if (!light.sky || light.sky->pixels() == 0) {
    throw ValueError(fmt::format("light '{}' has no sky image", light.name));
  }
  width_ = light.sky->width(), height_ = light.sky->height();
  texels_ = read_texels(light);
  std::vector<float> row_weights(height_), weights(width_);
  columns_.reserve(height_);
  for (std::size_t row = 0; row < height_; ++row) {
    for (std::size_t c = 0; c < width_; ++c) weights[c] = luminance(at({c, row}));
    columns_.emplace_back(weights);
    row_weights[row] =
        static_cast<float>(columns_.back().total()) * texel_solid_angle(row, width_, height_);
  }
  rows_ = DiscreteChoice(row_weights);
}

SkyMap::Texel SkyMap::texel(const Vec3f& d) const {
  const float u = 0.5F + std::atan2(d.x, -d.z) / (2 * kPi) + turn_;
  const float v = std::acos(std::clamp(d.y, -1.0F, 1.0F)) / kPi;
  return {cell(fraction(u), width_), cell(v, height_)};
}

Rgb SkyMap::radiance(const Vec3f& direction) const { return at(texel(direction)); }

float SkyMap::density(const Vec3f& direction) const {
  return static_cast<float>(static_cast<double>(luminance(radiance(direction))) / rows_.total());
}

Vec3f SkyMap::sample(float u, float v) const {
  const auto [row, row_rest] = rows_.choose(v);
  const auto [column, column_rest] = columns_[row].choose(u);
  // Uniform in solid angle within the texel: in longitude, and in the cosine of the polar angle.
  const float x = (static_cast<float>(column) + column_rest) / static_cast<float>(width_);
  const float phi = 2 * kPi * (x - 0.5F - turn_);
  const float upper = row_cosine(row, height_), lower = row_cosine(row + 1, height_);
  const float y = upper + (lower - upper) * row_rest;
  const float r = std::sqrt(std::max(0.0F, 1 - y * y));
  return {r * std::sin(phi), y, -r * std::cos(phi)};
}

namespace {

/// Half the samples by luminance, half by cosine, weighted by the balance heuristic.
class SkySampler final : public LightSampler {
 public:
  explicit SkySampler(const Light& light) : sky_(light) {}
  [[nodiscard]] bool has_no_extent() const override { return false; }

  [[nodiscard]] LightRay sample(const Receiver& x, float u, float v) const override {
    if (sky_.black()) return {};
    const Vec3f direction = u < 0.5F
                                ? Frame(x.normal).to_world(square_to_cosine_hemisphere(2 * u, v))
                                : sky_.sample(2 * u - 1, v);
    const float cosine = dot(x.normal, direction);
    if (!(cosine > 0)) return {};
    const float density = 0.5F * (cosine / kPi + sky_.density(direction));
    return {.ray = {.origin = x.origin, .direction = direction},
            .irradiance = sky_.radiance(direction) * (cosine / density)};
  }

 private:
  SkyMap sky_;
};

}  // namespace

std::unique_ptr<LightSampler> make_sky_sampler(const Light& light) {
  return std::make_unique<SkySampler>(light);
}

}  // namespace relumbre
