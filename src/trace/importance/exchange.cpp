// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/process/threads.hpp"
#include "trace/importance/steering_tables.hpp"
#include "trace/step/receive.hpp"

namespace straytrace::trace {
namespace {

// Points of a four-dimensional low-discrepancy sequence: where a line starts and where it ends.
struct Pair {
  double u1, v1, u2, v2;
};
Pair pair_of_points(std::uint64_t row, std::uint64_t column, unsigned i) {
  std::uint64_t const mix = mixed(row * 0x9e3779b97f4a7c15ull + column + 1);
  auto const coordinate = [&](double step, int part) {
    double const shift = double((mix >> (16 * part)) & 0xffff) / 65536.0;
    double const sum = shift + step * (i + 1);
    return sum - std::floor(sum);
  };
  return {coordinate(0.8566748838545029, 0), coordinate(0.733891856627126, 1), coordinate(0.6287067210378087, 2),
          coordinate(0.5385972572236101, 3)};
}

struct Point {
  Vec3 p, normal;
  SurfaceId surface;
  std::uint32_t piece = 0;
  bool round = false;  // on a sphere, which hides one of its sides
};

// A line between two patches.
struct Line {
  Point const *x = nullptr, *y = nullptr;
  double kernel = 0;                // cosines over pi d^2, 1/m^2
  unsigned side_x = 0, side_y = 0;  // that face each other
  bool hides_itself() const { return (x->round && side_x == 1) || (y->round && side_y == 1); }
};
Line line_between(Point const& x, Point const& y) {
  Vec3 const span = y.p - x.p;
  double const d2 = length2(span), from = dot(span, x.normal), to = -dot(span, y.normal);
  double const kernel = d2 > 0 ? std::fabs(from * to) / (pi * d2 * d2) : 0;
  return {&x, &y, kernel, from > 0 ? 0u : 1u, to > 0 ? 0u : 1u};
}

constexpr unsigned lines_for_slivers = 256;

// A point of a goal where lines from patches end.
struct GoalPoint {
  Vec3 p, normal;
  std::uint32_t piece = 0;
  bool met = false;  // otherwise the line of the mode misses its surface
};

// A beam that starts on a lit surface: vertices where its light leaves (without a surface: none), the sides of patches
// that hold the surface, and the shares of its power that arrive.
struct Beam {
  Footprint const* lit;
  std::vector<std::size_t> sides;
  std::vector<Vertex> starts;
  std::vector<LineSum> arriving;  // by sides of patches
};

class Quadrature {
 public:
  Quadrature(World const& world, SteeringTables const& tables, unsigned samples)
      : tables_(tables), samples_(samples), view_(world.view()), steering_(tables.view()) {
    for (std::uint32_t patch = 0; patch < tables.patches.size(); ++patch)
      for (unsigned i = 0; i < points_each(); ++i) {
        starts_.push_back(start_on(patch, i));
        Pair const at = pair_of_points(patch, 0, i);
        ends_.push_back(point_on(patch, at.u2, at.v2));
      }
  }

  std::vector<Exchange> run(std::vector<std::uint32_t> const& goals, unsigned threads) {
    std::size_t const sides = tables_.sides.size(), patches = sides / 2;
    std::vector<Exchange> all(sides);
    for (std::size_t side = 0; side < sides; ++side) {
      all[side].direct.assign(goals.size(), 0);
      all[side].albedo = mean_albedo(side);
      if (all[side].albedo > 0) all[side].diffuse = Arriving(sides);
    }
    draw_goals(goals);
    draw_beams();
    in_parallel(patches, threads, [&](std::size_t patch) { fill_patch(patch, goals, all); });
    emit(all);
    bool const every_line = patches <= patches_with_every_line;
    in_parallel(patches, threads, [&](std::size_t from) {
      for (std::size_t to = from; to < patches; ++to) exchange_between(from, to, every_line, all);
    });
    return all;
  }
  void resolve(std::vector<std::vector<std::uint32_t>> const& pairs, unsigned threads, std::vector<Exchange>& all) {
    in_parallel(pairs.size(), threads, [&](std::size_t from) {
      for (std::uint32_t const to : pairs[from]) exchange_between(from, to, true, all);
    });
  }

 private:
  static constexpr unsigned spare_points = 16;  // per patch: where the points of a pair begin
  static constexpr double in_plane = 1e-9;      // cosine: rounding of a line that lies in a surface
  unsigned points_each() const { return samples_ + spare_points; }
  Point point_on(std::size_t patch, double u, double v) const {
    Steering::Place const place = steering_.place(std::uint32_t(patch), u);
    SurfaceId const id = tables_.strips[place.strip].surface;
    return view_.shapes.visit(view_.surfaces[id.value].shape, [&](auto const& shape) {
      SurfacePoint const at = sample_in_strip(shape, place.u, v);
      return Point{at.point, normal_of(shape, at.point, at.piece), id, at.piece,
                   std::is_same_v<std::remove_cvref_t<decltype(shape)>, Sphere>};
    });
  }
  Point start_on(std::size_t patch, unsigned i) const {
    Pair const at = pair_of_points(patch, 0, i);
    return point_on(patch, at.u1, at.v1);
  }
  // The same points of one patch, as many as are needed.
  class PointsOf {
   public:
    PointsOf(Quadrature const& all, std::size_t patch) : all_(all), patch_(patch) {}
    Point const& operator[](unsigned i) {
      unsigned const known = all_.points_each();
      if (i < known) return all_.starts_[known * patch_ + i];
      while (more_.size() <= i - known) more_.push_back(all_.start_on(patch_, known + unsigned(more_.size())));
      return more_[i - known];
    }

   private:
    Quadrature const& all_;
    std::size_t const patch_;
    std::vector<Point> more_;
  };
  // Where the points of a goal or beam begin for one side of a patch, so that sides do not share their lines.
  static unsigned first_of(std::size_t side, std::size_t number) {
    return unsigned(mixed(side * 0x9e3779b97f4a7c15ull + number + 1) % lines_for_slivers);
  }

  double mean_albedo(std::size_t side) const {
    Patch const& patch = tables_.patches[side / 2];
    double sum = 0;
    for (std::uint32_t m = patch.first; m < patch.first + patch.count; ++m) {
      Strip const& strip = tables_.strips[tables_.members[m].strip];
      Surface const& surface = view_.surfaces[strip.surface.value];
      double const albedo = scatter_albedo(view_.laws, view_.optics[side % 2 == 0 ? surface.front : surface.back], 0.6);
      if (patch.count == 1) return albedo;
      sum += albedo * strip.area;
    }
    return sum / patch.area;
  }
  void fill_patch(std::size_t patch, std::vector<std::uint32_t> const& goals, std::vector<Exchange>& all) {
    PointsOf points(*this, patch);
    std::array<bool, 2> const scatters{all[2 * patch].albedo > 0, all[2 * patch + 1].albedo > 0};
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t g = 0; g < goals.size() && scatters[k]; ++g)
        all[2 * patch + k].direct[g] = all[2 * patch + k].albedo * direct_score(2 * patch + k, goals[g], g, points);
    for (Beam& beam : beams_) emit_towards(beam, patch, scatters, points);
  }

  bool hidden(Line const& line) const {
    Vec3 const span = line.y->p - line.x->p;
    double const d = length(span);
    Vec3 const out = (1 / d) * span;
    double const clear = d - view_.slack(line.y->surface, d, std::fabs(dot(out, line.y->normal)));
    Ray const ray{line.x->p, out, clear};
    Departure const from{line.x->surface, line.x->piece};
    bool const to_itself = line.x->surface == line.y->surface;
    if (!to_itself && line.hides_itself() &&
        (view_.cross(line.y->surface.value, ray, from).distance < infinity ||
         view_.cross(line.x->surface.value, ray, from).distance < infinity))
      return true;
    return view_.occluded(ray, from, to_itself);
  }

  // The lines between two patches, in both directions: the exchange is reciprocal. With `every_line` each is traced,
  // otherwise the strongest from side to side decides for all of these.
  void exchange_between(std::size_t from, std::size_t to, bool every_line, std::vector<Exchange>& all) const {
    struct Facing {
      LineSum there, back;
      Line strongest;
    };
    std::array<Facing, 4> facing{};  // by side of `from` and of `to`
    unsigned const lines = every_line ? samples_ : (samples_ + 1) / 2;
    double const most = 1.0 / lines, area_from = tables_.patches[from].area / lines,
                 area_to = tables_.patches[to].area / lines;
    std::uint64_t const mix = mixed(from * 0x9e3779b97f4a7c15ull + to + 1);
    Point const* const x = &starts_[points_each() * from + mix % spare_points];
    Point const* const y = &ends_[points_each() * to + (mix >> 32) % spare_points];
    for (unsigned i = 0; i < lines; ++i) {
      Line const line = line_between(x[i], y[i]);
      bool const scatters = all[2 * from + line.side_x].albedo > 0 || all[2 * to + line.side_y].albedo > 0;
      if (!(line.kernel > 0) || !scatters || (every_line && hidden(line))) continue;
      Facing& sides = facing[2 * line.side_x + line.side_y];
      sides.there.add(std::min(line.kernel * area_to, most), lines);
      sides.back.add(std::min(line.kernel * area_from, most), lines);
      if (line.kernel > sides.strongest.kernel) sides.strongest = line;
    }
    for (unsigned k = 0; k < 4; ++k) {
      if (!every_line && !(facing[k].there.first > 0)) continue;
      bool const dark = !every_line && hidden(facing[k].strongest);
      std::size_t const a = 2 * from + k / 2, b = 2 * to + k % 2;
      all[a].diffuse.set(b, facing[k].there, dark);
      if (to != from) all[b].diffuse.set(a, facing[k].back, dark);
    }
  }

  // Whether some of a patch may face what its first points do not.
  bool curved(std::size_t patch) const {
    Point const* const first = &starts_[points_each() * patch];
    return std::any_of(first, first + samples_,
                       [&](Point const& p) { return dot(p.normal, first->normal) < 1 - in_plane; });
  }
  // Score per unit of diffuse power leaving `side` by connections to one goal. Where no first line arrives, more of
  // them look for the sliver that may be seen.
  double direct_score(std::size_t side, std::uint32_t goal, std::size_t number, PointsOf& points) const {
    bool dark = false;
    unsigned const first = first_of(side, number);
    std::vector<GoalPoint> const& ends = goal_points_[number];
    auto const mean_of = [&](unsigned begin, unsigned end) {  // those before `begin` score nothing
      double sum = 0;
      for (unsigned i = begin; i < end; ++i)
        sum += score_of_line(side, goal, points[i], ends[(first + i) % lines_for_slivers], dark);
      return sum / end;
    };
    double const mean = mean_of(0, samples_);
    return mean > 0 || !(dark || curved(side / 2)) ? mean : mean_of(samples_, lines_for_slivers);
  }
  // `dark` is set where the line is hidden.
  double score_of_line(std::size_t side, std::uint32_t goal, Point const& x, GoalPoint const& y, bool& dark) const {
    Vec3 const span = y.p - x.p;
    double const from = (side % 2 == 0 ? 1 : -1) * dot(span, x.normal), to = -dot(span, y.normal);
    if (!(from > 0) || !y.met || !accepts(goal, y, to > 0)) return 0;
    double const d = length(span), cos_x = from / d, cos_y = std::fabs(to) / d;
    if (!(cos_x > in_plane && cos_y > in_plane)) return 0;
    SurfaceId const surface = surface_of(view_, goal);
    Vec3 const out = (1 / d) * span;
    if (view_.occluded({x.p, out, d - view_.slack(surface, d, cos_y)}, {x.surface, x.piece},
                       x.surface == surface && !view_.surfaces[surface.value].clear)) {
      dark = true;
      return 0;
    }
    return cos_x * worth_of(goal, y, out) / (pi * d * d);
  }
  // Whether the goal takes light on this side of it.
  bool accepts(std::uint32_t goal, GoalPoint const& y, bool front) const {
    if (is_receiver(view_, goal)) return receiver_of(view_, goal).counts(front);
    return (front ? 1 : -1) * dot(y.normal, view_.lit[goal].travel) < 0;
  }
  // Score of light that arrives at y along `out`, per unit of intensity over d^2.
  double worth_of(std::uint32_t goal, GoalPoint const& y, Vec3 out) const {
    Vertex const at = make_vertex(view_, surface_of(view_, goal), y.p, out, y.piece);
    if (!(at.wi.z > 0)) return 0;
    if (is_receiver(view_, goal)) return at.cosine() / receiver_density(view_, receiver_of(view_, goal));
    return at.cosine() * rejoin_bsdf(view_, at, view_.lit[goal]) * accepted(view_, view_.lit[goal]);
  }

  void draw_goals(std::vector<std::uint32_t> const& goals) {
    for (std::size_t number = 0; number < goals.size(); ++number) {
      std::vector<GoalPoint>& points = goal_points_.emplace_back();
      for (unsigned i = 0; i < lines_for_slivers; ++i) {
        Pair const at = pair_of_points(~std::uint64_t(number), 0, i);
        points.push_back(point_of_goal(goals[number], at.u2 > 0 ? at.u2 : 0.5, at.v2));
      }
    }
  }
  GoalPoint point_of_goal(std::uint32_t goal, double u, double v) const {
    SurfaceId const surface = surface_of(view_, goal);
    SurfacePoint at;
    if (is_receiver(view_, goal)) {
      at = view_.shapes.visit(view_.surfaces[surface.value].shape,
                              [&](auto const& shape) { return sample_of(shape, u, v); });
    } else {
      Ray const line = view_.lit[goal].sample(u, v);
      Crossing const met = view_.cross(surface.value, line, {});
      if (!(met.distance < infinity)) return {};
      at = {line.origin + met.distance * line.dir, met.piece};
    }
    return {at.point, view_.normal(surface, at.point, at.piece), at.piece, true};
  }

  void draw_beams() {
    for (std::size_t e = 0; e < view_.emitters.size; ++e) {
      Footprint const& lit = view_.lit[view_.emitters[e]];
      if (lit.free) continue;
      bool const front = dot(view_.normal(lit.surface, lit.centre), lit.travel) < 0;
      Beam beam{&lit, {}, {}, std::vector<LineSum>(tables_.sides.size())};
      for (std::size_t patch = 0; patch < tables_.patches.size(); ++patch)
        if (holds(patch, lit.surface)) beam.sides.push_back(2 * patch + (front ? 0 : 1));
      for (unsigned i = 0; i < lines_for_slivers; ++i) beam.starts.push_back(start_of(lit, e, i));
      beams_.push_back(std::move(beam));
    }
  }
  Vertex start_of(Footprint const& lit, std::size_t number, unsigned i) const {
    Pair const at = pair_of_points(~std::uint64_t(number), 1, i);
    Ray const ray = lit.sample(at.u2 > 0 ? at.u2 : 0.5, at.v2);
    Crossing const met = view_.cross(lit.surface.value, ray, {});
    if (!(met.distance < infinity)) return {};
    Vec3 const p = ray.origin + met.distance * ray.dir;
    return make_vertex(view_, lit.surface, p, lit.direction(p), met.piece);
  }
  bool holds(std::size_t patch, SurfaceId surface) const {
    Patch const& p = tables_.patches[patch];
    for (std::uint32_t m = p.first; m < p.first + p.count; ++m)
      if (tables_.strips[tables_.members[m].strip].surface == surface) return true;
    return false;
  }
  // True law of the beams that start on each side.
  void emit(std::vector<Exchange>& all) const {
    for (std::size_t side = 0; side < all.size(); ++side) {
      if (!(all[side].albedo > 0)) continue;
      std::vector<LineSum> sums;
      for (Beam const& beam : beams_) {
        if (std::ranges::find(beam.sides, side) == beam.sides.end()) continue;
        sums.resize(all.size());
        all[side].emitted += beam.lit->share * all[side].albedo;
        for (std::size_t i = 0; i < sums.size(); ++i) {
          sums[i].first += beam.arriving[i].first;
          sums[i].second += beam.arriving[i].second;
        }
      }
      if (!(all[side].emitted > 0)) continue;
      all[side].by_law = Arriving(sums.size());
      for (std::size_t i = 0; i < sums.size(); ++i) all[side].by_law.set(i, sums[i], false);
    }
  }
  // More lines look for the sliver that may be seen of each side of `to` which the first lines do not reach.
  void emit_towards(Beam& beam, std::size_t to, std::array<bool, 2> scatters, PointsOf& points) const {
    LineSum* const facing = &beam.arriving[2 * to];  // by side of `to`
    std::array<bool, 2> dark{curved(to), curved(to)};
    unsigned const first = first_of(2 * to, std::size_t(&beam - beams_.data()));
    auto const add_lines = [&](unsigned begin, unsigned end, std::array<bool, 2> wanted) {
      for (unsigned i = begin; i < end && (wanted[0] || wanted[1]); ++i) {
        auto const line = emit_line(beam.starts[(first + i) % lines_for_slivers], *beam.lit, to, points[i], wanted);
        if (line && line->hidden) dark[line->on] = true;
        if (line && !line->hidden) facing[line->on].add(std::min(line->share, 1.0) / end, end);
      }
    };
    add_lines(0, samples_, {true, true});
    auto const unseen = [&](unsigned k) { return dark[k] && !(facing[k].first > 0) && scatters[k]; };
    add_lines(samples_, lines_for_slivers, {unseen(0), unseen(1)});
  }
  // A line from a beam to a side of a patch, and the share of the power that would arrive if all lines were like it.
  struct Emitted {
    unsigned on = 0;
    bool hidden = false;
    double share = 0;
  };
  // Nothing where no light leaves along the line, or where it meets a side that is not wanted.
  std::optional<Emitted> emit_line(Vertex const& from, Footprint const& lit, std::size_t to, Point const& y,
                                   std::array<bool, 2> wanted) const {
    if (!from.surface.valid()) return {};
    Point const x{from.point, from.normal(), from.surface, from.piece, false};
    Line const line = line_between(x, y);
    Vec3 const span = y.p - x.p;
    double const across = in_plane * length(span), up = dot(span, x.normal);
    if (!wanted[line.side_y] || !(std::fabs(up) > across && std::fabs(dot(span, y.normal)) > across)) return {};
    if (up < 0 && !scatters_through(*from.optic)) return {};
    if (hidden(line)) return Emitted{line.side_y, true, 0};
    double const bsdf = scatter_eval(view_.laws, *from.optic, from.wi, from.frame.to_local(unit(span)));
    if (!(bsdf > 0)) return {};
    return Emitted{line.side_y, false, lit.share * bsdf * pi * line.kernel * tables_.patches[to].area};
  }

  SteeringTables const& tables_;
  unsigned const samples_;
  WorldView const view_;
  Steering const steering_;
  std::vector<Point> starts_, ends_;                 // of lines
  std::vector<std::vector<GoalPoint>> goal_points_;  // by place in the list of goals
  std::vector<Beam> beams_;
};

}  // namespace

std::vector<std::uint32_t> goals_of(WorldView const& view) {
  std::vector<std::uint32_t> goals;
  for (std::uint32_t i = 0; i < view.lit.size; ++i)
    if (view.lit[i].receives && view.lit[i].port.valid()) goals.push_back(i);
  for (std::uint32_t i = 0; i < view.receivers.size; ++i) goals.push_back(goal_of_receiver(view, i));
  return goals;
}

std::vector<Exchange> exchanges(World const& world, SteeringTables const& tables,
                                std::vector<std::uint32_t> const& goals, unsigned samples, unsigned threads) {
  return Quadrature(world, tables, samples).run(goals, threads);
}

void trace_every_line(World const& world, SteeringTables const& tables,
                      std::vector<std::vector<std::uint32_t>> const& pairs, unsigned samples, unsigned threads,
                      std::vector<Exchange>& all) {
  Quadrature(world, tables, samples).resolve(pairs, threads, all);
}

}  // namespace straytrace::trace
