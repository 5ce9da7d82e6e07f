#include "relumbre/render/relight.h"

#include <gtest/gtest.h>

#include "relumbre/base/error.h"
#include "relumbre/render/test_support.h"

namespace relumbre {
namespace {

using test::Cut;

/// B = gain · E.
class Gain final : public RelightOperator {
 public:
  Gain(std::size_t elements, float gain) : elements_(elements), gain_(gain) {}
  [[nodiscard]] std::size_t elements() const override { return elements_; }
  [[nodiscard]] std::size_t patches() const override { return 1; }
  [[nodiscard]] std::string_view name() const override { return "gain"; }
  [[nodiscard]] std::size_t bytes_per_apply() const override { return 0; }

 private:
  void apply_checked(std::span<const float> emission, std::span<float> radiosity,
                     std::size_t) const override {
    for (std::size_t i = 0; i < emission.size(); ++i) radiosity[i] = gain_ * emission[i];
  }
  std::size_t elements_;
  float gain_;
};

/// Object 0 is a floor; 1 and 2 are lamps.
const Cut& two_lamps() {
  static const Cut cut = [] {
    Scene scene;
    test::add_quad(scene, test::add_material(scene, Rgb{0.5F, 0.25F, 0}), {}, {1, 0, 0}, {0, 1, 0});
    const std::uint32_t lamp = test::add_material(scene, Rgb(0.5F), Rgb{10, 20, 30});
    test::add_quad(scene, lamp, {0, 0, 1}, {0, 0.4F, 0}, {1, 0, 0});
    test::add_quad(scene, lamp, {0, 0.5F, 1}, {0, 0.4F, 0}, {1, 0, 0});
    return Cut(std::move(scene), 3, 24);
  }();
  return cut;
}

std::vector<LightResponse> constant_responses(std::size_t lights, float value) {
  return std::vector<LightResponse>(
      lights, std::make_shared<std::vector<Rgb>>(two_lamps().tessellation.elements(), Rgb(value)));
}

TEST(Relight, EmissionFollowsItsLightsPower) {
  const Cut& cut = two_lamps();
  std::vector<Light> lights = {test::emitter_light(1), test::emitter_light(2)};
  lights[0].color = {1, 0.5F, 0};
  lights[1].on = false;
  const auto scaled = scaled_emission(cut.scene, cut.tessellation, cut.emissions(), lights);
  EXPECT_EQ(cut.mean(scaled, 0), Rgb{});
  EXPECT_EQ(cut.mean(scaled, 1), (Rgb{10, 10, 0}));
  EXPECT_EQ(cut.mean(scaled, 2), Rgb{});
  const auto without = scaled_emission(cut.scene, cut.tessellation, cut.emissions(), {});
  EXPECT_EQ(cut.mean(without, 1), Rgb{});
}

TEST(Relight, OperatorGetsReflectedDirectLightAndNoEmission) {
  const Cut& cut = two_lamps();
  const std::vector<Light> lights = {test::emitter_light(1), test::emitter_light(2)};
  const Gain gain(cut.tessellation.elements(), 3);
  const RelitResult lit = relight(cut.scene, cut.tessellation, cut.reflectances(), cut.emissions(),
                                  gain, lights, constant_responses(2, 2));
  EXPECT_EQ(cut.mean(lit.radiosity, 0), (Rgb{6, 3, 0}));     // 3 · ρ · (2 + 2)
  EXPECT_EQ(cut.mean(lit.radiosity, 1), (Rgb{16, 26, 36}));  // and its own emission
  EXPECT_EQ(cut.mean(lit.direct_irradiance, 2), Rgb(4.0F));
}

TEST(Relight, IrradianceIsUnknownWhereNothingIsReflected) {
  const Cut& cut = two_lamps();
  const std::vector<Light> lights = {test::emitter_light(1)};
  const Gain gain(cut.tessellation.elements(), 3);
  const RelitResult lit = relight(cut.scene, cut.tessellation, cut.reflectances(), cut.emissions(),
                                  gain, lights, constant_responses(1, 2));
  const auto total = total_irradiance(lit, cut.reflectances());
  const auto indirect = indirect_irradiance(lit, cut.reflectances());
  for (const std::size_t i : cut.elements_of(0)) {
    EXPECT_FLOAT_EQ(total[i].x, 6);
    EXPECT_FLOAT_EQ(indirect[i].x, 4);
    EXPECT_TRUE(std::isnan(total[i].z));
    EXPECT_TRUE(std::isnan(indirect[i].z));
  }
  for (const std::size_t i : cut.elements_of(1)) EXPECT_FLOAT_EQ(indirect[i].z, 4);
}

TEST(Relight, RefusesWrongShapes) {
  const Cut& cut = two_lamps();
  const std::size_t n = cut.tessellation.elements();
  const Gain gain(n, 1);
  const auto reflectance = cut.reflectances();
  const std::vector<Rgb> short_one(n - 1);
  EXPECT_THROW(relight(cut.scene, cut.tessellation, short_one, cut.emissions(), gain, {}, {}),
               ShapeError);
  EXPECT_THROW(relight(cut.scene, cut.tessellation, reflectance, short_one, gain, {}, {}),
               ShapeError);
  EXPECT_THROW(relight(cut.scene, cut.tessellation, reflectance, cut.emissions(), gain, {},
                       constant_responses(1, 1)),
               ShapeError);
}

TEST(Relight, NoLightsIsDark) {
  const Cut& cut = two_lamps();
  const Gain gain(cut.tessellation.elements(), 1);
  const RelitResult lit =
      relight(cut.scene, cut.tessellation, cut.reflectances(), cut.emissions(), gain, {}, {});
  EXPECT_EQ(lit.radiosity, std::vector<Rgb>(cut.tessellation.elements()));
}

}  // namespace
}  // namespace relumbre
