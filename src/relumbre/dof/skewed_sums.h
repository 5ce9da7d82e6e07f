/// Internal: running sums along the edges of polygons, which spread a blur in constant time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "relumbre/dof/depth_layers.h"
#include "relumbre/dof/lane_sums.h"
#include "relumbre/dof/skewed_outline.h"

namespace relumbre {

/// Sums of rows [first, last) of a picture of width × height, by skewed scans (Kosloff, Tao and
/// Barsky 2009): for every slope that edges have, a row of steps that moves sideways by the slope
/// from row to row. A blur adds a step where an edge begins and takes it away where the edge ends;
/// in between it takes part in every row by itself. The rows in which an edge begins or ends, which
/// it reaches into only partly, get steps of their own. Fractions of a column are shared out
/// between neighbours in proportion, so that every row of a blur has its light and its centre
/// exactly; slanted edges are up to a pixel softer than those of SpreadSums, upright ones are the
/// same.
///
/// Changes wait in a list for each row, and the rows are swept from top to bottom.
/// kUpright: all edges are, and blurs are not tilted.
template <class Sum, bool kUpright>
class SkewedSums {
 public:
  /// `outline` outlives this.
  SkewedSums(const SkewedOutline& outline, std::size_t width, std::size_t height, std::size_t first,
             std::size_t last)
      : outline_(outline),
        width_(static_cast<int>(width)),
        height_(static_cast<int>(height)),
        first_(static_cast<int>(first)),
        last_(static_cast<int>(last)),
        events_of_(last - first),
        edges_(outline.slopes.size()),
        sums_(width) {}

  /// Begins anew, for fragments of no larger diameter.
  void clear(float largest_diameter) {
    const int reach = reach_of(static_cast<double>(largest_diameter), outline_.half_width);
    margin_ = kUpright ? 0 : 2 * reach;  // a repetition may lie `reach` out, and reaches as far
    for (std::size_t i = 0; i < edges_.size(); ++i) make_edges(outline_.slopes[i], edges_[i]);
    row_.assign(static_cast<std::size_t>(margin_ + width_ + 2), Step{});
    std::ranges::fill(events_of_, kNone);
    sources_.clear(), events_.clear();
    top_ = last_, bottom_ = first_, left_ = width_, right_ = 0;
  }

  /// Beyond its border the picture goes on as it ends: fragments there are repeated as far as their
  /// blurs reach.
  void spread(const Fragment& fragment) {
    constexpr double kLeast = 1.0 / 64;  // what is in focus
    const double diameter = std::max(std::abs(static_cast<double>(fragment.coc)), kLeast);
    const double share = 1 / (outline_.area * diameter * diameter);
    const Sum light(fragment.color, static_cast<double>(fragment.coverage), share);
    const int aside = reach_of(diameter, outline_.half_width),
              down = reach_of(diameter, outline_.half_height);
    const Tilt tilt = kUpright ? Tilt{} : tilt_of(fragment, aside);
    const Repeats across = repeats(fragment.x, width_, aside, aside),
                  along = repeats(fragment.y, height_, down, down);
    const int begin = std::max(along.first, first_ - down),
              end = std::min(along.last, last_ - 1 + down);
    left_ = std::min(left_, across.first - aside), right_ = std::max(right_, across.last + aside);
    for (int y = begin; y <= end; ++y) {
      for (int x = across.first; x <= across.last; ++x) {
        sources_.push_back({light, diameter, tilt, x, y});
        await(sources_.back());
      }
    }
  }

  /// Calls use(y − first, begin, end, the row's sums) for rows y and columns [begin, end) that
  /// something was spread to.
  template <class Use>
  void integrate(Use&& use) {
    const auto begin = static_cast<std::size_t>(std::max(left_, 0)),
               end = static_cast<std::size_t>(std::min(right_ + 2, width_));
    for (int y = top_; y <= bottom_; ++y) {
      for (std::uint32_t i = events_of_[index(y)]; i != kNone; i = events_[i].next)
        happen(events_[i], y);
      if constexpr (!kUpright)
        for (const Edges& edges : edges_) add_edges(edges, y);
      add_up();
      use(index(y), begin, end, sums_.data());
    }
  }

 private:
  struct Flat {
    Sum value;
  };
  struct Sloped : Flat {
    Sum slope;
  };
  /// At this column and all to the right of it the sum grows by `value`, and from column to column
  /// by `slope`.
  using Step = std::conditional_t<kUpright, Flat, Sloped>;
  struct Rated : Sloped {
    Sum rate;
  };
  /// A step that goes on from row to row; `value` is of row `first` and grows by `rate` a row.
  using Cell = std::conditional_t<kUpright, Flat, Rated>;
  /// Those of one slope. In row y, column x is cell `origin` + x − slope · (y − first).
  struct Edges {
    double slope = 0;
    int origin = 0;
    std::vector<Cell> cells;
  };
  /// A blur.
  struct Source {
    Sum light;
    double diameter;
    Tilt tilt;
    int x, y;
  };
  /// Of what happens at a level: what does in the row in which it lies, what in the row below; or
  /// all, for a level above the stripe.
  enum class Part : std::uint16_t { kInside, kBelow, kBoth };
  struct Event {
    std::uint32_t source, next;
    std::uint16_t level;
    Part part;
  };
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] std::size_t index(int y) const { return static_cast<std::size_t>(y - first_); }
  static int reach_of(double diameter, double half) {
    return static_cast<int>(diameter * half) + 2;
  }
  /// A number as the next integer below it and the rest; std::floor is a call on older processors.
  struct Split {
    int whole;
    double fraction;
    explicit Split(double number) : whole(static_cast<int>(number)) {
      if (whole > number) --whole;
      fraction = number - whole;
    }
  };
  void make_edges(double slope, Edges& edges) const {
    const double drift = slope * (last_ - first_);
    const auto beyond = [](double columns) {
      return static_cast<int>(std::ceil(std::max(columns, 0.0))) + 2;
    };
    edges.slope = slope;
    edges.origin = margin_ + beyond(drift);
    edges.cells.assign(static_cast<std::size_t>(edges.origin + width_ + margin_ + beyond(-drift)),
                       Cell{});
  }

  void await(int y, std::size_t level, Part part) {
    if (y >= last_) bottom_ = last_ - 1;  // until then the blur goes on as it is
    if (y < first_ || y >= last_) return;
    std::uint32_t& head = events_of_[index(y)];
    events_.push_back({static_cast<std::uint32_t>(sources_.size() - 1), head,
                       static_cast<std::uint16_t>(level), part});
    head = static_cast<std::uint32_t>(events_.size() - 1);
    top_ = std::min(top_, y), bottom_ = std::max(bottom_, y);
  }
  void await(const Source& source) {
    for (std::size_t level = 0; level < outline_.levels.size(); ++level) {
      const int y = source.y + Split(height_of(source, level)).whole;
      if (y < first_) {
        await(first_, level, Part::kBoth);
      } else {
        await(y, level, Part::kInside);
        if (outline_.levels[level].begins) await(y + 1, level, Part::kBelow);
      }
    }
  }
  /// Of a level, from the upper rim of the source's row.
  [[nodiscard]] double height_of(const Source& source, std::size_t level) const {
    return source.diameter * outline_.levels[level].y + 0.5;
  }

  void happen(const Event& event, int y) {
    const Source& source = sources_[event.source];
    for (const SkewedOutline::Change& change : outline_.levels[event.level].changes)
      change_edge(source, change, height_of(source, event.level), event.part, y);
  }
  /// A level lies a fraction f down its row. An edge that begins there is in 1 − f of the row, one
  /// that ends in f of it; where it is in the middle of that, its step is.
  void change_edge(const Source& source, const SkewedOutline::Change& change, double height,
                   Part part, int y) {
    Edges& edges = edges_[change.slope];
    const double column = source.x + source.diameter * change.x + 0.5;
    if (part == Part::kInside) {
      const double f = Split(height).fraction, in_row = change.begins ? 1 - f : f;
      step(source, column + edges.slope * (change.begins ? in_row : -in_row) / 2,
           change.side * in_row, y);
    }
    if (part == Part::kBoth || change.begins == (part == Part::kBelow)) {
      const double rows = first_ - (source.y + height - 0.5);
      move_edge(edges, source, column + edges.slope * rows,
                change.begins ? change.side : -change.side);
    }
  }
  /// A step that goes on from here, or no longer does; `column` is where the edge is in row
  /// `first`.
  void move_edge(Edges& edges, const Source& source, double column, double weight) {
    if (edges.slope == 0) column = std::max(column, 0.0);
    const auto [begin, fraction] = Split(column);
    const int at = edges.origin + begin;
    if (at < 0 || at + 1 >= static_cast<int>(edges.cells.size())) return;  // never in the picture
    Cell& here = edges.cells[static_cast<std::size_t>(at)];
    Cell& next = edges.cells[static_cast<std::size_t>(at) + 1];
    add(here, source, column, first_, weight * (1 - fraction));
    add(next, source, column, first_, weight * fraction);
    if constexpr (!kUpright) {
      const Tilt& tilt = source.tilt;
      const double rate = weight * (tilt.down + tilt.right * edges.slope);
      if (rate == 0) return;
      here.rate.add(source.light, rate * (1 - fraction)),
          next.rate.add(source.light, rate * fraction);
    }
  }
  /// A step in row y alone.
  void step(const Source& source, double column, double weight, int y) {
    column = std::clamp(column, static_cast<double>(-margin_), static_cast<double>(width_));
    const auto [begin, fraction] = Split(column);
    Step* at = row_.data() + margin_ + begin;
    add(at[0], source, column, y, weight * (1 - fraction));
    add(at[1], source, column, y, weight * fraction);
  }
  /// `weight` of a blur's brightness at (column, y), and of its tilt.
  static void add(Step& step, const Source& source, double column, int y, double weight) {
    const Tilt& tilt = source.tilt;
    if constexpr (kUpright) {
      step.value.add(source.light, weight);
    } else {
      step.value.add(source.light,
                     weight * (1 + tilt.down * (y - source.y) + tilt.right * (column - source.x)));
      if (tilt.right != 0) step.slope.add(source.light, weight * tilt.right);
    }
  }

  /// The steps of edges where they are in row y.
  void add_edges(const Edges& edges, int y) {
    const double rows = y - first_, drift = edges.slope * rows;
    const auto [whole, next] = Split(drift);
    const double here = 1 - next;
    const Cell* cell = edges.cells.data() + edges.origin - whole;
    Step* row = row_.data() + margin_;
    const int begin = std::max(left_, -margin_), end = std::min(right_ + 2, width_);
    const auto step_of = [rows](const Cell& from) {
      Step step = from;
      step.value.add(from.rate, rows);
      return step;
    };
    Step before = step_of(cell[begin - 1]);
    for (int x = begin; x < end; ++x) {
      Step sum = row[x];
      const Step at = step_of(cell[x]);
      sum.value.add(at.value, here), sum.value.add(before.value, next);
      sum.slope.add(at.slope, here), sum.slope.add(before.slope, next);
      row[x] = sum;
      before = at;
    }
  }
  /// Steps to values. Leaves no steps behind.
  void add_up() {
    Sum value, slope;
    const int end = std::min(right_ + 2, width_);
    Step* row = row_.data() + margin_;
    for (int x = std::max(left_, -margin_); x < end; ++x) {
      if constexpr (kUpright) {
        value.add(edges_[0].cells[static_cast<std::size_t>(edges_[0].origin + x)].value);
      } else {
        value.add(slope), slope.add(row[x].slope);
      }
      value.add(row[x].value);
      row[x] = Step{};
      if (x >= 0) sums_[static_cast<std::size_t>(x)] = value;
    }
    row[width_] = row[width_ + 1] = Step{};
  }

  const SkewedOutline& outline_;
  int width_, height_, first_, last_;
  int margin_ = 0;
  int top_ = 0, bottom_ = -1, left_ = 0, right_ = 0;  // where something happens
  std::vector<Source> sources_;
  std::vector<Event> events_;
  std::vector<std::uint32_t> events_of_;  // of each row the last; they are chained
  std::vector<Edges> edges_;
  std::vector<Step> row_;
  std::vector<Sum> sums_;
};

}  // namespace relumbre
