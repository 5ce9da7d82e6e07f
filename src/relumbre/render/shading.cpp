#include "relumbre/render/shading.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/geometry/facet.h"

namespace relumbre {

namespace {

constexpr std::size_t kGrain = 2048;
constexpr std::size_t kMaxRings = 8;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

bool known(const Rgb& v) { return !std::isnan(v.x + v.y + v.z); }

/// A weighted mean that passes over unknown channels.
class KnownMean {
 public:
  void add(const Rgb& value, float weight) {
    for (std::size_t c = 0; c < 3; ++c) {
      if (std::isnan(value[c])) continue;
      sum_[c] += value[c] * weight;
      weight_[c] += weight;
    }
  }
  [[nodiscard]] Rgb mean() const {
    Rgb mean(kUnknown);
    for (std::size_t c = 0; c < 3; ++c) {
      if (weight_[c] > 0) mean[c] = sum_[c] / weight_[c];
    }
    return mean;
  }

 private:
  Rgb sum_, weight_;
};

std::span<const std::uint32_t> loop_of(const DisplayMesh& display, std::size_t facet) {
  return std::span(display.loop_vertices)
      .subspan(display.loop_offsets[facet],
               display.loop_offsets[facet + 1] - display.loop_offsets[facet]);
}

std::vector<Rgb> known_vertex_values(const DisplayMesh& display, std::span<const Rgb> values) {
  std::vector<Rgb> vertices(display.vertices());
  parallel_for(0, vertices.size(), kGrain, [&](std::size_t v) {
    KnownMean mean;
    for (std::uint32_t s = display.share_offsets[v]; s < display.share_offsets[v + 1]; ++s) {
      mean.add(values[display.share_elements[s]], display.share_weights[s]);
    }
    vertices[v] = mean.mean();
  });
  return vertices;
}

float facet_area(const Tessellation& t, const Facet& facet) {
  const Vec3f a = t.positions[facet.corners[0]];
  return length(cross(t.positions[facet.corners[1]] - a, t.positions[facet.corners[2]] - a)) / 2;
}

/// Mean over the loops of an element's facets, by the facets' areas.
Rgb mean_around(const Tessellation& t, const DisplayMesh& display, std::span<const Rgb> vertices,
                std::size_t element) {
  KnownMean mean;
  for (std::size_t f = t.facet_offsets[element]; f < t.facet_offsets[element + 1]; ++f) {
    const auto loop = loop_of(display, f);
    const float weight = facet_area(t, t.facets[f]) / static_cast<float>(loop.size());
    for (const std::uint32_t v : loop) mean.add(vertices[v], weight);
  }
  return mean.mean();
}

void require_elements(std::size_t values, std::size_t elements) {
  if (values == elements) return;
  throw ShapeError(fmt::format("shading: {} values for {} elements", values, elements));
}

}  // namespace

std::vector<Rgb> fill_unknown(const Tessellation& tessellation, const DisplayMesh& display,
                              std::vector<Rgb> values) {
  require_elements(values.size(), tessellation.elements());
  for (std::size_t ring = 0; ring < kMaxRings; ++ring) {
    if (std::ranges::all_of(values, known)) return values;
    const std::vector<Rgb> vertices = known_vertex_values(display, values);
    parallel_for(0, values.size(), kGrain, [&](std::size_t i) {
      if (known(values[i])) return;
      const Rgb around = mean_around(tessellation, display, vertices, i);
      for (std::size_t c = 0; c < 3; ++c) {
        if (std::isnan(values[i][c])) values[i][c] = around[c];
      }
    });
  }
  for (Rgb& v : values) {
    for (std::size_t c = 0; c < 3; ++c) v[c] = std::isnan(v[c]) ? 0.0F : v[c];
  }
  return values;
}

std::vector<Rgb> smoothed(const Tessellation& tessellation, const DisplayMesh& display,
                          std::vector<Rgb> values, std::size_t passes) {
  require_elements(values.size(), tessellation.elements());
  for (std::size_t pass = 0; pass < passes; ++pass) {
    const std::vector<Rgb> vertices = vertex_values(display, values);
    parallel_for(0, values.size(), kGrain, [&](std::size_t i) {
      const Rgb around = mean_around(tessellation, display, vertices, i);
      if (known(around)) values[i] = around;
    });
  }
  return values;
}

DisplayField::DisplayField(const Tessellation& tessellation, const DisplayMesh& display,
                           std::span<const Rgb> values)
    : tessellation_(tessellation), display_(display) {
  require_elements(values.size(), tessellation.elements());
  vertices_ = vertex_values(display, values);
  centers_.resize(tessellation.facets.size());
  parallel_for(0, tessellation.elements(), kGrain, [&](std::size_t i) {
    const std::size_t first = tessellation.facet_offsets[i];
    const std::size_t last = tessellation.facet_offsets[i + 1];
    if (last - first == 1) {
      centers_[first] = values[i];
      return;
    }
    for (std::size_t f = first; f < last; ++f) {
      const auto loop = loop_of(display_, f);
      for (const std::uint32_t v : loop) centers_[f] += vertices_[v];
      centers_[f] /= static_cast<float>(loop.size());
    }
  });
}

Rgb DisplayField::at(std::uint32_t triangle, bool back, float u, float v) const {
  const FacetPoint point = locate_point(tessellation_.locator, triangle, back, u, v);
  if (point.facet == kNone) return {};
  const DisplaySample s = display_sample(display_, point.facet, point.u, point.v);
  return vertices_[s.vertex0] * s.weight0 + vertices_[s.vertex1] * s.weight1 +
         centers_[point.facet] * s.center;
}

ShadingInput shading_input(const Tessellation& tessellation, const DisplayMesh& display,
                           const RelitResult& lit, std::span<const Rgb> reflectance,
                           std::size_t smoothing_passes) {
  std::vector<Rgb> indirect =
      fill_unknown(tessellation, display, indirect_irradiance(lit, reflectance));
  return {lit.direct_irradiance,
          smoothed(tessellation, display, std::move(indirect), smoothing_passes)};
}

}  // namespace relumbre
