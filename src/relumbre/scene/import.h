/// Scenes from files other tools write: OBJ with MTL, PLY, STL, glTF 2.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/scene/scene.h"

namespace relumbre {

enum class Sides {
  kAuto,  ///< glTF: as each material's doubleSided says. Other formats, whose winding cannot be
          ///< trusted: two-sided
  kOne,   ///< every surface reflects and emits on its front only
  kTwo,   ///< every surface reflects and emits on both sides
};

struct ImportConfig {
  Sides sides = Sides::kAuto;
  float scale = 1;                   ///< metres a unit of the file; positive
  bool photometric_lights = false;   ///< glTF's punctual lights are candela and lux: divide by 683
  float default_reflectance = 0.5F;  ///< of surfaces without a material (all of PLY's and STL's)
};

struct ImportReport {
  std::size_t degenerate = 0, duplicate = 0, non_finite = 0;  ///< triangles dropped
  std::size_t points_and_lines = 0;                           ///< primitives dropped
  std::vector<std::string> warnings;  ///< one line each, naming the material, texture or file
};

struct ImportResult {
  Scene scene;
  ImportReport report;
};

/// Reads .obj, .ply, .stl, .gltf and .glb (told apart by extension) through Assimp 5.2 or later.
///
///   geometry   polygons are cut into triangles, node transforms applied (mirrored ones flip the
///              winding), then cleaned (geometry/clean.h)
///   objects    one a glTF node with a mesh, one an OBJ object or group; names are made unique by a
///              suffix ".2", ".3", ...
///   materials  glTF base colour factor and texture (metals too: their reflectance is the base
///              colour), OBJ Kd and map_Kd (a Kd of zero beside a map counts as one), all as linear
///              values; textures are PNG or JPEG, embedded or below the scene's folder (a path that
///              leaves it is looked up beside the scene by file name)
///   colours    of vertices multiply the reflectance: glTF's COLOR_0 (linear), OBJ's and PLY's
///   (sRGB);
///              where a surface with them has no material it is white
///   emission   glTF emissiveFactor · KHR_materials_emissive_strength and OBJ Ke are exitance in
///              W/m²; an emissive texture counts with its mean
///   lights     KHR_lights_punctual (numbers are W/sr and W/m²), then one kEmitter for every object
///              with an emissive material, named as the object; names are unique
///   cameras    glTF perspective ones
///   normals    only where the file has them; a mesh without any beside others with them is flat
///
/// Reflectances above kMaxReflectance are clamped, as are negative ones and those that are not
/// numbers, with a warning; missing textures and material files are warnings too.
/// Throws FileError "FILE: reason" on one line: missing, empty, of another kind, truncated,
/// inconsistent, more than 2^30 triangles, without any usable triangle. Throws ValueError for a
/// scale that is not positive or a default reflectance outside [0, 1], Cancelled. Peak memory is
/// about 100 (PLY, glTF) to 220 (OBJ) bytes a triangle.
ImportResult import_scene(const std::filesystem::path& file, const ImportConfig& config = {},
                          Progress& progress = no_progress());

/// True if the extension is one that import_scene takes.
bool can_import(const std::filesystem::path& file);

}  // namespace relumbre
