// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/process/threads.hpp"
#include "trace/importance/steering_tables.hpp"
#include "trace/step/receive.hpp"

namespace straytrace::trace {
namespace {

// Points of a four-dimensional low-discrepancy sequence: the point on the first patch and that on the second.
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

class Quadrature {
 public:
  Quadrature(World const& world, SteeringTables const& tables, std::vector<std::uint32_t> const& goals,
             unsigned samples, unsigned threads)
      : world_(world),
        tables_(tables),
        goals_(goals),
        samples_(samples),
        threads_(threads),
        view_(world.view()),
        steering_(tables.view()),
        all_(tables.sides.size()) {}

  std::vector<Exchange> run() {
    in_parallel(all_.size(), threads_, [&](std::size_t side) { fill_side(side); });
    return std::move(all_);
  }

 private:
  struct Point {
    Vec3 p, normal;
    SurfaceId surface;
    std::uint32_t piece;
  };
  Point point_on(std::size_t patch, double u, double v) const {
    Steering::Place const place = steering_.place(std::uint32_t(patch), u);
    SurfaceId const id = tables_.strips[place.strip].surface;
    return view_.shapes.visit(view_.surfaces[id.value].shape, [&](auto const& shape) {
      SurfacePoint const at = sample_in_strip(shape, place.u, v);
      return Point{at.point, normal_of(shape, at.point, at.piece), id, at.piece};
    });
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
  struct Sums {  // over pairs of points, by sides
    std::vector<double> first, second;
    explicit Sums(std::size_t sides) : first(sides), second(sides) {}
    Arriving arriving(unsigned samples) const {
      Arriving a;
      a.share.reserve(first.size());
      a.peak.reserve(first.size());
      for (std::size_t i = 0; i < first.size(); ++i) {
        a.share.push_back(float(first[i]));
        a.peak.push_back(first[i] > 0 ? float(second[i] / first[i] * samples) : 0);
      }
      return a;
    }
  };
  void fill_side(std::size_t side) {
    Exchange& exchange = all_[side];
    exchange.direct.assign(goals_.size(), 0);
    exchange.albedo = mean_albedo(side);
    if (!(exchange.albedo > 0)) return;
    Sums sums(tables_.sides.size());
    for (std::size_t to = 0; to < tables_.patches.size(); ++to) exchange_with(side, to, sums);
    exchange.diffuse = sums.arriving(samples_);
    for (std::size_t g = 0; g < goals_.size(); ++g)
      exchange.direct[g] = exchange.albedo * direct_score(side, goals_[g], g);
    emit_from(side);
  }

  // Adds the share of diffuse light that leaves one side and arrives on patch `to`.
  void exchange_with(std::size_t side, std::size_t to, Sums& sums) const {
    double const sign = side % 2 == 0 ? 1 : -1;
    for (unsigned i = 0; i < samples_; ++i) {
      Pair const at = pair_of_points(side, to, i);
      Point const x = point_on(side / 2, at.u1, at.v1), y = point_on(to, at.u2, at.v2);
      Vec3 const span = y.p - x.p;
      double const d = length(span), cos_x = sign * dot(span, x.normal) / d;
      if (!(cos_x > 0)) continue;
      add_arrival(sums, x, y, to, d, cos_x / (pi * samples_));
    }
  }
  // `value`: f cos_x over the number of samples.
  void add_arrival(Sums& sums, Point const& x, Point const& y, std::size_t to, double d, double value) const {
    Vec3 const out = (1 / d) * (y.p - x.p);
    double const cosine = dot(out, y.normal);
    if (!(value > 0) || cosine == 0) return;
    double const clear = d - view_.slack(y.surface, d, std::fabs(cosine));
    if (view_.occluded({x.p, out, clear}, {x.surface, x.piece}, x.surface == y.surface)) return;
    double const arriving = value * std::fabs(cosine) * tables_.patches[to].area / (d * d);
    std::size_t const side = 2 * to + (cosine < 0 ? 0 : 1);
    double const share = std::min(arriving, 1.0 / samples_);
    sums.first[side] += share;
    sums.second[side] += share * share;
  }

  // Score per unit of diffuse power leaving `side` by connections to one goal.
  double direct_score(std::size_t side, std::uint32_t goal, std::size_t number) const {
    double const sign = side % 2 == 0 ? 1 : -1;
    double sum = 0;
    for (unsigned i = 0; i < samples_; ++i) {
      Pair const at = pair_of_points(side, ~std::uint64_t(number), i);
      Point const x = point_on(side / 2, at.u1, at.v1);
      Arrival const y = arrival(goal, x.p, at.u2 > 0 ? at.u2 : 0.5, at.v2);
      Vec3 const span = y.point - x.p;
      double const d = length(span), cos_x = sign * dot(span, x.normal) / d;
      if (!(y.worth > 0 && cos_x > 0)) continue;
      bool const clear = view_.surfaces[y.surface.value].clear;
      if (!view_.occluded({x.p, (1 / d) * span, d - view_.slack(y.surface, d, y.cosine)}, {x.surface, x.piece},
                          x.surface == y.surface && !clear))
        sum += cos_x * y.worth / (pi * d * d);
    }
    return sum / samples_;
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
  void emit_from(std::size_t side) {
    Exchange& exchange = all_[side];
    Sums sums(tables_.sides.size());
    for (std::size_t e = 0; e < view_.emitters.size; ++e) {
      Footprint const& lit = view_.lit[view_.emitters[e]];
      if (lit.free || !holds(side / 2, lit.surface)) continue;
      bool const front = dot(view_.normal(lit.surface, lit.centre), lit.travel) < 0;
      if (front != (side % 2 == 0)) continue;
      exchange.emitted += lit.share * exchange.albedo;
      for (std::size_t to = 0; to < tables_.patches.size(); ++to)
        for (unsigned i = 0; i < samples_; ++i) emit_sample(sums, side, lit, to, i);
    }
    if (exchange.emitted > 0) exchange.by_law = sums.arriving(samples_);
  }
  void emit_sample(Sums& sums, std::size_t side, Footprint const& lit, std::size_t to, unsigned i) {
    Pair const at = pair_of_points(side + 1000003, to, i);
    Ray const line = lit.sample(at.u1 > 0 ? at.u1 : 0.5, at.v1);
    Crossing const met = view_.cross(lit.surface.value, line, {});
    if (!(met.distance < infinity)) return;
    Vec3 const p = line.origin + met.distance * line.dir;
    Vertex const from = make_vertex(view_, lit.surface, p, lit.direction(p), met.piece);
    Point const y = point_on(to, at.u2, at.v2);
    Vec3 const span = y.p - from.point;
    double const d = length(span);
    Vec3 const wo = from.frame.to_local((1 / d) * span);
    double const value = scatter_eval(view_.laws, *from.optic, from.wi, wo) * std::fabs(wo.z);
    add_arrival(sums, {from.point, from.normal(), lit.surface, met.piece}, y, to, d, lit.share * value / samples_);
  }

  World const& world_;
  SteeringTables const& tables_;
  std::vector<std::uint32_t> const& goals_;
  unsigned const samples_, threads_;
  WorldView const view_;
  Steering const steering_;
  std::vector<Exchange> all_;  // two per patch
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
  return Quadrature(world, tables, goals, samples, threads).run();
}

}  // namespace straytrace::trace
