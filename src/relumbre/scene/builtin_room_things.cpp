#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "relumbre/base/sampling.h"
#include "relumbre/scene/builtin_room.h"

namespace relumbre {

namespace {

/// One board's books from left to right: upright, of varied size and colour, none touching. Leaves
/// a free end of `free_width` for something else.
class Librarian {
 public:
  explicit Librarian(SceneBuilder& builder) : builder_(builder) {
    constexpr std::array<Rgb, 8> kCloths{{{0.45F, 0.08F, 0.06F},
                                          {0.08F, 0.17F, 0.36F},
                                          {0.66F, 0.58F, 0.42F},
                                          {0.10F, 0.28F, 0.15F},
                                          {0.70F, 0.38F, 0.07F},
                                          {0.30F, 0.30F, 0.31F},
                                          {0.74F, 0.72F, 0.68F},
                                          {0.32F, 0.10F, 0.26F}}};
    for (std::size_t i = 0; i < kCloths.size(); ++i)
      cloths_[i] = builder.add_matt("book cloth " + std::to_string(i + 1), kCloths[i]);
  }

  void fill(float level, float left_free, float right_free) {
    constexpr float kGap = 0.0015F, kLift = 0.0005F;
    const float end = kShelf.u1 - kShelfBoard - right_free - 0.004F;
    float x = kShelf.u0 + kShelfBoard + left_free + 0.004F;
    while (true) {
      const float width = 0.018F + 0.034F * random_.uniform();
      const float height = 0.19F + 0.11F * random_.uniform();
      const float depth = 0.14F + 0.06F * random_.uniform();
      builder_.use(cloths_[random_.bits() % cloths_.size()]);
      if (x + width > end) return;
      const float front = kShelf.v1 - 0.02F - 0.015F * random_.uniform();
      add_box(builder_, {x, level + kLift, front - depth}, {x + width, level + height, front});
      x += width + kGap;
    }
  }

 private:
  SceneBuilder& builder_;
  std::array<std::uint32_t, 8> cloths_{};
  RandomStream random_{20};
};

void add_books(SceneBuilder& builder) {
  builder.begin_object("books");
  Librarian librarian(builder);
  librarian.fill(kShelfLevels[0], 0, 0.30F);
  librarian.fill(kShelfLevels[1], 0, 0);
  librarian.fill(kShelfLevels[2], 0.34F, 0);
  librarian.fill(kShelfLevels[3], 0, 0.22F);
  librarian.fill(kShelfLevels[4], 0.30F, 0.12F);
}

/// Walls of pottery: the outside from the foot up, over the lip, and the inside down again.
std::vector<Vec2f> vessel(std::span<const Vec2f> outside, float wall) {
  std::vector<Vec2f> profile(outside.begin(), outside.end());
  profile.insert(profile.begin(), {0, outside.front().y});
  const Vec2f lip = outside.back();
  profile.push_back({lip.x - wall / 2, lip.y + wall / 3});
  for (std::size_t i = outside.size(); i-- > 0;)
    if (outside[i].x > wall && outside[i].y >= outside.front().y + wall)
      profile.push_back({outside[i].x - wall, outside[i].y});
  profile.push_back({0, profile.back().y});
  return profile;
}

/// A slender vase: its radius is a sine wave on a taper.
std::vector<Vec2f> vase_profile(float height, float radius) {
  constexpr int kSteps = 14;
  std::vector<Vec2f> outside;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(kSteps);
    outside.push_back({radius * (0.62F + 0.38F * std::sin(5.2F * t + 0.15F)), height * t});
  }
  return vessel(outside, 0.004F);
}

std::vector<Vec2f> bowl_profile(float radius, float height, float foot) {
  constexpr int kSteps = 9;
  std::vector<Vec2f> outside;
  for (int i = 0; i <= kSteps; ++i) {
    const float angle =
        std::numbers::pi_v<float> / 2 * static_cast<float>(i) / static_cast<float>(kSteps);
    outside.push_back({foot + (radius - foot) * std::sin(angle), height * (1 - std::cos(angle))});
  }
  return vessel(outside, 0.005F);
}

constexpr float kLift = 0.0005F;  ///< between a thing and what it stands on

void add_vessel(SceneBuilder& builder, const std::string& name, std::uint32_t material,
                const Vec3f& foot, std::span<const Vec2f> profile, int segments) {
  builder.begin_object(name);
  builder.use(material);
  const ScopedPlacement placed(builder, {foot + Vec3f(0, kLift, 0)});
  add_revolved(builder, profile, segments);
}

/// A cup on its saucer.
void add_cup(SceneBuilder& builder, const std::string& name, std::uint32_t material,
             const Vec3f& foot) {
  constexpr std::array<Vec2f, 6> kSaucer{
      {{0, 0}, {0.040F, 0}, {0.072F, 0.010F}, {0.071F, 0.013F}, {0.038F, 0.004F}, {0, 0.004F}}};
  add_vessel(builder, name, material, foot, kSaucer, 28);
  const std::array<Vec2f, 6> cup{{{0.022F, 0.0045F},
                                  {0.030F, 0.012F},
                                  {0.035F, 0.025F},
                                  {0.038F, 0.042F},
                                  {0.040F, 0.058F},
                                  {0.041F, 0.066F}}};
  const ScopedPlacement placed(builder, {foot + Vec3f(0, kLift, 0)});
  add_revolved(builder, vessel(cup, 0.003F), 28);
}

void add_fruit(SceneBuilder& builder, const Vec3f& bowl) {
  struct Fruit {
    const char* name;
    Rgb color;
    Vec3f center;
    float radius;
  };
  constexpr std::array<Fruit, 4> kFruit{
      {{"orange", {0.80F, 0.32F, 0.03F}, {0.045F, 0.052F, 0.020F}, 0.038F},
       {"apple", {0.50F, 0.06F, 0.04F}, {-0.040F, 0.050F, 0.030F}, 0.036F},
       {"lime", {0.30F, 0.48F, 0.06F}, {0.000F, 0.048F, -0.048F}, 0.034F},
       {"lemon", {0.82F, 0.66F, 0.08F}, {0.002F, 0.102F, 0.004F}, 0.033F}}};
  builder.begin_object("fruit");
  for (const Fruit& fruit : kFruit) {
    builder.use(builder.add_matt(fruit.name, fruit.color));
    add_sphere(builder, bowl + fruit.center, fruit.radius, 16);
  }
}

void add_crockery(SceneBuilder& builder, const RoomPalette& palette) {
  const Vec3f dining = kDiningCenter + Vec3f(0, kDiningHeight, 0);
  const Vec3f low{1.85F, kLowTableHeight, 1.80F};
  const auto blue = builder.add_matt("cobalt glaze", {0.05F, 0.12F, 0.42F});
  const auto sage = builder.add_matt("sage glaze", {0.36F, 0.47F, 0.30F});
  add_vessel(builder, "vase", blue, dining + Vec3f(0.05F, 0, -0.30F), vase_profile(0.30F, 0.075F),
             30);
  const Vec3f bowl = dining + Vec3f(-0.02F, 0, 0.06F);
  add_vessel(builder, "bowl", palette.porcelain, bowl, bowl_profile(0.145F, 0.075F, 0.06F), 40);
  add_fruit(builder, bowl);
  add_cup(builder, "cup 1", palette.porcelain, dining + Vec3f(-0.20F, 0, 0.40F));
  add_cup(builder, "cup 2", palette.porcelain, dining + Vec3f(0.18F, 0, 0.36F));
  add_cup(builder, "cup 3", sage, low + Vec3f(0.28F, 0, 0.08F));
  add_vessel(builder, "low bowl", sage, low + Vec3f(-0.02F, 0, -0.05F),
             bowl_profile(0.12F, 0.06F, 0.05F), 36);
  const auto rust = builder.add_matt("rust glaze", {0.52F, 0.17F, 0.07F});
  add_vessel(builder, "shelf vase", rust, {3.66F, kShelfLevels[2], 0.17F},
             vase_profile(0.24F, 0.085F), 26);
  add_vessel(builder, "shelf bowl", palette.porcelain, {4.28F, kShelfLevels[3], 0.17F},
             bowl_profile(0.09F, 0.07F, 0.04F), 24);
}

void add_loose_books(SceneBuilder& builder) {
  builder.begin_object("loose books");
  struct Book {
    const char* name;
    Rgb color;
    float half_x, half_z, height, yaw_deg;
  };
  constexpr std::array<Book, 3> kBooks{
      {{"slate cover", {0.14F, 0.17F, 0.22F}, 0.13F, 0.10F, 0.028F, 8},
       {"cream cover", {0.74F, 0.68F, 0.54F}, 0.12F, 0.09F, 0.022F, -6},
       {"coral cover", {0.66F, 0.20F, 0.14F}, 0.10F, 0.075F, 0.018F, 19}}};
  float y = kLowTableHeight;
  for (const Book& book : kBooks) {
    builder.use(builder.add_matt(book.name, book.color));
    const ScopedPlacement lying(builder, turned({1.55F, y + kLift, 1.84F}, book.yaw_deg));
    add_rounded_box(builder, {-book.half_x, 0, -book.half_z},
                    {book.half_x, book.height, book.half_z}, 0.003F, 1);
    y += book.height + kLift;
  }
}

}  // namespace

void add_room_things(SceneBuilder& builder, const RoomPalette& palette) {
  add_books(builder);
  add_loose_books(builder);
  add_crockery(builder, palette);
}

}  // namespace relumbre
