// SPDX-License-Identifier: BSD-3-Clause
#include "trace/estimate/importance.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "trace/estimate/pilot.hpp"
#include "trace/estimate/receive.hpp"
#include "trace/estimate/targets.hpp"

namespace straytrace {
namespace {

// Points of a four-dimensional low-discrepancy sequence: where on the first strip, where on the second.
struct Pair {
  double u1, v1, u2, v2;
};
Pair pair_of_points(std::uint64_t row, std::uint64_t column, unsigned i) {
  std::uint64_t const mix = mixed(row * 0x9e3779b97f4a7c15ull + column + 1);
  auto const coordinate = [&](double step, int part) {
    double const shift = double((mix >> (16 * part)) & 0xffff) / 65536.0;
    return std::fmod(shift + step * (i + 1), 1.0);
  };
  return {coordinate(0.8566748838545029, 0), coordinate(0.733891856627126, 1), coordinate(0.6287067210378087, 2),
          coordinate(0.5385972572236101, 3)};
}

struct Exchange {                       // of one side of one strip
  std::vector<double> diffuse, by_law;  // arriving on each side of each strip: diffuse, F; and by the true law, T
  std::vector<double> direct;           // score per unit of power arriving here, per receiving goal
  double albedo = 0, emitted = 0;
};

class Builder {
 public:
  Builder(World const& world, ImportanceSettings const& settings)
      : world_(world), settings_(settings), tables_(make_strips(world)), view_(world.view()) {}

  SteeringTables build() {
    if (tables_.strips.size() > settings_.most_strips) return {};
    find_goals();
    fill_exchange();
    for (std::size_t g = 0; g < goals_.size(); ++g) adjoints_.push_back(solved(g));
    choose_targets();
    if (settings_.pilot_histories > 0 && !tables_.strips.empty()) {
      learn();
      choose_targets();
    }
    return std::move(tables_);
  }

 private:
  void find_goals() {
    for (std::uint32_t i = 0; i < view_.lit.size; ++i)
      if (view_.lit[i].receives && view_.lit[i].port.valid()) goals_.push_back(i);
    for (std::uint32_t i = 0; i < view_.receivers.size; ++i) goals_.push_back(goal_of_receiver(view_, i));
  }

  void fill_exchange() {
    sides_.resize(tables_.sides.size());
    std::atomic<std::size_t> next{0};
    auto const work = [&] {
      for (std::size_t i = next++; i < sides_.size(); i = next++) fill_side(i);
    };
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) workers.emplace_back(work);
  }

  struct Point {
    Vec3 p, normal;
    std::uint32_t piece;
  };
  Point point_on(std::size_t strip, double u, double v) const {
    Strip const& s = tables_.strips[strip];
    return view_.shapes.visit(world_.surfaces()[s.surface.value].shape, [&](auto const& shape) {
      SurfacePoint const at = sample_of(shape, s.u_low + u * (s.u_high - s.u_low), v);
      return Point{at.point, normal_of(shape, at.point, at.piece), at.piece};
    });
  }

  void fill_side(std::size_t side) {
    std::size_t const strip = side / 2;
    Strip const& s = tables_.strips[strip];
    Surface const& surface = world_.surfaces()[s.surface.value];
    Optic const& optic = view_.optics[side % 2 == 0 ? surface.front : surface.back];
    Exchange& exchange = sides_[side];
    exchange.direct.assign(goals_.size(), 0);
    exchange.albedo = scatter_albedo(view_.laws, optic, 0.6);
    if (!(exchange.albedo > 0)) return;
    exchange.diffuse.assign(tables_.sides.size(), 0);
    for (std::size_t to = 0; to < tables_.strips.size(); ++to) exchange_with(side, to);
    for (std::size_t g = 0; g < goals_.size(); ++g) exchange.direct[g] = exchange.albedo * direct_score(side, g);
    emit_from(side);
  }

  // Adds the share of diffuse light that leaves one side and arrives on strip `to`.
  void exchange_with(std::size_t side, std::size_t to) {
    double const sign = side % 2 == 0 ? 1 : -1;
    for (unsigned i = 0; i < settings_.samples; ++i) {
      Pair const at = pair_of_points(side, to, i);
      Point const x = point_on(side / 2, at.u1, at.v1), y = point_on(to, at.u2, at.v2);
      Vec3 const span = y.p - x.p;
      double const d = length(span), cos_x = sign * dot(span, x.normal) / d;
      if (!(cos_x > 0)) continue;
      add_arrival(sides_[side].diffuse, side / 2, x, y, to, d, cos_x / (pi * settings_.samples));
    }
  }
  // `value`: f cos_x over the number of samples.
  void add_arrival(std::vector<double>& shares, std::size_t from, Point const& x, Point const& y, std::size_t to,
                   double d, double value) const {
    Vec3 const out = (1 / d) * (y.p - x.p);
    double const cosine = dot(out, y.normal);
    if (!(value > 0) || cosine == 0) return;
    SurfaceId const here = tables_.strips[from].surface;
    if (view_.occluded({x.p, out, d * (1 - 1e-9)}, {here, x.piece}, here == tables_.strips[to].surface)) return;
    double const arriving = value * std::fabs(cosine) * tables_.strips[to].area / (d * d);
    shares[2 * to + (cosine < 0 ? 0 : 1)] += std::min(arriving, 1.0 / settings_.samples);
  }

  // Score per unit of diffuse power leaving `side` by connections to one goal.
  double direct_score(std::size_t side, std::size_t goal) const {
    double const sign = side % 2 == 0 ? 1 : -1;
    SurfaceId const here = tables_.strips[side / 2].surface;
    double sum = 0;
    for (unsigned i = 0; i < settings_.samples; ++i) {
      Pair const at = pair_of_points(side, ~std::uint64_t(goal), i);
      Point const x = point_on(side / 2, at.u1, at.v1);
      Arrival const y = arrival(goals_[goal], x.p, at.u2 > 0 ? at.u2 : 0.5, at.v2);
      Vec3 const span = y.point - x.p;
      double const d = length(span), cos_x = sign * dot(span, x.normal) / d;
      if (!(y.worth > 0 && cos_x > 0)) continue;
      bool const clear = view_.surfaces[y.surface.value].clear;
      if (!view_.occluded({x.p, (1 / d) * span, d * (1 - 1e-9)}, {here, x.piece}, here == y.surface && !clear))
        sum += cos_x * y.worth / (pi * d * d);
    }
    return sum / settings_.samples;
  }
  // A point drawn on a goal, and what light from p, per unit of intensity over d^2, scores there.
  struct Arrival {
    Vec3 point;
    SurfaceId surface;
    double worth = 0;
  };
  Arrival arrival(std::uint32_t goal, Vec3 p, double u, double v) const {
    if (goal >= view_.lit.size) {
      Receiver const& r = view_.receivers[goal - view_.lit.size];
      SurfacePoint const at = view_.shapes.visit(view_.surfaces[r.surface.value].shape,
                                                 [&](auto const& shape) { return sample_of(shape, u, v); });
      Vertex const y = make_vertex(view_, r.surface, at.point, unit(at.point - p), at.piece);
      return {y.point, r.surface, r.counts(y.front) && y.wi.z > 0 ? y.wi.z / receiver_density(view_, r) : 0};
    }
    Footprint const& lit = view_.lit[goal];
    Ray const line = lit.sample(u, v);
    Crossing const met = view_.cross(lit.surface.value, line, {});
    if (!(met.distance < infinity)) return {};
    Vec3 const point = line.origin + met.distance * line.dir;
    Vertex const y = make_vertex(view_, lit.surface, point, unit(point - p), met.piece);
    if (!(y.wi.z > 0) || dot(y.frame.e3, lit.travel) >= 0) return {};
    double const mode = rejoin_bsdf(view_, y, lit) * world_.wavelength * world_.wavelength * lit.share;
    return {y.point, lit.surface, y.wi.z * mode};
  }

  // True law of the beams that start on this side.
  void emit_from(std::size_t side) {
    Exchange& exchange = sides_[side];
    SurfaceId const here = tables_.strips[side / 2].surface;
    for (std::size_t e = 0; e < view_.emitters.size; ++e) {
      Footprint const& lit = view_.lit[view_.emitters[e]];
      if (lit.surface != here) continue;
      bool const front = dot(view_.normal(here, lit.centre), lit.travel) < 0;
      if (front != (side % 2 == 0)) continue;
      if (exchange.by_law.empty()) exchange.by_law.assign(tables_.sides.size(), 0);
      exchange.emitted += lit.share;
      for (std::size_t to = 0; to < tables_.strips.size(); ++to)
        for (unsigned i = 0; i < settings_.samples; ++i) emit_sample(exchange, side, lit, to, i);
    }
  }
  void emit_sample(Exchange& exchange, std::size_t side, Footprint const& lit, std::size_t to, unsigned i) {
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
    add_arrival(exchange.by_law, side / 2, {from.point, from.frame.e3, met.piece}, y, to, d,
                lit.share * value / settings_.samples);
  }

  // In units of what each goal receives in all; goals that no light reaches are left out.
  std::vector<std::vector<double>> in_own_units() const {
    std::vector<std::vector<double>> all;
    bool const lit = std::any_of(sides_.begin(), sides_.end(), [](Exchange const& e) { return !e.by_law.empty(); });
    for (std::vector<double> adjoint : adjoints_) {
      double total = 0;
      for (std::size_t i = 0; i < sides_.size(); ++i)
        if (!sides_[i].by_law.empty()) total += forward_score(i, adjoint);
      if (!lit) total = *std::max_element(adjoint.begin(), adjoint.end());  // free beams alone: any unit will do
      if (!(total > 0)) continue;
      for (double& a : adjoint) a /= total;
      all.push_back(std::move(adjoint));
    }
    return all;
  }
  // Where the pilot has seen enough paths it may raise an adjoint: the exchange knows no mirrors and no glass.
  void learn() {
    constexpr std::uint64_t enough = 64;
    World steered = world_;
    steered.steer(tables_);
    Pilot const pilot = run_pilot(steered, settings_.pilot_histories);
    for (std::size_t g = 0; g < goals_.size(); ++g)
      for (std::size_t i = 0; i < sides_.size(); ++i)
        if (pilot.visits[i] >= enough && pilot.arrived[i] > 0)
          adjoints_[g][i] = std::max(adjoints_[g][i], pilot.scored[goals_[g]][i] / pilot.arrived[i]);
  }
  std::vector<double> solved(std::size_t goal) const {
    std::vector<double> adjoint(sides_.size()), next(sides_.size());
    for (int sweep = 0; sweep < 40; ++sweep) {
      double change = 0, largest = 0;
      for (std::size_t i = 0; i < sides_.size(); ++i) {
        double coming = 0;
        for (std::size_t j = 0; j < sides_[i].diffuse.size(); ++j) coming += sides_[i].diffuse[j] * adjoint[j];
        next[i] = sides_[i].direct[goal] + std::min(sides_[i].albedo, 0.95) * coming;
        change = std::max(change, std::fabs(next[i] - adjoint[i]));
        largest = std::max(largest, next[i]);
      }
      std::swap(adjoint, next);
      if (change <= 1e-3 * largest) break;
    }
    return adjoint;
  }
  double forward_score(std::size_t side, std::vector<double> const& adjoint) const {
    double sum = 0;
    for (std::size_t j = 0; j < adjoint.size(); ++j) sum += sides_[side].by_law[j] * adjoint[j];
    return sum;
  }

  void choose_targets() {
    std::vector<std::vector<double>> const adjoint = in_own_units();
    double level = 0;
    tables_.targets.clear();
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      StripSide& side = tables_.sides[i] = {};
      for (auto const& of_goal : adjoint) side.adjoint += of_goal[i];
      Exchange const& exchange = sides_[i];
      for (auto const& of_goal : adjoint)
        if (!exchange.by_law.empty()) level += forward_score(i, of_goal);
      bool const emits = !exchange.by_law.empty();  // few sides do: they get whole lists
      std::vector<Target> const list = targets_of(world_, tables_, emits ? exchange.by_law : exchange.diffuse, adjoint,
                                                  emits ? tables_.strips.size() : settings_.most_targets);
      side.first = std::uint32_t(tables_.targets.size());
      side.count = std::uint32_t(list.size());
      if (side.count > 0) side.alpha = std::max(settings_.alpha, 0.1);
      tables_.targets.insert(tables_.targets.end(), list.begin(), list.end());
    }
    tables_.level = settings_.window ? level : 0;
  }

  World const& world_;
  ImportanceSettings const& settings_;
  SteeringTables tables_;
  WorldView view_;
  std::vector<std::uint32_t> goals_;           // footprints where light rejoins, then receivers
  std::vector<Exchange> sides_;                // two per strip
  std::vector<std::vector<double>> adjoints_;  // by goal, then by side; score per unit of power arriving
};

}  // namespace

SteeringTables make_importance(World const& world, ImportanceSettings const& settings) {
  return Builder(world, settings).build();
}

std::string steer(World& world) {
  find_covered_receivers(world);
  if (!world.limits.targets) return {};
  ImportanceSettings settings;
  settings.alpha = world.limits.law_share;
  settings.window = world.limits.window;
  if (world.receivers().empty()) settings.pilot_histories = 0;
  SteeringTables tables = make_importance(world, settings);
  bool const made = !tables.strips.empty();
  world.steer(std::move(tables));
  if (made || world.surfaces().size() == 0) return {};
  return "the scene has too many surfaces for tables of importance: nothing is aimed at, faint routes need more "
         "histories";
}

}  // namespace straytrace
