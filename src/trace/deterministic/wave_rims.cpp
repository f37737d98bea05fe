// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/wave_rims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trace/deterministic/edges.hpp"
#include "trace/tally/coupling_table.hpp"
#include "world/model/world.hpp"

namespace straytrace::trace {
namespace {

// Derivatives by the coordinates of the body of a rim, along the axes of the scene, of a stray field with these
// derivatives by the displacement and the rotation of the rim about its reference.
class BodyGradient {
 public:
  BodyGradient(World const& world, ArmCavity const& arm, ArmRim const& rim) : world_(world), arm_(arm), rim_(rim) {}

  void displacement(int axis, std::complex<double> lever) {
    Vec3 const along = axis == 0 ? arm_.frame.x : axis == 1 ? arm_.frame.y : arm_.frame.z;
    Vec3 const at = arm_.frame.origin + arm_.frame.to_world(rim_.centre);
    std::vector<PhaseSensitivity> unit;
    add_hit(unit, world_, rim_.surface, at, along);
    for (PhaseSensitivity const& s : unit) add(s, lever);
  }
  void rotation(int axis, std::complex<double> lever) {
    Vec3 const about = axis == 0 ? arm_.frame.x : axis == 1 ? arm_.frame.y : arm_.frame.z;
    BodyId const body = world_.surfaces()[rim_.surface.value].body;
    if (body.valid()) add({body, {0, 0, 0, about.x, about.y, about.z}}, lever);
  }
  std::vector<EdgeWave::Gradient> const& values() const { return values_; }

 private:
  void add(PhaseSensitivity const& unit, std::complex<double> lever) {
    auto at = std::ranges::find(values_, unit.body, &EdgeWave::Gradient::body);
    if (at == values_.end()) at = values_.insert(at, {unit.body, {}});
    for (int i = 0; i < 6; ++i) at->d[i] += lever * unit.d[i];
  }

  World const& world_;
  ArmCavity const& arm_;
  ArmRim const& rim_;
  std::vector<EdgeWave::Gradient> values_;
};

double way_by(ArmCavity const& arm, ArmRim const& rim) {  // m, from mirror to mirror over the rim
  double const one = rim.centre.z, two = arm.cavity.length - rim.centre.z;
  return std::hypot(one, rim.rim.radius) + std::hypot(two, rim.rim.radius);
}

// The mean over the draws; the number of a draw is that of the histories of its records.
void add_solved(std::vector<PathRecord>& records, World const& world, ArmCavity const& arm, ArmRim const& rim,
                RimResult const& found) {
  double const share = 1 / double(found.ensemble().size());
  std::uint64_t number = 0;
  for (RimDraw const& draw : found.draws)
    for (std::size_t i = draw.responses.size() > 1 ? 1 : 0; i < draw.responses.size(); ++i) {
      RimLevers const& levers = draw.responses[i].levers;
      BodyGradient gradient(world, arm, rim);
      for (int axis = 0; axis < 3; ++axis) gradient.displacement(axis, levers.displacement[axis]);
      for (int axis = 0; axis < 3; ++axis) gradient.rotation(axis, levers.rotation[axis]);
      EdgeWave wave;
      wave.amplitude = draw.clipped;
      wave.gradient = gradient.values();
      wave.path_length = way_by(arm, rim);
      std::size_t const first = records.size();
      add_edge_records(records, wave, share * edge_power(wave));
      for (std::size_t r = first; r < records.size(); ++r) records[r].history = number;
      ++number;
    }
}

// The levers along the three axes are independent of each other, with independent phases. A rotation about an axis
// across the beam moves each patch of speckle along the beam, in proportion to its distance from that axis.
void add_expected(std::vector<PathRecord>& records, World const& world, ArmCavity const& arm, ArmRim const& rim,
                  SpeckleMeans const& means) {
  double const along = std::sqrt(means.longitudinal), across = std::sqrt(means.transverse);
  for (int part = 0; part < 5; ++part) {
    BodyGradient gradient(world, arm, rim);
    if (part < 3)
      gradient.displacement(part, part == 2 ? along : across);
    else
      gradient.rotation(part - 3, rim.rim.radius * along / std::sqrt(2.0));
    EdgeWave wave;
    wave.amplitude = std::sqrt(means.field / 5);
    wave.gradient = gradient.values();
    wave.path_length = way_by(arm, rim);
    add_edge_records(records, wave, edge_power(wave));
  }
}

struct RimGroup {
  std::vector<PathRecord> records;
  std::size_t rims = 0, map_draws = 0, tolerance_draws = 0;
};

std::string statement(ArmWaves const& waves, ClassKind kind, RimGroup const& group) {
  std::string const rims = group.rims == 1 ? "1 rim" : fmt::format("{} rims", group.rims);
  if (kind == ClassKind::speckle)
    return fmt::format(
        "{}, mean over random mirrors with their scatter (docs/theory/wave.md, eq. W.22): light at angles above "
        "{:.3g} urad, which the grid does not hold; without the waves of other edges, which raised powers up to "
        "fourfold where the grid held "
        "them; powers added; first order in the motion",
        rims, 1e6 * waves.arm.crossover);
  std::string drawn = group.map_draws > 1 ? fmt::format("mean over {} draws of the mirrors", group.map_draws)
                                          : std::string("one draw of the mirrors");
  drawn += group.tolerance_draws > 0 ? fmt::format(", each with {} of the tolerances", group.tolerance_draws)
                                     : std::string(", rims as in the scene");
  return fmt::format(
      "{} in the field of the cavity (docs/theory/wave.md, eq. W.14): {}; both directions; powers added; first order "
      "in the motion",
      rims, drawn);
}

// The rims of one entry of the scene, of one kind.
RimGroup rims_of_kind(World const& world, ArmWaves const& waves, std::string const& name, ClassKind kind) {
  RimGroup group;
  for (std::size_t i = 0; i < waves.rims.size(); ++i) {
    ArmRim const& rim = waves.arm.rims[i];
    RimResult const& found = waves.rims[i];
    bool const solved = !found.draws.empty();
    if (world.name_of(rim.surface) != name || solved != (kind == ClassKind::wave)) continue;
    ++group.rims;
    if (solved) {
      group.map_draws = found.draws.size();
      group.tolerance_draws = found.draws.front().responses.size() - 1;
    }
    if (solved)
      add_solved(group.records, world, waves.arm, rim, found);
    else
      add_expected(group.records, world, waves.arm, rim, found.speckle);
  }
  return group;
}

Footprint const& spot_on(World const& world, SurfaceId mirror) {
  return *std::ranges::find_if(world.footprints(), [&](Footprint const& f) {
    return f.standing && f.beam == world.wave.beam && f.surface == mirror;
  });
}

}  // namespace

std::vector<CouplingClass> wave_rim_classes(World const& world, ArmWaves const& waves) {
  Footprint const* from = &spot_on(world, waves.arm.mirrors[1].surface);
  Footprint const* to = &spot_on(world, waves.arm.mirrors[0].surface);
  if (!to->port.valid()) std::swap(from, to);
  std::vector<CouplingClass> classes;
  if (!to->port.valid()) return classes;
  auto const group_of = [&](SurfaceId id) { return world.surfaces()[id.value].group; };
  for (ClassKind const kind : {ClassKind::wave, ClassKind::speckle})
    for (std::string const& name : world.wave.groups) {
      RimGroup group = rims_of_kind(world, waves, name, kind);
      if (group.records.empty()) continue;
      auto const at = std::ranges::find(world.groups(), name);
      std::vector<PathStep> steps{{group_of(from->surface), Event::emit},
                                  {GroupId{std::uint32_t(at - world.groups().begin())}, Event::diffract},
                                  {group_of(to->surface), Event::couple}};
      std::string const text = statement(waves, kind, group);
      classes.push_back(deterministic_class(kind, std::move(steps), to->port, 1, std::move(group.records), text));
    }
  return classes;
}

}  // namespace straytrace::trace
