#include "relumbre/render/colored_mesh.h"

#include "relumbre/render/shading.h"

namespace relumbre {

ColoredMesh colored_mesh(const Tessellation& tessellation, const DisplayMesh& display,
                         std::span<const Rgb> values) {
  const DisplayField field(tessellation, display, values);
  ColoredMesh mesh;
  mesh.triangles = fan_triangles(display);
  mesh.positions.reserve(display.vertices() + tessellation.facets.size());
  for (const std::uint32_t p : display.vertex_positions) {
    mesh.positions.push_back(tessellation.positions[p]);
  }
  for (const Facet& facet : tessellation.facets) {
    Vec3f sum;
    for (const std::uint32_t corner : facet.corners) sum += tessellation.positions[corner];
    mesh.positions.push_back(sum / 3);
  }
  mesh.colors.assign(field.at_vertices().begin(), field.at_vertices().end());
  mesh.colors.insert(mesh.colors.end(), field.at_centers().begin(), field.at_centers().end());
  return mesh;
}

}  // namespace relumbre
