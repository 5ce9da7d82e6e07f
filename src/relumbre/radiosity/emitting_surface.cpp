#include "relumbre/radiosity/emitting_surface.h"

#include <algorithm>
#include <bit>
#include <string>

#include "relumbre/base/error.h"

namespace relumbre {

void EmittingSurface::clear() {
  records_.clear();
  area_up_to_.clear();
  area_ = 0;
}

void EmittingSurface::add(const Vec3f& a, const Vec3f& b, const Vec3f& c, float clearance) {
  const Vec3f scaled_normal = cross(b - a, c - a);
  const float twice_area = length(scaled_normal);
  if (!(twice_area > 0)) return;
  const float bc = length(c - b), ca = length(a - c), ab = length(b - a);
  const float perimeter = ab + bc + ca;
  const Vec3f incentre = (a * bc + b * ca + c * ab) / perimeter;
  const float inradius = twice_area / perimeter;
  const float inset = std::min(0.5F, 2 * clearance / inradius);

  const Vec3f normal = scaled_normal / twice_area;
  const Vec3f corner = a + (incentre - a) * inset + normal * clearance;
  const Vec3f edge1 = (b - a) * (1 - inset), edge2 = (c - a) * (1 - inset);
  Record record{};
  std::size_t at = 0;
  for (const Vec3f& v : {corner, edge1, edge2, normal}) {
    for (std::size_t axis = 0; axis < 3; ++axis) record[at++] = v[axis];
  }
  records_.push_back(record);
  area_ += 0.5 * static_cast<double>(twice_area);
  area_up_to_.push_back(area_);
}

void EmittingSurface::finish() {
  const std::size_t count = records_.size();
  if (count < 2) return;  // nothing to choose from
  cumulative_.assign(2 * std::bit_ceil(count) + 1, 2.0F);
  cumulative_[0] = 0;
  for (std::size_t j = 0; j + 1 < count; ++j) {
    cumulative_[j + 1] = static_cast<float>(area_up_to_[j] / area_);
  }
  cumulative_[count] = 1;
}

void load_element(const Tessellation& tessellation, std::size_t element, float clearance,
                  EmittingSurface& surface) {
  surface.clear();
  for (const Facet& facet : tessellation.facets_of(element)) {
    const auto& [a, b, c] = facet.corners;
    surface.add(tessellation.positions[a], tessellation.positions[b], tessellation.positions[c],
                clearance);
  }
  if (surface.size() == 0) throw ValueError("element " + std::to_string(element) + " has no area");
  surface.finish();
}

}  // namespace relumbre
