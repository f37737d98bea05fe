// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/moving_rims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "base/math/gauss_points.hpp"
#include "base/math/linear_algebra.hpp"
#include "trace/tally/coupling_table.hpp"

namespace straytrace::trace {
namespace {

constexpr double least_removed = 1e-12;  // of the field: rims that take less have no route

using Flat = world::BeamAperture::Flat;
using world::FlatRim;
using world::Outline;

constexpr double far_off = 6;  // 1/e^2 radii: e^-72 of the light on the axis
constexpr int points_of_a_piece = 8;

// `by`: rad about its direction.
Vec3 turned(Vec3 v, Vec3 by) {
  double const angle = length(by);
  if (!(angle > 0)) return v;
  Vec3 const axis = (1 / angle) * by;
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

Vec3 corner(Outline const& o, FlatRim const& rim, int k) {
  if (o.rectangle) {
    double const x = k == 0 || k == 3 ? o.semi_x : -o.semi_x, y = k < 2 ? o.semi_y : -o.semi_y;
    return rim.centre + x * rim.e1 + y * rim.e2;
  }
  double const at = o.rotation + 2 * pi * k / o.sides;
  return rim.centre + o.semi_x * std::cos(at) * rim.e1 + o.semi_x * std::sin(at) * rim.e2;
}

// Calls each(point, step) along an outline, from e1 towards e2, in pieces of a radius of the beam.
template <class Each>
void along(Outline const& o, FlatRim const& rim, double piece, Each const& each) {
  static GaussPoints const rule(points_of_a_piece);
  auto const pieces = [&](double length) { return int(std::clamp(std::ceil(length / piece), 1.0, 1e6)); };
  auto const run = [&](int count, auto const& point, auto const& slope) {
    for (int i = 0; i < count; ++i)
      for (int g = 0; g < points_of_a_piece; ++g) {
        double const t = (i + rule.at[std::size_t(g)]) / count;
        each(point(t), (rule.weight[std::size_t(g)] / count) * slope(t));
      }
  };
  if (o.sides == 0) {
    int const count = std::max(16, pieces(2 * pi * std::max(o.semi_x, o.semi_y)));
    run(
        count,
        [&](double t) {
          SinCos const a = sincos_turn(t);
          return rim.centre + o.semi_x * a.cos * rim.e1 + o.semi_y * a.sin * rim.e2;
        },
        [&](double t) {
          SinCos const a = sincos_turn(t);
          return 2 * pi * (o.semi_y * a.cos * rim.e2 - o.semi_x * a.sin * rim.e1);
        });
    return;
  }
  for (int k = 0; k < int(o.sides); ++k) {
    Vec3 const from = corner(o, rim, k), side = corner(o, rim, (k + 1) % int(o.sides)) - from;
    run(
        pieces(length(side)), [&](double t) { return from + t * side; }, [&](double) { return side; });
  }
}

// A beam of power 1: its light and the lines across it.
class Light {
 public:
  explicit Light(Mode const& mode) : mode_(mode), spot_(beams::spot(mode)) {}
  double minor() const { return spot_.minor; }
  bool reaches(Vec3 p) const {
    Vec3 const o = p - mode_.origin;
    return length2(o - dot(o, mode_.travel) * mode_.travel) < far_off * far_off * spot_.major * spot_.major;
  }
  // W/m^2, along the normal of the wavefront. It has no sources, so the power through a surface depends on its edge
  // alone.
  Vec3 flux(Vec3 p) const {
    Mode const at = beams::propagated(mode_, dot(p - mode_.origin, mode_.travel));
    Vec3 const o = p - at.origin;
    double const x = dot(o, at.e1), y = dot(o, at.e2);
    return beams::intensity(at, p) * (at.travel + (at.q11.real() * x + at.q12.real() * y) * at.e1 +
                                      (at.q12.real() * x + at.q22.real() * y) * at.e2);
  }
  // Coordinates of a vector in which the beam is round: exp(-2 rho^2) of its power lies beyond rho.
  world::PlanePoint round(Vec3 v) const {
    double const k = pi / mode_.wavelength, a = k * mode_.q11.imag(), b = k * mode_.q12.imag(),
                 c = k * mode_.q22.imag(), root = std::sqrt(a);
    double const x = dot(v, mode_.e1), y = dot(v, mode_.e2);
    return {root * x + b / root * y, std::sqrt(c - b * b / a) * y};
  }
  Vec3 origin() const { return mode_.origin; }
  double side(FlatRim const& rim) const { return dot(rim.axis, mode_.travel) < 0 ? -1 : 1; }

 private:
  Mode mode_;
  beams::Spot spot_;
};

// Share of the power inside an outline: the turns of its edge about the chief ray less their part beyond rho.
struct Inside {
  double turns = 0;   // 1 or 0, where the edge is not near the chief ray
  double beyond = 0;  // turns weighed by exp(-2 rho^2)
  double share = 0;
  bool near = false;
};
Inside inside(Outline const& o, FlatRim const& rim, Light const& light) {
  constexpr double close = 0.3;  // rho
  Inside sum;
  double nearest = std::numeric_limits<double>::infinity();
  along(o, rim, light.minor(), [&](Vec3 p, Vec3 step) {
    world::PlanePoint const r = light.round(p - light.origin()), d = light.round(step);
    double const square = r.x * r.x + r.y * r.y, turn = light.side(rim) * (r.x * d.y - r.y * d.x) / (2 * pi * square);
    sum.share -= std::expm1(-2 * square) * turn;
    sum.beyond += std::exp(-2 * square) * turn;
    nearest = std::min(nearest, std::sqrt(square));
  });
  sum.near = nearest < close;
  sum.turns = std::round(sum.share + sum.beyond);
  return sum;
}

double removed_by(Flat const& f, Light const& light) {
  Inside const outer = inside(f.rim.outer, f.rim, light),
               inner = f.rim.hole ? inside(f.rim.inner, f.rim, light) : Inside{};
  double const met = outer.share - inner.share, lost = f.screen ? met : 1 - met;
  if (outer.near || inner.near) return lost;
  double const whole = outer.turns - inner.turns, beyond = outer.beyond - inner.beyond;
  return (f.screen ? whole : 1 - whole) - (f.screen ? beyond : -beyond);
}

// Slope of the power on the plate by a motion v of its edge, the integral of S . (v x dl), for each coordinate.
void add_slope(CoordinateGradient& slope, Outline const& o, FlatRim const& rim, Vec3 pivot, Light const& light,
               double sign) {
  along(o, rim, light.minor(), [&](Vec3 p, Vec3 step) {
    if (!light.reaches(p)) return;
    Vec3 const by = cross(step, light.flux(p)), turn = cross(p - pivot, by);  // S . (v x dl) = v . (dl x S)
    double const all[] = {by.x, by.y, by.z, turn.x, turn.y, turn.z};
    for (int i = 0; i < 6; ++i) slope[i] += sign * all[i];
  });
}

CoordinateGradient slope_of(Flat const& f, Vec3 pivot, Light const& light) {
  CoordinateGradient slope = CoordinateGradient::Zero();
  double const sign = (f.screen ? -1 : 1) * light.side(f.rim);
  add_slope(slope, f.rim.outer, f.rim, pivot, light, sign);
  if (f.rim.hole) add_slope(slope, f.rim.inner, f.rim, pivot, light, -sign);
  return slope;
}

Flat displaced(Flat f, Vec3 pivot, CoordinateGradient const& x) {
  Vec3 const turn{x[3], x[4], x[5]};
  f.rim.centre = pivot + turned(f.rim.centre - pivot, turn) + Vec3{x[0], x[1], x[2]};
  for (Vec3* v : {&f.rim.e1, &f.rim.e2, &f.rim.axis}) *v = turned(*v, turn);
  return f;
}

// m, from its centre to the edge, along the longer axis.
double size_of(FlatRim const& rim) {
  Outline const& o = rim.hole ? rim.inner : rim.outer;
  return std::hypot(o.semi_x, o.rectangle ? o.semi_y : 0.0);
}

}  // namespace

RimDerivatives rim_derivatives(Flat const& f, Vec3 pivot) {
  constexpr double part = 0.005;  // of a radius of the beam
  Light const light(f.mode);
  double const shift = part * light.minor(),
               turn = std::min(part, shift / std::max(length(f.rim.centre - pivot), size_of(f.rim)));
  RimDerivatives d;
  d.removed = removed_by(f, light);
  d.slope = slope_of(f, pivot, light);
  for (int j = 0; j < 6; ++j) {  // differences of fourth order
    double const h = j < 3 ? shift : turn;
    auto const at = [&](double steps) -> CoordinateGradient {
      CoordinateGradient const x = steps * h * CoordinateGradient::Unit(j);
      return slope_of(displaced(f, pivot, x), pivot + Vec3{x[0], x[1], x[2]}, light);
    };
    d.curvature.col(j) = (at(-2) - 8 * at(-1) + 8 * at(1) - at(2)) / (12 * h);
  }
  d.curvature = (0.5 * (d.curvature + d.curvature.transpose())).eval();
  return d;
}

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
  SymmetricModes const own = symmetric_modes(even);
  double const largest = own.values.cwiseAbs().maxCoeff();
  for (int i = 0; i < 6; ++i) {
    double const value = own.values[i] / removed;
    if (!(std::fabs(value) * removed > rounding * largest)) continue;
    // s = -d (... - 1/2 sum +-(q x)^2): a growing field has the sign plus.
    PathRecord r = record_of(value > 0 ? RimTerm::second_plus : RimTerm::second_minus);
    CoordinateGradient const q = std::sqrt(std::fabs(value)) * scale.cwiseProduct(own.vectors.col(i));
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
