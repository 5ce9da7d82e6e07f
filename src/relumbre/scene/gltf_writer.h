/// Writes scenes and relit meshes as glTF 2.0, for other tools and for import_scene.
#pragma once

#include <filesystem>
#include <span>

#include "relumbre/scene/scene.h"

namespace relumbre {

/// Writes .glb (one binary file) or .gltf (JSON with everything embedded), atomically.
///
///   objects    a node and a mesh each, one primitive a material; objects without triangles are
///              left out
///   materials  baseColorFactor, metallicFactor 0, roughnessFactor 1, doubleSided; emission is
///              emissiveFactor · KHR_materials_emissive_strength, exitance in W/m²
///   textures   embedded PNG
///   lights     points, spots and directional ones as KHR_lights_punctual; numbers are W/sr and
///              W/m², not candela and lux. A light that is off gets intensity 0. Emitters are in
///              the materials; quads, IES and sky lights have no place in glTF and are left out
///   cameras    perspective; the target is kept as a direction only
///
/// Names are kept. Throws ValueError for another extension, for numbers that are not finite, and
/// for indices out of range; FileError if the file cannot be written.
void write_gltf(const std::filesystem::path& path, const Scene& scene);

/// A mesh that shows its vertex colours as they are (KHR_materials_unlit), on both sides, as .glb
/// or .gltf. `colors` are linear RGB, one a vertex; glTF clamps them to [0, 1], so apply exposure
/// first. Throws ShapeError if sizes disagree or an index is out of range, else as write_gltf.
void write_colored_mesh(const std::filesystem::path& path, std::span<const Vec3f> positions,
                        std::span<const Index3> triangles, std::span<const Rgb> colors);

}  // namespace relumbre
