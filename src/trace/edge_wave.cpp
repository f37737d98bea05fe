// SPDX-License-Identifier: BSD-3-Clause
// The wave from one rim. Every point of the rim is a path of its own, with phase and levers like any other; their sum
// over the azimuth is eq. 8.11, with J0, and its derivatives are eq. 8.12 and 8.13.
#include <algorithm>
#include <array>
#include <cmath>

#include "trace/edges.hpp"
#include "trace/estimate/connect.hpp"
#include "trace/tally/replay.hpp"

namespace straytrace {
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
  std::vector<Lever> levers(Vec3 p, Vec3 out_one, Vec3 out_two) const {
    Footprint const &a = at(source), &b = at(goal);
    std::vector<PassedVertex> const path = {
        {a.surface, one.point, a.direction(one.point), out_one, Event::emit},
        {rim.surface, p, out_one, -out_two, Event::diffract},
        {b.surface, two.point, -out_two, -b.direction(two.point), Event::couple},
    };
    return levers_of(world, path, source, goal);
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

// Share of the mean field that random teeth leave (eq. 8.14): the phase between tip and valley.
double left_by_teeth(Between const& p, Vec3 point) {
  double const height = p.world.edges.tooth_height;
  if (height == 0) return 1;
  Vec3 const from_axis = point - p.rim.centre;
  Vec3 const across = unit(from_axis - dot(from_axis, p.rim.axis) * p.rim.axis);
  return sinc(0.5 * (p.phase(point + 0.5 * height * across) - p.phase(point - 0.5 * height * across)));
}

void add_gradient(EdgeWave& wave, std::vector<Lever> const& levers, Field field) {
  for (Lever const& lever : levers) {
    auto at = std::find_if(wave.gradient.begin(), wave.gradient.end(), [&](auto& g) { return g.body == lever.body; });
    if (at == wave.gradient.end()) at = wave.gradient.insert(at, {lever.body, {}});
    for (int i = 0; i < 6; ++i) at->d[i] += Field{0, 1} * lever.d[i] * field;
  }
}

// Each random tooth sends out, besides the mean field, a wave of its own: (1 - s^2) of its power, over their number.
void add_teeth(EdgeWave& wave, Between const& p, double size, double left, std::vector<Lever> levers, double length) {
  double const teeth = 2 * pi * p.rim.radius / p.world.edges.tooth_width;
  PathRecord record;
  record.weight = record.coupling = size * size * (1 - left * left) / (teeth * double(teeth_points));
  record.path_length = length;
  record.levers = std::move(levers);
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
    std::vector<Lever> const levers = p.levers(point, one.out, two.out);
    wave.amplitude += field;
    add_gradient(wave, levers, field);
    smooth += size;
    lengths += one.length + two.length;
    wave.seen += 1 / double(points);
    wave.patches =
        std::fmax(wave.patches, 2 * pi * p.rim.radius / world.wavelength *
                                    std::fmax(p.at(source).radius / one.length, p.at(goal).radius / two.length));
    bool const recorded = (j + 1) * teeth_points / points != j * teeth_points / points;
    if (recorded && left < 1) add_teeth(wave, p, size, left, levers, one.length + two.length);
  }
  wave.smooth = smooth / double(points);
  wave.path_length = wave.seen > 0 ? lengths / (wave.seen * double(points)) : 0;
  return wave;
}

}  // namespace straytrace
