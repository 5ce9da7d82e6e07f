/// A seamless mesh for Gouraud interpolation over a tessellation.
///
/// Neighbouring facets may be cut to different depths, so that a corner of one lies in the middle
/// of an edge of the other. Interpolating over bare facets would crack there. So each facet is
/// drawn as a fan around its centroid whose rim, the *loop*, also has these hanging corners:
///
///        c                        loop of (a, b, c) = a, h, b, c: four fan triangles
///       /|\         .
///      / | \        .             at the centroid: the value of the facet's element
///     /  *  \       .             at a loop vertex: the mean over the elements around it
///    / . | . \      .
///   a----h----b                   on an edge both facets interpolate the same two values
///     \ /|\ /
///
/// A *display vertex* is a position together with the facets there that are smooth with each other;
/// at a crease one position has several.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {

struct DisplayMesh {
  std::vector<std::uint32_t> loop_offsets;   ///< facets + 1
  std::vector<std::uint32_t> loop_vertices;  ///< display vertices, in the facet's orientation
  /// Where on its edge of the facet the vertex lies: 0 at a corner, j/2^m at a hanging one.
  std::vector<float> loop_places;

  std::vector<std::uint32_t>
      vertex_positions;                       ///< per display vertex, into Tessellation::positions
  std::vector<std::uint32_t> share_offsets;   ///< display vertices + 1
  std::vector<std::uint32_t> share_elements;  ///< ascending within a display vertex
  std::vector<float> share_weights;           ///< sum to 1 over a display vertex

  [[nodiscard]] std::size_t vertices() const { return vertex_positions.size(); }
  [[nodiscard]] std::size_t facets() const {
    return loop_offsets.empty() ? 0 : loop_offsets.size() - 1;
  }
};

/// Finds hanging corners and display vertices. Facets at a position share a display vertex if a
/// chain of facets there connects them in which the normals of neighbours differ by at most
/// crease_deg and the labels agree; the two sides of one triangle never do. An element's weight is
/// its facets' angle there, π where the position lies within an edge. Expected O(facets) for
/// bounded numbers of facets at a position; where more than 64 meet, normals are rounded to about
/// 3 degrees. `separate` is empty, or a label per source triangle (materials, for example): values
/// are not smoothed across labels. Throws ShapeError if it is too short.
DisplayMesh conforming_mesh(const Tessellation& tessellation, float crease_deg = 30,
                            std::span<const std::uint32_t> separate = {});

/// Values at the display vertices from values of the elements. Parallel over vertices.
/// Throws ShapeError if there are fewer element values than the mesh refers to.
std::vector<Rgb> vertex_values(const DisplayMesh& mesh, std::span<const Rgb> element_values);

/// How the value at a point of a facet is blended: weight0 · value[vertex0] + weight1 ·
/// value[vertex1] + center · value of the facet's element. The weights sum to 1.
struct DisplaySample {
  std::uint32_t vertex0, vertex1;  ///< display vertices, neighbours in the facet's loop
  float weight0, weight1, center;
};

/// At the point of `facet` where u and v weigh its corners 1 and 2 (as from locate_point).
/// O(length of the loop), mostly 3.
DisplaySample display_sample(const DisplayMesh& mesh, std::uint32_t facet, float u, float v);

/// All fan triangles, facet by facet. Index i < vertices() is a display vertex; vertices() + f is
/// the centroid of facet f.
std::vector<Index3> fan_triangles(const DisplayMesh& mesh);

}  // namespace relumbre
