/// The Cornell box as measured by the Cornell University Program of Computer Graphics ("Cornell Box
/// Data", graphics.cornell.edu/online/box/data.html; Goral et al. 1984, Meyer et al. 1986).
#include <array>

#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/scene_builder.h"

namespace relumbre {

namespace {

/// The published figures are millimetres.
Vec3f mm(float x, float y, float z) { return Vec3f(x, y, z) * 0.001F; }

/// Linear Rec. 709 reflectances. Each is the published spectrum (400 to 700 nm, every 4 nm) under
/// illuminant D65, integrated at 1 nm against the CIE 1931 observer in the analytic fit of Wyman,
/// Sloan and Shirley 2013, divided by the same integral of a perfect white.
constexpr Rgb kWhite{0.738F, 0.736F, 0.740F};
constexpr Rgb kRed{0.490F, 0.050F, 0.051F};
constexpr Rgb kGreen{0.069F, 0.398F, 0.087F};

/// The lamp's published spectrum (400: 0, 500: 8, 600: 15.6, 700 nm: 18.4), integrated likewise and
/// divided by an equal-energy spectrum, is in the proportion 1 : 0.667 : 0.178. Exitance in W/m².
constexpr Rgb kLamp{60.0F, 40.0F, 10.7F};

void add_walls(SceneBuilder& builder, std::uint32_t white, std::uint32_t red, std::uint32_t green) {
  const auto wall = [&](const char* name, std::uint32_t material, const Vec3f& a, const Vec3f& b,
                        const Vec3f& c, const Vec3f& d) {
    builder.begin_object(name);
    builder.use(material);
    builder.quad(a, b, c, d);
  };
  wall("floor", white, mm(552.8F, 0, 0), mm(0, 0, 0), mm(0, 0, 559.2F), mm(549.6F, 0, 559.2F));
  wall("ceiling", white, mm(556, 548.8F, 0), mm(556, 548.8F, 559.2F), mm(0, 548.8F, 559.2F),
       mm(0, 548.8F, 0));
  wall("back wall", white, mm(549.6F, 0, 559.2F), mm(0, 0, 559.2F), mm(0, 548.8F, 559.2F),
       mm(556, 548.8F, 559.2F));
  wall("red wall", red, mm(552.8F, 0, 0), mm(549.6F, 0, 559.2F), mm(556, 548.8F, 559.2F),
       mm(556, 548.8F, 0));
  wall("green wall", green, mm(0, 0, 559.2F), mm(0, 0, 0), mm(0, 548.8F, 0), mm(0, 548.8F, 559.2F));
}

/// An upright prism over a quadrilateral given in (x, z), clockwise seen from above: six faces.
/// It stands on the floor, so its bottom and the floor below it see nothing but each other's backs
/// and stay dark.
void add_block(SceneBuilder& builder, const char* name, const std::array<Vec2f, 4>& base,
               float height) {
  builder.begin_object(name);
  const auto low = [&](std::size_t i) { return mm(base[i % 4].x, 0, base[i % 4].y); };
  const auto high = [&](std::size_t i) { return mm(base[i % 4].x, height, base[i % 4].y); };
  builder.quad(high(0), high(1), high(2), high(3));
  builder.quad(low(3), low(2), low(1), low(0));
  for (std::size_t i = 0; i < 4; ++i) builder.quad(low(i), low(i + 1), high(i + 1), high(i));
}

/// The measured lamp is flush with the ceiling; here it hangs 1 mm lower, or the ceiling, which
/// has no hole for it, would hide it.
void add_lamp(SceneBuilder& builder) {
  constexpr float kHeight = 548.8F - 1;
  builder.begin_object("lamp");
  Material lamp;
  lamp.name = "lamp";
  lamp.reflectance = Rgb(0.78F);  // as measured
  lamp.emission = kLamp;
  builder.use(builder.add_material(lamp));
  builder.quad(mm(343, kHeight, 227), mm(343, kHeight, 332), mm(213, kHeight, 332),
               mm(213, kHeight, 227));
}

}  // namespace

Scene make_cornell_scene() {
  SceneBuilder builder;
  const auto white = builder.add_matt("white", kWhite);
  const auto red = builder.add_matt("red", kRed);
  const auto green = builder.add_matt("green", kGreen);
  add_walls(builder, white, red, green);
  builder.use(white);
  add_block(builder, "short block", {{{130, 65}, {82, 225}, {240, 272}, {290, 114}}}, 165);
  add_block(builder, "tall block", {{{423, 247}, {265, 296}, {314, 456}, {472, 406}}}, 330);
  add_lamp(builder);
  // The published camera: 35 mm focal length, 25 mm square film.
  builder.add_camera({"main", mm(278, 273, -800), mm(278, 273, 0), {0, 1, 0}, 39.3077F});
  return std::move(builder).finish();
}

}  // namespace relumbre
