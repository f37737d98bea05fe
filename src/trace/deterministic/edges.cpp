// SPDX-License-Identifier: BSD-3-Clause
#include "trace/deterministic/edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "trace/step/connect.hpp"
#include "trace/tally/coupling_table.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace::trace {
namespace {

using Complex = std::complex<double>;
using Sum = EdgeSettings::Sum;

// Where the static field of a rim vanishes, its derivative does not, and phase sensitivities relative to that field
// would be infinite: the field is then that of a displacement of this size, m.
constexpr double placed_within = 10e-6;

}  // namespace

double edge_power(EdgeWave const& wave) {
  double power = std::norm(wave.amplitude);
  for (EdgeWave::Gradient const& g : wave.gradient) {
    double slope = 0;
    for (int i = 0; i < 3; ++i) slope += std::norm(g.d[i]);
    power = std::fmax(power, slope * placed_within * placed_within);
  }
  return power;
}

void add_edge_records(std::vector<PathRecord>& records, EdgeWave const& wave, double weight) {
  // Two records of half the power, with phase sensitivities sqrt(2) J (8.13) and sqrt(2) A (8.12).
  double const size = std::abs(wave.amplitude), root = std::sqrt(edge_power(wave));
  Complex const turn = size > 0 ? std::conj(wave.amplitude) / size : Complex{1};
  for (bool const phase : {true, false}) {
    PathRecord record;
    record.weight = record.coupling = 0.5 * weight;
    record.path_length = wave.path_length;
    for (EdgeWave::Gradient const& g : wave.gradient) {
      PhaseSensitivity phase_sensitivity{g.body, {}};
      for (int i = 0; i < 6; ++i) {
        Complex const relative = turn * g.d[i] / root, moment = turn * g.moment[i] / root;
        phase_sensitivity.d[i] = std::sqrt(2.0) * (phase ? relative.imag() : relative.real());
        phase_sensitivity.moment[i] = std::sqrt(2.0) * (phase ? moment.imag() : moment.real());
      }
      record.phase_sensitivities.push_back(phase_sensitivity);
    }
    std::ranges::sort(record.phase_sensitivities, [](auto& a, auto& b) { return a.body < b.body; });
    if (record.weight > 0) records.push_back(std::move(record));
  }
}

namespace {

EdgeWave sum_of(std::vector<EdgeWave> const& waves) {
  EdgeWave sum;
  double weights = 0;
  for (EdgeWave const& wave : waves) {
    sum.amplitude += wave.amplitude;
    weights += std::norm(wave.amplitude);
    sum.path_length += std::norm(wave.amplitude) * wave.path_length;
    for (EdgeWave::Gradient const& g : wave.gradient) {
      auto at = std::ranges::find_if(sum.gradient, [&](auto& s) { return s.body == g.body; });
      if (at == sum.gradient.end()) at = sum.gradient.insert(at, {g.body, {}});
      for (int i = 0; i < 6; ++i) {
        at->d[i] += g.d[i];
        at->moment[i] += g.moment[i];
      }
    }
  }
  sum.path_length = weights > 0 ? sum.path_length / weights : waves.front().path_length;
  return sum;
}

// The rims of one group between two mirrors.
struct Group {
  std::vector<EdgeWave> waves;
  double powers = 0, sizes = 0, teeth = 0;  // sums over the rims: of powers, of fields, of the part of random teeth
  double patches = 0;                       // mean by power
  EdgeWave together;                        // fields added

  void finish() {
    for (EdgeWave const& wave : waves) {
      powers += edge_power(wave);
      sizes += std::sqrt(edge_power(wave));
      patches += edge_power(wave) * wave.patches;
      for (PathRecord const& r : wave.teeth) teeth += r.weight;
    }
    if (powers > 0) patches /= powers;
    if (!waves.empty()) together = sum_of(waves);
  }
  // In phase: (sum |a|)^2, and no phases of the rims make more noise, for |sum a J x|^2 <= sum |a| sum |a| |J x|^2.
  std::vector<PathRecord> records(Sum sum) const {
    std::vector<PathRecord> all;
    if (sum == Sum::geometric) add_edge_records(all, together, edge_power(together));
    for (EdgeWave const& wave : waves) {
      double const power = edge_power(wave);
      if (sum != Sum::geometric) add_edge_records(all, wave, sum == Sum::in_phase ? std::sqrt(power) * sizes : power);
      all.insert(all.end(), wave.teeth.begin(), wave.teeth.end());
    }
    return all;
  }
  std::string statement(Sum sum) const {
    constexpr char const* words[] = {"powers add, because tolerances of millimetres make their phases random",
                                     "fields add with the phases of the drawn geometry",
                                     "fields add in phase, the worst case"};
    std::string text = fmt::format(
        "upper bound: light scattered towards an edge taken as one smooth spherical wave (docs/theory/diffraction.md, "
        "eq. 8.11); speckle, about {} around an edge, lowers the coupling by up to that factor",
        std::fmax(patches, 1) < 1.5 ? "1 patch" : fmt::format("{:.0f} patches", patches));
    if (waves.size() > 1)
      text += fmt::format("; {} edges, {}: coupling {:.3g} by powers, {:.3g} by the drawn phases, {:.3g} in phase",
                          waves.size(), words[int(sum)], powers + teeth, std::norm(together.amplitude) + teeth,
                          sizes * sizes + teeth);
    if (teeth > 0) text += fmt::format("; {:.3g} of it from random teeth one by one", teeth);
    return text + "; first order in the motion";
  }
};

CouplingClass class_of(World const& world, std::uint32_t source, std::uint32_t goal, Group const& group, GroupId id) {
  Footprint const &a = world.footprints()[source], &b = world.footprints()[goal];
  auto const group_of = [&](Footprint const& f) { return world.surfaces()[f.surface.value].group; };
  bool const both = a.receives && a.port.valid() && b.emits && world.reverse_routes;
  return deterministic_class(ClassKind::edge,
                             {{group_of(a), Event::emit}, {id, Event::diffract}, {group_of(b), Event::couple}}, b.port,
                             both ? 2 : 1, group.records(world.edges.sum), group.statement(world.edges.sum));
}

std::vector<InnerRim> rims_of(World const& world, GroupId group) {
  std::vector<InnerRim> rims;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id)
    if (world.surfaces()[id].group == group)
      if (auto const rim = rim_of(world, {id})) rims.push_back(*rim);
  return rims;
}

void add_direction(World const& world, std::uint32_t source, std::uint32_t goal, EdgeClasses& result) {
  for (std::string const& name : world.edges.groups) {
    auto const at = std::ranges::find(world.groups(), name);
    GroupId const id{std::uint32_t(at - world.groups().begin())};
    Group group;
    double seen = 0;
    for (InnerRim const& rim : rims_of(world, id)) {
      EdgeWave wave = edge_wave(world, source, goal, rim);
      seen = std::fmax(seen, wave.seen);
      if (wave.smooth > 0) group.waves.push_back(std::move(wave));
    }
    group.finish();
    if (!group.waves.empty())
      result.classes.push_back(class_of(world, source, goal, group, id));
    else if (source < goal)
      result.warnings.push_back(fmt::format(
          "edges: {} '{}'",
          seen > 0 ? "the mirrors scatter no light towards the inner edges of" : "no mirror pair sees an inner edge of",
          name));
  }
}

}  // namespace

EdgeClasses edge_classes(World const& world) {
  EdgeClasses result;
  if (world.edges.groups.empty()) return result;
  auto const& spots = world.footprints();
  for (std::uint32_t a = 0; a < spots.size(); ++a)
    for (std::uint32_t b = 0; b < spots.size(); ++b) {
      bool const cavity = a != b && spots[a].beam == spots[b].beam && spots[a].standing && spots[b].standing;
      if (cavity && spots[a].emits && spots[b].receives && spots[b].port.valid()) add_direction(world, a, b, result);
    }
  return result;
}

// The wave from one rim. Every point of the rim is a path of its own, with phase and phase sensitivities like any
// other; their sum over the azimuth is eq. 8.11, with J0, and its derivatives are eq. 8.12 and 8.13.

namespace {

using Field = std::complex<double>;
constexpr int sectors = 64;              // of the rim, each seen or not
constexpr std::size_t teeth_points = 8;  // azimuths at which the light of random teeth is recorded

double sinc(double x) { return std::fabs(x) < 1e-8 ? 1 : std::sin(x) / x; }

struct Between {
  World const& world;
  WorldView view;
  std::uint32_t source, goal;
  InnerRim rim;
  Vertex one, two;  // where the main mode is scattered, and where the light rejoins it
  double k = 0, span = 0;

  Between(World const& w, std::uint32_t from, std::uint32_t to, InnerRim const& r)
      : world(w), view(w.view()), source(from), goal(to), rim(r), k(2 * pi / w.wavelength) {
    Footprint const &a = at(source), &b = at(goal);
    one = make_vertex(view, a.surface, a.centre, a.travel);
    two = make_vertex(view, b.surface, b.centre, b.travel);
    span = length(two.point - one.point);
    rim.centre = rim.centre + w.edges.offset;
  }
  Footprint const& at(std::uint32_t number) const { return world.footprints()[number]; }
  double phase(Vec3 p) const { return k * (length(p - one.point) + length(p - two.point) - span); }

  bool sees(Vertex const& mirror, Vec3 p) const {
    Vec3 const way = p - mirror.point;
    double const far = length(way);
    return !view.occluded(Ray{mirror.point, (1 / far) * way, far * (1 - 1e-9)}, Departure(mirror.surface));
  }
  // Just inside the tips, of the rim where it is drawn.
  bool seen(double azimuth) const {
    InnerRim drawn = rim;
    drawn.centre = drawn.centre - world.edges.offset;
    Vec3 const across = std::cos(azimuth) * rim.e1 + std::sin(azimuth) * rim.e2;
    Vec3 const p = drawn.centre + rim.radius * (1 - 1e-4) * across;
    return sees(one, p) && sees(two, p);
  }
  std::vector<PhaseSensitivity> phase_sensitivities(Vec3 p, Vec3 out_one, Vec3 out_two) const {
    Footprint const &a = at(source), &b = at(goal);
    std::vector<PassedVertex> const path = {
        {a.surface, one.point, a.direction(one.point), out_one, Event::emit},
        {rim.surface, p, out_one, -out_two, Event::diffract},
        {b.surface, two.point, -out_two, -b.direction(two.point), Event::couple},
    };
    return phase_sensitivities_of(world, path, source, goal);
  }
};

// Points needed around the rim: the phase runs through k a d/l_r to both sides (eq. 8.11), and a tooth has two flanks.
std::size_t points_of(Between const& p) {
  double low = infinity, high = -infinity;
  for (int j = 0; j < 4 * sectors; ++j) {
    double const a = 2 * pi * j / (4 * sectors);
    double const phase = p.phase(p.rim.centre + p.rim.radius * (std::cos(a) * p.rim.e1 + std::sin(a) * p.rim.e2));
    low = std::fmin(low, phase);
    high = std::fmax(high, phase);
  }
  auto const least = std::size_t(std::ceil((2 * (high - low) + 4 * sectors) / sectors)) * sectors;
  auto const flanks = std::size_t(2 * p.rim.teeth);
  return p.rim.tooth_depth > 0 ? flanks * (least / flanks + 1) : least;
}

// Share of the mean field that remains with random teeth (eq. 8.14): the phase between tip and valley.
double left_by_teeth(Between const& p, Vec3 point) {
  double const height = p.world.edges.tooth_height;
  if (height == 0) return 1;
  Vec3 const from_axis = point - p.rim.centre;
  Vec3 const across = unit(from_axis - dot(from_axis, p.rim.axis) * p.rim.axis);
  return sinc(0.5 * (p.phase(point + 0.5 * height * across) - p.phase(point - 0.5 * height * across)));
}

void add_gradient(EdgeWave& wave, std::vector<PhaseSensitivity> const& phase_sensitivities, Field field) {
  for (PhaseSensitivity const& phase_sensitivity : phase_sensitivities) {
    auto at = std::ranges::find_if(wave.gradient, [&](auto& g) { return g.body == phase_sensitivity.body; });
    if (at == wave.gradient.end()) at = wave.gradient.insert(at, {phase_sensitivity.body, {}});
    for (int i = 0; i < 6; ++i) {
      at->d[i] += Field{0, 1} * phase_sensitivity.d[i] * field;
      at->moment[i] += Field{0, 1} * phase_sensitivity.moment[i] * field;
    }
  }
}

// Besides the mean field, each random tooth emits a wave of its own: (1 - s^2) of its power, over their number.
void add_teeth(EdgeWave& wave, Between const& p, double size, double left,
               std::vector<PhaseSensitivity> phase_sensitivities, double length) {
  double const teeth = 2 * pi * p.rim.radius / p.world.edges.tooth_width;
  PathRecord record;
  record.weight = record.coupling = size * size * (1 - left * left) / (teeth * double(teeth_points));
  record.path_length = length;
  record.phase_sensitivities = std::move(phase_sensitivities);
  if (record.weight > 0) wave.teeth.push_back(std::move(record));
}

}  // namespace

EdgeWave edge_wave(World const& world, std::uint32_t source, std::uint32_t goal, InnerRim const& drawn) {
  Between const p(world, source, goal, drawn);
  EdgeWave wave;
  std::array<bool, sectors> seen;
  for (int j = 0; j < sectors; ++j) seen[std::size_t(j)] = p.seen(2 * pi * (j + 0.5) / sectors);
  std::size_t const points = points_of(p);
  // Flanks of teeth begin at a tip.
  double const first = p.rim.tooth_depth > 0 ? p.rim.phase : 0, step = 2 * pi / double(points);
  double before = p.phase(rim_point(p.rim, first)), smooth = 0, lengths = 0;
  for (std::size_t j = 0; j < points; ++j) {
    double const azimuth = first + (double(j) + 0.5) * step;
    double const after = p.phase(rim_point(p.rim, azimuth + 0.5 * step)), swing = after - before;
    before = after;
    double const turn = azimuth / (2 * pi);
    if (!seen[std::size_t((turn - std::floor(turn)) * sectors) % sectors]) continue;
    Vec3 const point = rim_point(p.rim, azimuth);
    Way const one = way_to(p.view, p.one, point), two = way_to(p.view, p.two, point);
    double const size = world.wavelength * std::sqrt(one.bsdf * two.bsdf * p.at(source).share * p.at(goal).share) /
                        (one.length + two.length);
    double const left = left_by_teeth(p, point);
    Field const field =  // the sinc may be negative
        size * sinc(0.5 * swing) * left / double(points) * std::polar(1.0, p.k * (one.length + two.length - p.span));
    std::vector<PhaseSensitivity> const phase_sensitivities = p.phase_sensitivities(point, one.out, two.out);
    wave.amplitude += field;
    add_gradient(wave, phase_sensitivities, field);
    smooth += size;
    lengths += one.length + two.length;
    wave.seen += 1 / double(points);
    wave.patches =
        std::fmax(wave.patches, 2 * pi * p.rim.radius / world.wavelength *
                                    std::fmax(p.at(source).radius / one.length, p.at(goal).radius / two.length));
    bool const recorded = (j + 1) * teeth_points / points != j * teeth_points / points;
    if (recorded && left < 1) add_teeth(wave, p, size, left, phase_sensitivities, one.length + two.length);
  }
  wave.smooth = smooth / double(points);
  wave.path_length = wave.seen > 0 ? lengths / (wave.seen * double(points)) : 0;
  return wave;
}

}  // namespace straytrace::trace
