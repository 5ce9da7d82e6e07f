/// Light sources that are not part of the transport operator: what lights.json describes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/image/image.h"
#include "relumbre/scene/ies.h"

namespace relumbre {

enum class LightType {
  kPoint,        ///< position; intensity in W/sr
  kSpot,         ///< position, direction, inner and outer half-angle; W/sr on the axis
  kDirectional,  ///< direction; irradiance in W/m² on a surface that faces it
  kQuad,         ///< corner, two edges; exitance in W/m² on the side edge1 × edge2 points to
  kIes,          ///< position, direction (where the luminaire points); scales an LM-63 profile
  kSky,          ///< latitude-longitude radiance image, W/m²/sr, +y up
  kEmitter,      ///< a scene object with an emissive material; scales its own exitance
};

struct Light {
  std::string name;
  LightType type = LightType::kPoint;
  Vec3f position;             ///< also the quad's corner
  Vec3f direction{0, -1, 0};  ///< unit; where the light travels
  Vec3f edge1, edge2;         ///< quad
  float inner_deg = 0, outer_deg = 45;
  float rotation_deg = 0;  ///< sky: about +y; ies: about its axis
  Rgb color{1.0F};         ///< multiplies intensity
  float intensity = 1;
  bool on = true;
  std::shared_ptr<const IesProfile> ies;
  std::shared_ptr<const Image> sky;
  std::string file;          ///< the IES or EXR file, for reports
  std::uint32_t object = 0;  ///< kEmitter: index into Scene::objects

  /// color · intensity, or zero when off.
  [[nodiscard]] Rgb power() const { return on ? color * intensity : Rgb{}; }
};

}  // namespace relumbre
