// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/moving_rims.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "trace/tally/coupling_table.hpp"

namespace straytrace::trace {
namespace {

using Round = world::BeamAperture::Round;

Round displaced(Round rim, Vec3 pivot, CoordinateGradient const& x) {
  Vec3 const turn{x[3], x[4], x[5]};
  rim.centre = pivot + turned(rim.centre - pivot, turn) + Vec3{x[0], x[1], x[2]};
  rim.axis = turned(rim.axis, turn);
  return rim;
}

// Steps over which the clipped share changes by a few percent: it falls as exp(-2 a^2/w^2) in the radius a.
CoordinateGradient steps_of(Round const& rim, Vec3 pivot) {
  constexpr double part = 0.02;
  beams::Spot const s = beams::spot(rim.mode);
  double const w = std::min(s.major, s.minor), shift = part * std::min(w, w * w / (4 * rim.radius)),
               turn = std::min(part, shift / std::max(length(rim.centre - pivot), rim.radius));
  CoordinateGradient h;
  h << shift, shift, shift, turn, turn, turn;
  return h;
}

}  // namespace

RimDerivatives rim_derivatives(Round const& rim, Vec3 pivot) {
  CoordinateGradient const h = steps_of(rim, pivot);
  auto const removed = [&](CoordinateGradient const& x) { return displaced(rim, pivot, x).clipped(); };
  auto const along = [&](int i, double steps) -> CoordinateGradient {
    return steps * h[i] * CoordinateGradient::Unit(i);
  };
  RimDerivatives d;
  d.removed = rim.clipped();
  for (int i = 0; i < 6; ++i) {  // differences of fourth order
    double const a = removed(along(i, -2)), b = removed(along(i, -1)), c = removed(along(i, 1)),
                 e = removed(along(i, 2));
    d.slope[i] = -(a - 8 * b + 8 * c - e) / (12 * h[i]);
    d.curvature(i, i) = -(-a + 16 * b - 30 * d.removed + 16 * c - e) / (12 * h[i] * h[i]);
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) {
      auto const at = [&](double p, double q) { return removed(along(i, p) + along(j, q)); };
      d.curvature(i, j) = d.curvature(j, i) = -(at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h[i] * h[j]);
    }
  return d;
}

namespace {

PathRecord record_of(RimTerm term) {
  PathRecord r;
  r.event = std::uint32_t(term);
  return r;
}

PhaseSensitivity sensitivity(BodyId body, CoordinateGradient const& d) {
  PhaseSensitivity s{body, {}};
  for (int i = 0; i < 6; ++i) s.d[i] = d[i];
  return s;
}

// Principal directions of the second-order term; those below rounding of the differences are left out. Rotations count
// by the displacement they make at `arm` [m].
void add_second(std::vector<PathRecord>& records, BodyId body, CoordinateCurvature const& curvature, double removed,
                double arm) {
  constexpr double rounding = 1e-4;
  CoordinateGradient scale;
  scale << 1, 1, 1, arm, arm, arm;
  CoordinateCurvature const even = scale.cwiseInverse().asDiagonal() * curvature * scale.cwiseInverse().asDiagonal();
  Eigen::SelfAdjointEigenSolver<CoordinateCurvature> const own(even);
  double const largest = own.eigenvalues().cwiseAbs().maxCoeff();
  for (int i = 0; i < 6; ++i) {
    double const value = own.eigenvalues()[i] / removed;
    if (!(std::fabs(value) * removed > rounding * largest)) continue;
    // s = -d (... - 1/2 sum +-(q x)^2): a growing field has the sign plus.
    PathRecord r = record_of(value > 0 ? RimTerm::second_plus : RimTerm::second_minus);
    CoordinateGradient const q = std::sqrt(std::fabs(value)) * scale.cwiseProduct(own.eigenvectors().col(i));
    r.phase_sensitivities = {sensitivity(body, q)};
    records.push_back(std::move(r));
  }
}

// All rims of one object on one body.
struct BodyRims {
  RimDerivatives sum{};
  double arm = 0;  // m, of rotations
};
struct ObjectRims {
  std::map<std::uint32_t, BodyRims> by_body;
  double along = 0;
  std::size_t rims = 0;
  bool standing = false;
};

void add(ObjectRims& object, World const& world, world::BeamAperture const& a) {
  BodyId const body = world.surfaces()[a.surface.value].body;
  Vec3 const pivot = world.bodies()[body.value].pivot;
  bool const round = a.round.radius > 0;
  RimDerivatives const d = round ? rim_derivatives(a.round, pivot) : rim_derivatives(*a.flat, pivot);
  double const size = round ? a.round.radius : size_of(a.flat->rim);
  Vec3 const centre = round ? a.round.centre : a.flat->rim.centre;
  BodyRims& at = object.by_body[body.value];
  at.sum.removed += d.removed;
  at.sum.slope += d.slope;
  at.sum.curvature += d.curvature;
  at.arm = std::max({at.arm, length(centre - pivot), size});
  object.along = a.along;
  object.standing = a.standing;
  ++object.rims;
}

std::string statement(ObjectRims const& object, double removed) {
  return fmt::format(
      "{} in the main beam, which {} {:.3g} of its field{} (docs/theory/diffraction.md, eq. N.21): static phase known; "
      "first and second order in the motion of its body, the beam at rest",
      object.rims == 1 ? "1 rim" : fmt::format("{} rims", object.rims), object.rims == 1 ? "takes" : "take", removed,
      object.standing ? " each way" : "");
}

CouplingClass class_of(ObjectRims const& object, GroupId group, PortId port) {
  double removed = 0;
  for (auto const& [body, rims] : object.by_body) removed += rims.sum.removed;
  PathRecord first = record_of(RimTerm::first);
  first.coupling = first.weight = removed * removed;
  first.path_length = object.along;
  std::vector<PathRecord> records;
  for (auto const& [body, rims] : object.by_body) {
    first.phase_sensitivities.push_back(sensitivity(BodyId{body}, rims.sum.slope / removed));
    add_second(records, BodyId{body}, rims.sum.curvature, removed, rims.arm);
  }
  records.insert(records.begin(), std::move(first));
  return deterministic_class(ClassKind::rim, {{group, Event::diffract}}, port, 1, std::move(records),
                             statement(object, removed));
}

// The port where light of a beam rejoins: of a cavity that of its first mirror that has one, of a free beam the first.
std::optional<PortId> port_of(World const& world, std::uint32_t beam, bool standing) {
  for (Footprint const& f : world.footprints())
    if (f.beam == beam && f.port.valid() && (!standing || f.standing)) return f.port;
  return {};
}

// Beams that are one light of the network or run against each other in it: the response of eq. N.21 holds both ways, so
// a rim that both pass counts for the first of them that has a port.
std::vector<std::uint32_t> first_of_both_ways(World const& world) {
  std::vector<std::uint32_t> first(world.beams.size());
  auto const run_together = [&](std::uint32_t a, std::uint32_t b) {
    if (world.beams[a].network.empty() || !port_of(world, b, false)) return false;
    return world.beams[a].network == world.beams[b].network ||
           std::ranges::any_of(world.port_pairs(), [&](World::PortPair const& p) {
             return p.beam == a && p.forward && port_of(world, b, false) == p.to;
           });
  };
  for (std::uint32_t b = 0; b < first.size(); ++b) {
    first[b] = b;
    for (std::uint32_t other = b; other-- > 0;)
      if (run_together(b, other)) first[b] = first[other];
  }
  return first;
}

// Fields of `wave` include the rims between its mirrors.
bool in_wave(World const& world, world::BeamAperture const& a) { return a.standing && world.wave.present; }

}  // namespace

MovingRimClasses moving_rim_classes(World const& world) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, ObjectRims> all;  // by port and group
  MovingRimClasses out;
  std::vector<std::uint32_t> const first = first_of_both_ways(world);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> met_by;  // beam, by that of its port and surface
  for (world::BeamAperture const& a : world::apertures_of(world)) {
    std::uint32_t const beam = a.standing || first.empty() ? a.beam : first.at(a.beam);
    auto const port = port_of(world, beam, a.standing);
    if (!port || !(a.standing || a.main_way) || !(a.clipped > least_removed) || in_wave(world, a)) continue;
    if (!world.surfaces()[a.surface.value].body.valid()) continue;
    if (a.standing && a.reflected) continue;  // the mirrors carry the mode itself
    if (!a.standing && met_by.emplace(std::pair(beam, a.surface.value), a.beam).first->second != a.beam) continue;
    if (!(a.round.radius > 0) && !a.flat) {
      out.warnings.push_back(
          fmt::format("rims: '{}' clips {:.2g} of the beam, but is not flat: its motion has no route",
                      world.name_of(a.surface), a.clipped));
      continue;
    }
    add(all[{port->value, a.group.value}], world, a);
  }
  for (auto const& [key, object] : all) out.classes.push_back(class_of(object, GroupId{key.second}, PortId{key.first}));
  return out;
}

}  // namespace straytrace::trace
