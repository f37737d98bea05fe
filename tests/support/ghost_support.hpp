// SPDX-License-Identifier: BSD-3-Clause
// Small worlds for the beam tree, and the beams that end in them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>

#include "base/every_module.hpp"
#include "support/trace_support.hpp"
#include "world/ghosts/main_beam.hpp"

namespace straytrace::testing {

constexpr double lambda = 1.064e-6;
using Amplitude = std::complex<double>;

inline BeamLaunch launched(World const& world, double w = 5e-3, Vec3 from = {0, 0, -1}, Vec3 travel = {0, 0, 1},
                           double curvature = 0) {
  BeamLaunch b;
  b.name = "main";
  b.mode = circular_mode(from, travel, w, curvature, world.wavelength);
  b.field.axis = any_normal(travel);
  return b;
}

// One row of the tree: a beam that has ended.
struct Row {
  BeamEnd end;
  std::uint32_t order = 0;
  double power = 0, path_length = 0, phase = 0;
  Mode mode;
  BeamField field;
  std::vector<BeamStep> way;
  SurfaceId on;
  GhostAlignment standing;
};

// Spots of the main beam and of ghosts up to `limits`, the strongest first within each order.
inline std::vector<BeamSpot> beam_spots(World const& world, BeamLaunch const& launch, TreeLimits const& limits) {
  struct Spots final : BeamSink {
    void arrived(BeamSpot const& spot, std::uint32_t, std::span<BeamStep const>) override { all.push_back(spot); }
    std::vector<BeamSpot> all;
  } spots;
  grow_tree(world, launch, limits, spots);
  std::stable_sort(spots.all.begin(), spots.all.end(), [](BeamSpot const& a, BeamSpot const& b) {
    return a.order != b.order ? a.order < b.order : a.power > b.power;
  });
  return std::move(spots.all);
}

class Rows final : public BeamSink {
 public:
  explicit Rows(MainBeam const* main = nullptr) : main_(main) {}
  void left(LeavingBeam const& beam, std::span<BeamStep const> way) override {
    left_ = beam;
    if (!main_) return;
    standing_.resize(way.size() + 1);
    if (!way.empty()) standing_.back() = main_->standing(standing_[way.size() - 1], beam, way);
  }
  void ended(BeamEnd how, BeamSpot const* spot, LeavingBeam const& beam, std::span<BeamStep const> way) override {
    Row r;
    r.end = how;
    r.order = beam.order;
    r.power = beam.field.power();
    r.path_length = beam.path_length;
    r.phase = 2 * pi / lambda * beam.path_length - beam.gouy;
    r.mode = beam.mode;
    r.field = beam.field;
    r.way.assign(way.begin(), way.end());
    if (spot) r.on = spot->surface;
    if (main_) r.standing = standing_[way.size()];
    all.push_back(r);
  }
  std::vector<Row> all;

 private:
  MainBeam const* main_;
  LeavingBeam left_;
  std::vector<GhostAlignment> standing_;
};

inline std::uint32_t coated(World& world, double reflect) {
  Optic optic;
  optic.reflect = reflect;
  optic.transmit = 1 - reflect;
  return world.add_optic(optic);
}

// A plate of index n with R = reflect on both faces, its back turned by `wedge` about y.
inline World plate(double reflect, double n, double thickness, double wedge, double radius = 0.5) {
  World world;
  world.wavelength = lambda;
  std::uint32_t const optic = coated(world, reflect), volume = world.add_volume({n, 0});
  BodyId const body = world.add_body("plate", {});
  world.add_surface(disk(0, radius, {{0, 0, 0}, {0, 0, -1}}), optic, optic, body, world.add_group("front"), volume);
  world.add_surface(disk(0, radius, {{0, 0, thickness}, unit({std::sin(wedge), 0, std::cos(wedge)})}), optic, optic,
                    body, world.add_group("back"), volume);
  world.finish();
  return world;
}

inline std::vector<Row> rows(World const& world, BeamLaunch const& launch, TreeLimits limits = {},
                             BeamEnergyBalance* wanted = nullptr) {
  MainBeam const main(world, launch, limits);
  Rows sink(&main);
  BeamEnergyBalance const energy_balance = grow_tree(world, launch, limits, sink);
  EXPECT_NEAR(energy_balance.total(), 1, 1e-12);  // R2.24
  if (wanted) *wanted = energy_balance;
  return sink.all;
}

inline Row const& of_order(std::vector<Row> const& all, std::uint32_t order, bool forwards) {
  for (Row const& r : all)
    if (r.order == order && (r.mode.travel.z > 0) == forwards) return r;
  ADD_FAILURE() << "no ghost of order " << order;
  return all.front();
}

}  // namespace straytrace::testing
