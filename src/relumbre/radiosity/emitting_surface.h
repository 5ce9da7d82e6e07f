/// A set of facets that rays leave from.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "relumbre/base/vec3.h"
#include "relumbre/geometry/tessellation.h"

namespace relumbre {

/// Facets in the form that the ray generator reads.
///
/// Each facet is lifted by `clearance` along its normal, so that its rays do not hit it again, and
/// drawn in by twice that from its edges (by half its size at most), so that none starts beyond a
/// wall that meets it there.
///
///   one facet, 12 floats:  corner xyz | edge 1 xyz | edge 2 xyz | unit normal xyz
///   cumulative             0 ... a ... 1 | 2 ... 2     area up to facet j / whole area, padded so
///                                                      that a binary search needs no bounds
class EmittingSurface {
 public:
  static constexpr std::size_t kFloats = 12;
  using Record = std::array<float, kFloats>;

  void clear();
  /// Counter-clockwise seen from where the rays go. A facet without area is passed over.
  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c, float clearance);
  /// To be called after the last add().
  void finish();

  /// Facets that have an area.
  [[nodiscard]] std::size_t size() const { return records_.size(); }
  /// Of the facets as they were given, m².
  [[nodiscard]] double area() const { return area_; }
  [[nodiscard]] const Record* records() const { return records_.data(); }
  /// cumulative()[j] ≤ x < cumulative()[j + 1]: x in [0, 1) chooses facet j.
  [[nodiscard]] const float* cumulative() const { return cumulative_.data(); }

 private:
  std::vector<Record> records_;
  std::vector<double> area_up_to_;
  std::vector<float> cumulative_;
  double area_ = 0;
};

/// Makes `surface` that of an element. Throws ValueError for an element without area. O(facets).
void load_element(const Tessellation& tessellation, std::size_t element, float clearance,
                  EmittingSurface& surface);

}  // namespace relumbre
