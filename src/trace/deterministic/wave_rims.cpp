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

using Complex = std::complex<double>;

// Derivatives of a stray field by the coordinates of bodies, along the axes of the scene.
class BodyGradient {
 public:
  BodyGradient(World const& world, ArmCavity const& arm) : world_(world), arm_(arm) {}

  // By the displacement of a point of a surface, in the frame of the cavity.
  void displacement(SurfaceId surface, Vec3 at, int axis, Complex lever) {
    std::vector<PhaseSensitivity> unit;
    add_hit(unit, world_, surface, arm_.frame.origin + arm_.frame.to_world(at), along(axis));
    for (PhaseSensitivity const& s : unit) add(s, lever);
  }
  // By a rotation about any point: the surface also has the displacements that go with it.
  void rotation(SurfaceId surface, int axis, Complex lever) {
    Vec3 const about = along(axis);
    BodyId const body = world_.surfaces()[surface.value].body;
    if (body.valid()) add({body, {0, 0, 0, about.x, about.y, about.z}}, lever);
  }
  // For light that takes a way of this length [m], by both directions: each body after half of it, in the mean.
  std::vector<EdgeWave::Gradient> values(double length) const {
    std::vector<EdgeWave::Gradient> all = values_;
    for (EdgeWave::Gradient& g : all)
      for (int i = 0; i < 6; ++i) g.moment[i] = g.d[i] * length / (2 * speed_of_light);
    return all;
  }

 private:
  Vec3 along(int axis) const { return axis == 0 ? arm_.frame.x : axis == 1 ? arm_.frame.y : arm_.frame.z; }
  void add(PhaseSensitivity const& unit, Complex lever) {
    auto at = std::ranges::find(values_, unit.body, &EdgeWave::Gradient::body);
    if (at == values_.end()) at = values_.insert(at, {unit.body, {}});
    for (int i = 0; i < 6; ++i) at->d[i] += lever * unit.d[i];
  }

  World const& world_;
  ArmCavity const& arm_;
  std::vector<EdgeWave::Gradient> values_;
};

// Adds a part that the light meets at a point, with its levers, and the mirrors: what counts is its motion relative to
// the axis of the cavity and to the mirrors (eq. W.26), so that no common motion changes the field.
void add_relative(BodyGradient& gradient, ArmCavity const& arm, SurfaceId part, Vec3 at, RimLevers const& levers) {
  auto const &t = levers.displacement, &r = levers.rotation;
  for (int axis : {0, 1, 2}) {
    gradient.displacement(part, at, axis, t[axis]);
    gradient.rotation(part, axis, r[axis]);
  }
  double const length = arm.cavity.length;
  auto const axis = axis_shifts(arm.mirrors[0].curvature, arm.mirrors[1].curvature, length);
  Complex const turn_x = r[1] - at.x * t[2], turn_y = -r[0] - at.y * t[2], roll = r[2] + at.x * t[1] - at.y * t[0];
  for (std::size_t i : {0, 1}) {
    SurfaceId const mirror = arm.mirrors[i].surface;
    double const side = i == 0 ? 1 : -1, curvature = arm.mirrors[i].curvature;
    Vec3 const vertex{0, 0, i == 0 ? 0 : length};
    Complex const across[] = {-(t[0] * axis[i].at(at.z) + turn_x * axis[i].slope),
                              -(t[1] * axis[i].at(at.z) + turn_y * axis[i].slope)};
    for (int j : {0, 1}) gradient.displacement(mirror, vertex, j, curvature * across[j]);
    gradient.rotation(mirror, 1, side * across[0]);
    gradient.rotation(mirror, 0, -side * across[1]);
    double const other = i == 0 ? length - at.z : at.z;
    gradient.displacement(mirror, vertex, 2, -t[2] * other * other / (at.z * at.z + std::pow(length - at.z, 2)));
    gradient.rotation(mirror, 2, -0.5 * roll);
  }
}

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
      BodyGradient gradient(world, arm);
      add_relative(gradient, arm, rim.surface, rim.centre, levers);
      EdgeWave wave;
      wave.amplitude = draw.clipped;
      wave.path_length = way_by(arm, rim);
      wave.gradient = gradient.values(wave.path_length);
      std::size_t const first = records.size();
      add_edge_records(records, wave, share * edge_power(wave));
      for (std::size_t r = first; r < records.size(); ++r) {
        records[r].history = number;
        records[r].event = std::uint32_t(&draw - found.draws.data());
      }
      ++number;
    }
}

// The levers along the three axes are independent of each other, with independent phases. A rotation about an axis
// across the beam moves each patch of speckle along the beam, in proportion to its distance from that axis.
void add_expected(std::vector<PathRecord>& records, World const& world, ArmCavity const& arm, ArmRim const& rim,
                  SpeckleMeans const& means) {
  double const along = std::sqrt(means.longitudinal), across = std::sqrt(means.transverse);
  for (int part = 0; part < 5; ++part) {
    RimLevers levers{};
    if (part < 3)
      levers.displacement[part] = part == 2 ? along : across;
    else
      levers.rotation[part - 3] = rim.rim.radius * along / std::sqrt(2.0);
    BodyGradient gradient(world, arm);
    add_relative(gradient, arm, rim.surface, rim.centre, levers);
    EdgeWave wave;
    wave.amplitude = std::sqrt(means.field / 5);
    wave.path_length = way_by(arm, rim);
    wave.gradient = gradient.values(wave.path_length);
    add_edge_records(records, wave, edge_power(wave));
  }
}

// The outlines and heights of both mirrors, one stray field for each draw of the heights. Its real part changes the
// loss of the mode. Its imaginary part is mostly a change of length, by slopes of the heights under the beam, that
// belongs to the beam itself; of what is stray light in it, the power is that of the real part.
std::vector<PathRecord> mirror_records(World const& world, ArmWaves const& waves) {
  ArmCavity const& arm = waves.arm;
  std::vector<PathRecord> records;
  for (std::size_t draw = 0; draw < waves.draws.size(); ++draw) {
    BodyGradient gradient(world, arm);
    for (std::size_t i : {0, 1}) {
      RimLevers levers{};
      auto const& figure = waves.draws[draw].mirrors[i].figure;
      for (int axis : {0, 1}) levers.displacement[axis] = std::sqrt(2.0) * figure[std::size_t(axis)].real();
      levers.rotation[2] = std::sqrt(2.0) * figure[2].real();
      add_relative(gradient, arm, arm.mirrors[i].surface, {0, 0, i == 0 ? 0 : arm.cavity.length}, levers);
    }
    EdgeWave wave;
    wave.path_length = 2 * arm.cavity.length;
    wave.gradient = gradient.values(wave.path_length);
    std::size_t const first = records.size();
    add_edge_records(records, wave, edge_power(wave) / double(waves.draws.size()));
    for (std::size_t r = first; r < records.size(); ++r) {
      records[r].history = draw;
      records[r].event = std::uint32_t(draw);
    }
  }
  return records;
}

struct RimGroup {
  std::vector<PathRecord> records;
  std::size_t rims = 0, map_draws = 0, draws = 0;
};

// Of rims, in each draw of the heights.
std::string draws_text(World const& world, std::size_t draws) {
  if (!world.wave.rolled()) return fmt::format("{} draws of the tolerances", draws);
  if (!world.wave.tolerance.any()) return fmt::format("{} rolls of one of them", draws);
  return fmt::format("{} draws of the tolerances and of the roll of one of them", draws);
}

std::string statement(World const& world, ArmWaves const& waves, ClassKind kind, RimGroup const& group) {
  std::string const edges = group.rims == 1 ? "1 inner edge" : fmt::format("{} inner edges", group.rims);
  if (kind == ClassKind::speckle)
    return fmt::format(
        "{}, mean over random mirrors with their scatter and outlines (docs/theory/wave.md, eq. W.29): light at angles "
        "above {:.3g} urad, which the grid does not hold; at smaller angles from the other mirror, with the field "
        "on the grid; powers added; first order in the motion",
        edges, 1e6 * waves.arm.crossover);
  std::string drawn = group.map_draws > 1 ? fmt::format("mean over {} draws of the mirrors", group.map_draws)
                                          : std::string("one draw of the mirrors");
  if (group.draws > 0)
    drawn += fmt::format(", {} {}", group.map_draws > 1 ? "each with" : "with", draws_text(world, group.draws));
  return fmt::format(
      "{} in the field of the cavity (docs/theory/wave.md, eq. W.14): {}; both directions; powers added; first order "
      "in the motion",
      edges, drawn);
}

constexpr char of_mirrors[] =
    "loss of the mode by the motion of both mirrors, their outlines and their heights below the crossover angle "
    "(docs/theory/wave.md, eq. W.27), in the amplitude quadrature; in the phase quadrature as much, without the "
    "coupling of angle to length of the beam itself; coupling that of a displacement of 10 um; first order in the "
    "motion";

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
      group.draws = found.draws.front().responses.size() - 1;
    }
    if (solved)
      add_solved(group.records, world, waves.arm, rim, found);
    else
      add_expected(group.records, world, waves.arm, rim, found.speckle);
  }
  return group;
}

}  // namespace

std::vector<CouplingClass> wave_rim_classes(World const& world, ArmWaves const& waves) {
  Footprint const* from = &world.footprints()[waves.arm.mirrors[1].footprint];
  Footprint const* to = &world.footprints()[waves.arm.mirrors[0].footprint];
  if (!to->port.valid()) std::swap(from, to);
  std::vector<CouplingClass> classes;
  if (!to->port.valid()) return classes;
  auto const group_of = [&](SurfaceId id) { return world.surfaces()[id.value].group; };
  std::vector<PathStep> const mirrors{{group_of(from->surface), Event::emit}, {group_of(to->surface), Event::couple}};
  if (std::vector<PathRecord> records = mirror_records(world, waves); !records.empty())
    classes.push_back(deterministic_class(ClassKind::wave, mirrors, to->port, 1, std::move(records), of_mirrors));
  for (ClassKind const kind : {ClassKind::wave, ClassKind::speckle})
    for (std::string const& name : world.wave.groups) {
      RimGroup group = rims_of_kind(world, waves, name, kind);
      if (group.records.empty()) continue;
      auto const at = std::ranges::find(world.groups(), name);
      std::vector<PathStep> steps{{group_of(from->surface), Event::emit},
                                  {GroupId{std::uint32_t(at - world.groups().begin())}, Event::diffract},
                                  {group_of(to->surface), Event::couple}};
      std::string const text = statement(world, waves, kind, group);
      classes.push_back(deterministic_class(kind, std::move(steps), to->port, 1, std::move(group.records), text));
    }
  return classes;
}

}  // namespace straytrace::trace
