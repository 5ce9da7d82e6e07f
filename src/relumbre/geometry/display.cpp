#include "relumbre/geometry/display.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/geometry/position_index.h"
#include "relumbre/geometry/smoothing.h"

namespace relumbre {
namespace {

constexpr std::size_t kGrain = 4096;

/// Loops whose vertices are still positions.
struct Loops {
  std::vector<std::uint32_t> offsets{0};
  std::vector<std::uint32_t> positions;
  std::vector<float> places;
  std::vector<float> angles;  ///< of the facet there: π at a hanging vertex
};

float corner_angle(const std::vector<Vec3f>& p, const Index3& corners, std::size_t i) {
  const Vec3d at(p[corners[i]]);
  const Vec3d a = Vec3d(p[corners[(i + 1) % 3]]) - at, b = Vec3d(p[corners[(i + 2) % 3]]) - at;
  // Never 0: the facets around a position must have weights that can be divided by their sum.
  return std::max(1e-3F, static_cast<float>(std::atan2(length(cross(a, b)), dot(a, b))));
}

class LoopBuilder {
 public:
  explicit LoopBuilder(const Tessellation& t) : tessellation_(t), index_(t.positions) {}

  Loops build() && {
    for (const Facet& facet : tessellation_.facets) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t start = loops_.positions.size();
        add_edge(facet.corners[i], facet.corners[(i + 1) % 3], 0, 1);
        loops_.angles.resize(loops_.positions.size(), std::numbers::pi_v<float>);
        loops_.angles[start] = corner_angle(tessellation_.positions, facet.corners, i);
      }
      loops_.offsets.push_back(static_cast<std::uint32_t>(loops_.positions.size()));
    }
    return std::move(loops_);
  }

 private:
  /// Appends p and whatever other facets have cut into the edge from p to q, without q.
  void add_edge(std::uint32_t p, std::uint32_t q, float from, float to) {
    const std::uint32_t middle =
        index_.find(midpoint(tessellation_.positions[p], tessellation_.positions[q]));
    // At the limit of float the midpoint is one of the ends.
    if (middle == kNone || middle == p || middle == q) {
      loops_.positions.push_back(p);
      loops_.places.push_back(from);
      return;
    }
    const float halfway = (from + to) / 2;
    add_edge(p, middle, from, halfway);
    add_edge(middle, q, halfway, to);
  }

  const Tessellation& tessellation_;
  PositionIndex index_;
  Loops loops_;
};

/// Loop entries sorted by position, and the facet of each entry.
struct Around {
  std::vector<std::uint32_t> offsets;  ///< positions + 1
  std::vector<std::uint32_t> entries;
  std::vector<std::uint32_t> facet_of_entry;
};

Around entries_by_position(const Loops& loops, std::size_t positions) {
  Around around;
  around.offsets.assign(positions + 1, 0);
  for (const std::uint32_t p : loops.positions) ++around.offsets[p + 1];
  std::partial_sum(around.offsets.begin(), around.offsets.end(), around.offsets.begin());
  std::vector<std::uint32_t> next(around.offsets.begin(), around.offsets.end() - 1);
  around.entries.resize(loops.positions.size());
  around.facet_of_entry.resize(loops.positions.size());
  for (std::size_t f = 0; f + 1 < loops.offsets.size(); ++f) {
    for (std::uint32_t e = loops.offsets[f]; e < loops.offsets[f + 1]; ++e) {
      around.entries[next[loops.positions[e]]++] = e;
      around.facet_of_entry[e] = static_cast<std::uint32_t>(f);
    }
  }
  return around;
}

Vec3f facet_normal(const Tessellation& t, const Facet& facet) {
  const Vec3d a(t.positions[facet.corners[0]]);
  return Vec3f(normalized(
      cross(Vec3d(t.positions[facet.corners[1]]) - a, Vec3d(t.positions[facet.corners[2]]) - a)));
}

struct Share {
  std::uint32_t group, element;
  float weight;
};

/// Turns positions into display vertices, one position after the other.
class VertexBuilder {
 public:
  VertexBuilder(const Tessellation& t, const Loops& loops, float crease_deg,
                std::span<const std::uint32_t> labels)
      : tessellation_(t),
        loops_(loops),
        labels_(labels),
        groups_(crease_deg),
        around_(entries_by_position(loops, t.positions.size())),
        element_of_facet_(t.element_of_facet()) {
    result_.loop_vertices.resize(loops.positions.size());
    result_.share_offsets.push_back(0);
  }

  DisplayMesh build() && {
    for (std::size_t p = 0; p < tessellation_.positions.size(); ++p) {
      const std::span entries =
          std::span(around_.entries)
              .subspan(around_.offsets[p], around_.offsets[p + 1] - around_.offsets[p]);
      if (!entries.empty()) add_position(static_cast<std::uint32_t>(p), entries);
    }
    return std::move(result_);
  }

 private:
  void add_position(std::uint32_t position, std::span<const std::uint32_t> entries) {
    const auto first_vertex = static_cast<std::uint32_t>(result_.vertices());
    incidences_.clear();
    for (const std::uint32_t e : entries) incidences_.push_back(incidence(e));
    const std::span<const std::uint32_t> groups = groups_.divide(incidences_);
    shares_.clear();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::uint32_t entry = entries[i];
      result_.loop_vertices[entry] = first_vertex + groups[i];
      const std::uint32_t element = element_of_facet_[around_.facet_of_entry[entry]];
      shares_.push_back({groups[i], element, loops_.angles[entry]});
    }
    std::stable_sort(shares_.begin(), shares_.end(), [](const Share& a, const Share& b) {
      return a.group != b.group ? a.group < b.group : a.element < b.element;
    });
    add_vertices(position);
  }

  [[nodiscard]] Incidence incidence(std::uint32_t entry) const {
    const Facet& facet = tessellation_.facets[around_.facet_of_entry[entry]];
    const std::uint32_t label = labels_.empty() ? 0 : labels_[facet.triangle];
    return {facet_normal(tessellation_, facet), facet.triangle, facet.back, label};
  }

  /// One display vertex per run of equal groups in shares_.
  void add_vertices(std::uint32_t position) {
    for (std::size_t first = 0, last = 0; first < shares_.size(); first = last) {
      float sum = 0;
      for (; last < shares_.size() && shares_[last].group == shares_[first].group; ++last) {
        sum += shares_[last].weight;
      }
      for (std::size_t i = first; i < last; ++i) {
        const bool again = i > first && shares_[i].element == shares_[i - 1].element;
        const float weight = shares_[i].weight / sum;
        if (again) {
          result_.share_weights.back() += weight;
        } else {
          result_.share_elements.push_back(shares_[i].element);
          result_.share_weights.push_back(weight);
        }
      }
      result_.vertex_positions.push_back(position);
      result_.share_offsets.push_back(static_cast<std::uint32_t>(result_.share_elements.size()));
    }
  }

  const Tessellation& tessellation_;
  const Loops& loops_;
  std::span<const std::uint32_t> labels_;
  SmoothGroups groups_;
  Around around_;
  std::vector<std::uint32_t> element_of_facet_;
  std::vector<Incidence> incidences_;
  std::vector<Share> shares_;
  DisplayMesh result_;
};

void check_labels(const Tessellation& t, std::span<const std::uint32_t> labels) {
  const std::size_t triangles = t.locator.roots.size() / 2;
  if (labels.empty() || labels.size() >= triangles) return;
  throw ShapeError(fmt::format("separate: {} labels for {} triangles", labels.size(), triangles));
}

}  // namespace

DisplayMesh conforming_mesh(const Tessellation& tessellation, float crease_deg,
                            std::span<const std::uint32_t> separate) {
  check_labels(tessellation, separate);
  Loops loops = LoopBuilder(tessellation).build();
  DisplayMesh mesh = VertexBuilder(tessellation, loops, crease_deg, separate).build();
  mesh.loop_offsets = std::move(loops.offsets);
  mesh.loop_places = std::move(loops.places);
  return mesh;
}

std::vector<Rgb> vertex_values(const DisplayMesh& mesh, std::span<const Rgb> element_values) {
  for (const std::uint32_t element : mesh.share_elements) {
    if (element >= element_values.size()) {
      throw ShapeError(fmt::format("element values: {}, but element {} is needed",
                                   element_values.size(), element));
    }
  }
  std::vector<Rgb> values(mesh.vertices());
  parallel_for(0, values.size(), kGrain, [&](std::size_t v) {
    for (std::uint32_t s = mesh.share_offsets[v]; s < mesh.share_offsets[v + 1]; ++s) {
      values[v] += element_values[mesh.share_elements[s]] * mesh.share_weights[s];
    }
  });
  return values;
}

DisplaySample display_sample(const DisplayMesh& mesh, std::uint32_t facet, float u, float v) {
  const std::array<float, 3> weight{1 - u - v, u, v};
  // The sector of the fan between corners i and i + 1 is where the third corner weighs least.
  const std::size_t edge = weight[2] <= weight[0] && weight[2] <= weight[1] ? 0
                           : weight[0] <= weight[1]                         ? 1
                                                                            : 2;
  const float least = std::max(0.0F, weight[(edge + 2) % 3]);
  const float rim = std::max(0.0F, 1 - 3 * least);
  const float towards_end = std::max(0.0F, weight[(edge + 1) % 3] - least);
  const float place = rim > 0 ? std::min(1.0F, towards_end / rim) : 0.0F;

  const std::uint32_t begin = mesh.loop_offsets[facet], end = mesh.loop_offsets[facet + 1];
  std::uint32_t at = begin;
  for (std::size_t corners = 0; corners < edge;) corners += mesh.loop_places[++at] == 0 ? 1 : 0;
  const auto is_last = [&](std::uint32_t e) {
    return e + 1 == end || mesh.loop_places[e + 1] == 0;
  };
  while (!is_last(at) && mesh.loop_places[at + 1] <= place) ++at;
  const float from = mesh.loop_places[at], to = is_last(at) ? 1 : mesh.loop_places[at + 1];
  const float local = (place - from) / (to - from);
  return {mesh.loop_vertices[at], mesh.loop_vertices[at + 1 == end ? begin : at + 1],
          rim * (1 - local), rim * local, 1 - rim};
}

std::vector<Index3> fan_triangles(const DisplayMesh& mesh) {
  std::vector<Index3> triangles;
  triangles.reserve(mesh.loop_vertices.size());
  for (std::size_t f = 0; f < mesh.facets(); ++f) {
    const auto center = static_cast<std::uint32_t>(mesh.vertices() + f);
    const std::uint32_t begin = mesh.loop_offsets[f], end = mesh.loop_offsets[f + 1];
    for (std::uint32_t e = begin; e < end; ++e) {
      const std::uint32_t next = e + 1 == end ? begin : e + 1;
      triangles.push_back({mesh.loop_vertices[e], mesh.loop_vertices[next], center});
    }
  }
  return triangles;
}

}  // namespace relumbre
