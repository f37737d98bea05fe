// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/halo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "base/math/samples.hpp"
#include "trace/deterministic/halo_light.hpp"
#include "trace/step/connect.hpp"
#include "trace/tally/coupling_table.hpp"
#include "trace/tally/replay.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::trace {
namespace {

constexpr int octants = 8;  // around the axis: the records of one plane
constexpr int parts = 8;  // of half a turn: the samples of the error. Speckle opposite each other is correlated (W.42)

// One mirror, and the light that leaves it.
struct LitSide {
  World const& world;
  WorldView view;
  ArmWaves const& waves;
  std::size_t mirror;  // of waves.arm.mirrors
  Vec3 travel;         // of the light that leaves it
  MirrorBrdf brdf;

  LitSide(World const& w, ArmWaves const& a, std::size_t m)
      : world(w), view(w.view()), waves(a), mirror(m), brdf(w, a.arm.mirrors[m], a.arm.mirrors[m].travel) {
    travel = mirror == 0 ? waves.arm.frame.z : -waves.arm.frame.z;
  }
  std::uint32_t footprint() const { return waves.arm.mirrors[mirror].footprint; }
  Footprint const& spot() const { return world.footprints()[footprint()]; }
  bool couples() const { return spot().receives && spot().port.valid(); }
  std::size_t rims() const { return waves.arm.rims.size(); }
  // Baffles in the order in which the light meets them.
  std::size_t rim(std::size_t step) const { return mirror == 0 ? step : rims() - 1 - step; }
  HaloPlane plane(std::size_t step) const {
    return {world, waves.arm, waves.irradiance, rim(step),
            mirror == 0 ? Travel::towards_mirror2 : Travel::towards_mirror1};
  }
  // Share of the power of the mode that a baffle takes from it.
  double taken(std::size_t step) const {
    PowerLedger const& l = waves.ledger;
    return (mirror == 0 ? l.towards_mirror2 : l.towards_mirror1)[rim(step)];
  }
};

// Share of the power that falls on a surface that it scatters back to where the light came from, in the state of
// polarisation of the mode, 1/sr: BSDF times the cosine of the angle of incidence.
double back_scatter(LitSide const& side, Vertex const& vertex) {
  double const cosine = vertex.wi.z;
  if (!(cosine > 0)) return 0;
  double const bsdf = cosine * scatter_eval(side.view.laws, *vertex.optic, vertex.wi, vertex.wi);
  if (!side.world.polarised) return bsdf;
  Polarisation const mode = side.spot().polarisation;
  return bsdf * polarisation_overlap(scattered(mode, side.travel, -side.travel, false, vertex.optic->depolarise), mode,
                                     -side.travel);
}

// Light from the mirror to a surface and back. Its phase sensitivities are those of the way over `vertex`.
PathRecord record_of(LitSide const& side, Vertex const& vertex, double weight) {
  Footprint const& f = side.spot();
  Vec3 const span = vertex.point - f.centre, out = unit(span);
  std::vector<PassedVertex> const way = {{f.surface, f.centre, f.direction(f.centre), out, Event::emit},
                                         {vertex.surface, vertex.point, out, -out, Event::scatter},
                                         {f.surface, f.centre, -out, -f.direction(f.centre), Event::couple}};
  PathRecord record;
  record.weight = record.coupling = weight;
  record.path_length = 2 * length(span);
  record.phase_sensitivities = phase_sensitivities_of(side.world, way, side.footprint(), side.footprint());
  return record;
}

void add_weighted(PathRecord& sum, PathRecord const& one) {
  double const before = sum.weight, share = one.weight / (before + one.weight);
  if (before == 0) {
    sum = one;
    return;
  }
  for (PhaseSensitivity const& s : one.phase_sensitivities) {
    auto at = std::ranges::find(sum.phase_sensitivities, s.body, &PhaseSensitivity::body);
    if (at == sum.phase_sensitivities.end()) at = sum.phase_sensitivities.insert(at, {s.body, {}});
  }
  for (PhaseSensitivity& s : sum.phase_sensitivities) {
    auto const at = std::ranges::find(one.phase_sensitivities, s.body, &PhaseSensitivity::body);
    PhaseSensitivity const other = at == one.phase_sensitivities.end() ? PhaseSensitivity{s.body} : *at;
    for (int i = 0; i < 6; ++i) {
      s.d[i] += share * (other.d[i] - s.d[i]);
      s.moment[i] += share * (other.moment[i] - s.moment[i]);
    }
  }
  sum.path_length += share * (one.path_length - sum.path_length);
  sum.weight = sum.coupling = before + one.weight;
}

struct LitGroup {
  std::vector<PathRecord> records;
  std::vector<double> of_part = std::vector<double>(parts);
  double mixed = 0;  // of it, light below the crossover angle on one way and beyond it on the other
  std::size_t planes = 0;

  double total() const {
    double sum = 0;
    for (double t : of_part) sum += t;
    return sum;
  }
  // Relative standard error of the mean over mirrors, from the spread around the axis.
  double error() const { return total() > 0 ? std::sqrt(sample_variance(of_part) * parts) / total() : 0; }
};
using LitGroups = std::map<std::uint32_t, LitGroup>;

// Mean irradiance by scatter of the mirror beyond the crossover angle (eq. W.17).
double irradiance_beyond(LitSide const& side, double distance, double radius) {
  ArmMirror const& m = side.waves.arm.mirrors[side.mirror];
  return mean_irradiance(side.brdf, m.spot, m.curvature, distance, radius, side.waves.arm.crossover);
}

// The light of one plane; returns the share of the power of the mode that meets surfaces there.
double add_plane(LitSide const& side, HaloPlane const& plane, LitGroups& groups) {
  PolarIrradiance const& light = plane.light();
  double const wavelength = side.world.wavelength;
  std::map<std::uint32_t, std::array<PathRecord, octants>> records;
  double met = 0;
  for (int ring = 0; ring < light.rings; ++ring) {
    double beyond = -1;  // not known yet
    for (int sector = 0; sector < light.sectors; ++sector) {
      std::size_t const cell = std::size_t(ring * light.sectors + sector);
      for (LitPart const& part : plane.parts(ring, sector)) {
        double const area = part.share * light.cell_area(ring);  // across the beam
        met += area * double(light.mean[cell]);
        double const scale = wavelength * wavelength * back_scatter(side, part.vertex) * area;
        if (!(scale > 0)) continue;
        if (beyond < 0) beyond = irradiance_beyond(side, plane.distance(), light.radius(ring));
        double const mixed = scale * 4 * double(light.mean[cell]) * beyond;
        double const weight = scale * double(light.square[cell]) + mixed;
        if (!(weight > 0)) continue;
        std::uint32_t const id = side.world.surfaces()[part.vertex.surface.value].group.value;
        int const half_turn = light.sectors / 2, octant = sector * octants / light.sectors;
        groups[id].of_part[std::size_t(sector % half_turn * parts / half_turn)] += weight;
        groups[id].mixed += mixed;
        add_weighted(records[id][std::size_t(octant)], record_of(side, part.vertex, weight));
      }
    }
  }
  for (auto& [id, of_octant] : records) {
    ++groups[id].planes;
    for (PathRecord& record : of_octant)
      if (record.weight > 0) groups[id].records.push_back(std::move(record));
  }
  return met;
}

std::string statement(LitSide const& side, LitGroup const& group) {
  std::size_t const draws = side.waves.draws.size();
  std::string const error =
      side.world.wave.random()
          ? fmt::format("; standard error of a mean over mirrors {:.2g} %, by the spread around the axis",
                        100 * group.error())
          : "";
  return fmt::format(
      "light of the cavity within {:.4g} urad of the specular direction of its mirrors (docs/theory/wave.md, eq. "
      "W.19), scattered back by surfaces at {} {}, of it {:.2g} with light beyond that angle on one of the two "
      "ways; {}{}",
      1e6 * side.waves.arm.crossover, group.planes, group.planes == 1 ? "plane" : "planes", group.mixed / group.total(),
      draws > 1 ? fmt::format("mean over {} draws of the mirrors", draws) : std::string("one draw of the mirrors"),
      error);
}

// Light below the crossover angle that no route holds.
std::vector<std::string> left_out(World const& world, ArmWaves const& waves, double met, double taken) {
  constexpr double little = 0.1;  // Gibbs ripple at the rims, and light that meets the tube before the plane
  std::vector<std::string> warnings;
  double const urad = 1e6 * waves.arm.crossover;
  if (waves.arm.rims.empty())
    warnings.push_back(fmt::format(
        "wave: without 'baffles', light that the mirrors scatter within {:.4g} urad is in the loss of the cavity alone",
        urad));
  if (met < (1 - little) * taken)
    warnings.push_back(fmt::format(
        "wave: {:.2g} of the light within {:.4g} urad that the edges in 'baffles' cut off meets no surface next to "
        "them and is in the loss of the cavity alone",
        1 - met / taken, urad));
  if (std::ranges::any_of(world.receivers(), &Receiver::clear))
    warnings.push_back(fmt::format(
        "wave: light that the mirrors scatter within {:.4g} urad passes measuring planes uncounted, up to the first "
        "surface that it meets; straytrace wave prints it",
        urad));
  return warnings;
}

}  // namespace

HaloClasses halo_classes(World const& world, ArmWaves const& waves) {
  HaloClasses result;
  double met = 0, taken = 0;
  for (std::size_t mirror : {std::size_t{0}, std::size_t{1}}) {
    LitSide const side(world, waves, mirror);
    LitGroups groups;
    for (std::size_t step = 0; step < side.rims(); ++step) {
      met += add_plane(side, side.plane(step), groups);
      taken += side.taken(step);
    }
    if (!side.couples()) continue;
    GroupId const own = world.surfaces()[side.spot().surface.value].group;
    for (auto& [id, group] : groups) {
      double const error = group.error() * group.total();
      std::string const text = statement(side, group);
      std::vector<PathStep> steps{{own, Event::emit}, {{id}, Event::scatter}, {own, Event::couple}};
      result.classes.push_back(
          deterministic_class(ClassKind::halo, std::move(steps), side.spot().port, 1, std::move(group.records), text));
      if (!world.wave.random()) continue;
      result.classes.back().coupling.std_error = error;
      result.classes.back().azimuth_parts = std::move(group.of_part);
    }
  }
  result.warnings = left_out(world, waves, met, taken);
  return result;
}

}  // namespace straytrace::trace
