/// What a glTF material says that Assimp does not pass on faithfully. Internal to the import.
#pragma once

#include <string>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// An affine map of texture coordinates, v downwards.
struct TexcoordMap {
  Vec2f u{1, 0}, v{0, 1}, offset{};  ///< columns
  [[nodiscard]] constexpr Vec2f operator()(Vec2f at) const { return u * at.x + v * at.y + offset; }
};

struct GltfMaterial {
  std::string name;
  TexcoordMap texcoords;  ///< KHR_texture_transform of the base colour texture
};

}  // namespace relumbre
