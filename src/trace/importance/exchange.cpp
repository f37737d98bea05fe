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

class Quadrature {
 public:
  Quadrature(World const& world, SteeringTables const& tables, unsigned samples)
      : tables_(tables), samples_(samples), view_(world.view()), steering_(tables.view()) {
    for (std::uint32_t patch = 0; patch < tables.patches.size(); ++patch)
      for (unsigned i = 0; i < points_each(); ++i) {
        Pair const at = pair_of_points(patch, 0, i);
        starts_.push_back(point_on(patch, at.u1, at.v1));
        ends_.push_back(point_on(patch, at.u2, at.v2));
      }
  }

  std::vector<Exchange> run(std::vector<std::uint32_t> const& goals, unsigned threads) {
    std::size_t const sides = tables_.sides.size();
    std::vector<Exchange> all(sides);
    in_parallel(sides, threads, [&](std::size_t side) { fill_side(side, goals, all[side]); });
    bool const every_line = sides / 2 <= patches_with_every_line;
    in_parallel(sides / 2, threads, [&](std::size_t from) {
      for (std::size_t to = from; to < sides / 2; ++to) exchange_between(from, to, every_line, all);
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
  static constexpr unsigned lines_for_slivers = 256;
  static constexpr double in_plane = 1e-9;  // cosine: rounding of a line that lies in a surface
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

  bool scatters(std::size_t side) const { return mean_albedo(side) > 0; }
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
  void fill_side(std::size_t side, std::vector<std::uint32_t> const& goals, Exchange& exchange) const {
    exchange.direct.assign(goals.size(), 0);
    exchange.albedo = mean_albedo(side);
    if (!(exchange.albedo > 0)) return;
    exchange.diffuse = Arriving(tables_.sides.size());
    for (std::size_t g = 0; g < goals.size(); ++g)
      exchange.direct[g] = exchange.albedo * direct_score(side, goals[g], g);
    emit_from(side, exchange);
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
  double direct_score(std::size_t side, std::uint32_t goal, std::size_t number) const {
    bool dark = false;
    auto const mean_of = [&](unsigned begin, unsigned end) {  // those before `begin` score nothing
      double sum = 0;
      for (unsigned i = begin; i < end; ++i)
        sum += score_of_line(side, goal, pair_of_points(side, ~std::uint64_t(number), i), dark);
      return sum / end;
    };
    double const first = mean_of(0, samples_);
    return first > 0 || !(dark || curved(side / 2)) ? first : mean_of(samples_, lines_for_slivers);
  }
  // `dark` is set where the line is hidden.
  double score_of_line(std::size_t side, std::uint32_t goal, Pair const& at, bool& dark) const {
    Point const x = point_on(side / 2, at.u1, at.v1);
    Arrival const y = arrival(goal, x.p, at.u2 > 0 ? at.u2 : 0.5, at.v2);
    Vec3 const span = y.point - x.p;
    double const d = length(span), cos_x = (side % 2 == 0 ? 1 : -1) * dot(span, x.normal) / d;
    if (!(y.worth > 0 && cos_x > in_plane && y.cosine > in_plane)) return 0;
    bool const clear = view_.surfaces[y.surface.value].clear;
    if (view_.occluded({x.p, (1 / d) * span, d - view_.slack(y.surface, d, y.cosine)}, {x.surface, x.piece},
                       x.surface == y.surface && !clear)) {
      dark = true;
      return 0;
    }
    return cos_x * y.worth / (pi * d * d);
  }
  // A point drawn on a goal, and the score there of light from p, per unit of intensity over d^2.
  struct Arrival {
    Vec3 point;
    SurfaceId surface;
    double cosine = 0, worth = 0;
  };
  Arrival arrival(std::uint32_t goal, Vec3 p, double u, double v) const {
    if (goal >= view_.lit.size) {
      Receiver const& r = view_.receivers[goal - view_.lit.size];
      SurfacePoint const at = view_.shapes.visit(view_.surfaces[r.surface.value].shape,
                                                 [&](auto const& shape) { return sample_of(shape, u, v); });
      Vertex const y = make_vertex(view_, r.surface, at.point, unit(at.point - p), at.piece);
      return {y.point, r.surface, y.cosine(),
              r.counts(y.front) && y.wi.z > 0 ? y.cosine() / receiver_density(view_, r) : 0};
    }
    Footprint const& lit = view_.lit[goal];
    Ray const line = lit.sample(u, v);
    Crossing const met = view_.cross(lit.surface.value, line, {});
    if (!(met.distance < infinity)) return {};
    Vec3 const point = line.origin + met.distance * line.dir;
    Vertex const y = make_vertex(view_, lit.surface, point, unit(point - p), met.piece);
    if (!(y.wi.z > 0) || dot(y.normal(), lit.travel) >= 0) return {};
    double const mode = rejoin_bsdf(view_, y, lit) * accepted(view_, lit);
    return {y.point, lit.surface, y.cosine(), y.cosine() * mode};
  }

  bool holds(std::size_t patch, SurfaceId surface) const {
    Patch const& p = tables_.patches[patch];
    for (std::uint32_t m = p.first; m < p.first + p.count; ++m)
      if (tables_.strips[tables_.members[m].strip].surface == surface) return true;
    return false;
  }
  // True law of the beams that start on this side.
  void emit_from(std::size_t side, Exchange& exchange) const {
    std::vector<LineSum> sums(tables_.sides.size());
    for (std::size_t e = 0; e < view_.emitters.size; ++e) {
      Footprint const& lit = view_.lit[view_.emitters[e]];
      if (lit.free || !holds(side / 2, lit.surface)) continue;
      bool const front = dot(view_.normal(lit.surface, lit.centre), lit.travel) < 0;
      if (front != (side % 2 == 0)) continue;
      exchange.emitted += lit.share * exchange.albedo;
      for (std::size_t to = 0; to < tables_.patches.size(); ++to) emit_towards(sums, side, lit, to);
    }
    if (!(exchange.emitted > 0)) return;
    exchange.by_law = Arriving(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) exchange.by_law.set(i, sums[i], false);
  }
  // More lines look for the sliver that may be seen of each side of `to` which the first lines do not reach.
  void emit_towards(std::vector<LineSum>& sums, std::size_t side, Footprint const& lit, std::size_t to) const {
    std::array<LineSum, 2> facing;  // by side of `to`
    std::array<bool, 2> dark{curved(to), curved(to)};
    auto const add_lines = [&](unsigned begin, unsigned end, std::array<bool, 2> wanted) {
      for (unsigned i = begin; i < end && (wanted[0] || wanted[1]); ++i) {
        auto const line = emit_line(side, lit, to, i, wanted);
        if (line && line->hidden) dark[line->on] = true;
        if (line && !line->hidden) facing[line->on].add(std::min(line->share, 1.0) / end, end);
      }
    };
    add_lines(0, samples_, {true, true});
    auto const unseen = [&](unsigned k) { return dark[k] && !(facing[k].first > 0) && scatters(2 * to + k); };
    add_lines(samples_, lines_for_slivers, {unseen(0), unseen(1)});
    for (unsigned k = 0; k < 2; ++k) {
      sums[2 * to + k].first += facing[k].first;
      sums[2 * to + k].second += facing[k].second;
    }
  }
  // A line from a beam to a side of a patch, and the share of the power that would arrive if all lines were like it.
  struct Emitted {
    unsigned on = 0;
    bool hidden = false;
    double share = 0;
  };
  // Line i; nothing where no light leaves along it, or where it meets a side that is not wanted.
  std::optional<Emitted> emit_line(std::size_t side, Footprint const& lit, std::size_t to, unsigned i,
                                   std::array<bool, 2> wanted) const {
    Pair const at = pair_of_points(side + 1000003, to, i);
    Ray const ray = lit.sample(at.u1 > 0 ? at.u1 : 0.5, at.v1);
    Crossing const met = view_.cross(lit.surface.value, ray, {});
    if (!(met.distance < infinity)) return {};
    Vec3 const p = ray.origin + met.distance * ray.dir;
    Vertex const from = make_vertex(view_, lit.surface, p, lit.direction(p), met.piece);
    Point const x{from.point, from.normal(), lit.surface, met.piece, false}, y = point_on(to, at.u2, at.v2);
    Line const line = line_between(x, y);
    Vec3 const span = y.p - x.p;
    double const across = in_plane * length(span);
    if (!wanted[line.side_y] || !(std::fabs(dot(span, x.normal)) > across && std::fabs(dot(span, y.normal)) > across))
      return {};
    double const bsdf = scatter_eval(view_.laws, *from.optic, from.wi, from.frame.to_local(unit(span)));
    if (!(bsdf > 0)) return {};
    if (hidden(line)) return Emitted{line.side_y, true, 0};
    return Emitted{line.side_y, false, lit.share * bsdf * pi * line.kernel * tables_.patches[to].area};
  }

  SteeringTables const& tables_;
  unsigned const samples_;
  WorldView const view_;
  Steering const steering_;
  std::vector<Point> starts_, ends_;  // of lines
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
