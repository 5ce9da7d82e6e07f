#include "relumbre/radiosity/scalar_form_factors.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "relumbre/base/parallel.h"
#include "relumbre/radiosity/emitting_surface.h"
#include "relumbre/radiosity/form_factor_rows.h"
#include "relumbre/radiosity/hit_labels.h"
#include "relumbre/radiosity/ray_maps.h"
#include "relumbre/radiosity/ray_pattern.h"

namespace relumbre {

namespace {

constexpr std::size_t kBatch = 256;

/// How often each column was hit; kAbsorbed and kEscaped are columns too.
using Row = std::map<std::uint32_t, std::uint32_t>;

BvhRay ray_of(const EmittingSurface& surface, const RayPattern& pattern, const DigitalShift& shift,
              std::size_t r) {
  const auto at = [&](std::size_t d) {
    return ray_maps::to_cell(pattern.coordinate(d)[r] ^ shift[d]);
  };
  ray_maps::Point point{at(0), at(1), at(2), at(3)};
  const std::uint32_t facet = ray_maps::choose_facet(
      surface.cumulative(), static_cast<std::uint32_t>(surface.size()), point.x);
  alignas(16) const EmittingSurface::Record record = surface.records()[facet];
  const ElementRay ray = element_ray(record.data(), point);
  return {ray.origin_x,    ray.origin_y,    ray.origin_z,    0,
          ray.direction_x, ray.direction_y, ray.direction_z, 3e38F};
}

std::uint32_t column_of(const BvhHit& hit, const LabelLocator& locator) {
  if (!hit.hit()) return kEscaped;
  const std::uint32_t label = locator.find(hit.triangle(), hit.back(), hit.u, hit.v);
  return label == kNone ? kAbsorbed : label;
}

Row trace_row(const BvhTracer& scene, const LabelLocator& locator, const RayPattern& pattern,
              const EmittingSurface& surface, const DigitalShift& shift) {
  std::array<BvhRay, kBatch> rays;
  std::array<BvhHit, kBatch> hits;
  Row row;
  for (std::size_t first = 0; first < pattern.rays(); first += kBatch) {
    const std::size_t count = std::min<std::size_t>(kBatch, pattern.rays() - first);
    for (std::size_t i = 0; i < count; ++i) rays[i] = ray_of(surface, pattern, shift, first + i);
    trace_closest(scene.view(), std::span<const BvhRay>(rays).first(count),
                  std::span(hits).first(count));
    for (std::size_t i = 0; i < count; ++i) ++row[column_of(hits[i], locator)];
  }
  return row;
}

void append(FormFactors& to, const Row& row) {
  for (const auto& [column, count] : row) {
    if (column < kAbsorbed) {
      to.counts.column.push_back(column);
      to.counts.count.push_back(count);
      to.tally.hits += count;
    } else {
      (column == kAbsorbed ? to.tally.back_face : to.tally.escaped) += count;
    }
  }
  to.counts.row_offsets.push_back(to.counts.column.size());
}

}  // namespace

FormFactors scalar_form_factors(const BvhTracer& scene, float clearance,
                                const Tessellation& tessellation, const FormFactorConfig& config,
                                Binning binning, std::span<const std::uint32_t> elements) {
  const RayPattern pattern(config.rays);
  const LabelLocator locator = label_locator(tessellation, binning);
  std::vector<Row> rows(elements.size());
  parallel_for(0, rows.size(), 4, [&](std::size_t i) {
    EmittingSurface surface;
    load_element(tessellation, elements[i], clearance, surface);
    rows[i] = trace_row(scene, locator, pattern, surface, digital_shift(config.seed, elements[i]));
  });
  FormFactors all;
  all.counts.columns = columns_of(tessellation, binning), all.counts.rays = config.rays;
  for (const Row& row : rows) append(all, row);
  return all;
}

}  // namespace relumbre
