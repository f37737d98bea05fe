// SPDX-License-Identifier: BSD-3-Clause
#include "world/ghosts/apertures.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "beams/overlap.hpp"
#include "world/ghosts/beam_tree.hpp"
#include "world/ghosts/obstacle.hpp"
#include "world/model/world.hpp"

namespace straytrace::world {
namespace {

bool scatters(World const& world, SurfaceId surface, bool front) {
  Surface const& s = world.surfaces()[surface.value];
  return world.view().optics[front ? s.front : s.back].laws > 0;
}

// Share of lines beside the surface, out of lines_tried^2.
constexpr int lines_tried = 64;
double beside(WorldView const& view, Footprint const& f) {
  int missed = 0;
  for (int i = 0; i < lines_tried; ++i)
    for (int k = 0; k < lines_tried; ++k) {
      Ray const line = f.sample((i + 0.5) / lines_tried, (k + 0.5) / lines_tried);
      if (!(view.cross(f.surface.value, line, {}).distance < infinity)) ++missed;
    }
  return double(missed) / (lines_tried * lines_tried);
}

}  // namespace

Polarisation polarisation_of(BeamField const& field) {
  Polarisation mean{field.axis, 0, 0, 0};
  double power = 0;
  for (int i = 0; i < field.states; ++i) {
    double const share = norm(field.state[i].a) + norm(field.state[i].b);
    if (!(share > 0)) continue;
    Polarisation const one = stokes(field.state[i], field.axis);
    mean.q += share * one.q;
    mean.u += share * one.u;
    mean.v += share * one.v;
    power += share;
  }
  if (power > 0)
    for (double* x : {&mean.q, &mean.u, &mean.v}) *x /= power;
  return mean;
}

Footprint footprint_of(Mode const& mode, double index) {
  Footprint f;
  f.centre = mode.origin;
  f.travel = mode.travel;
  f.index = index;
  Spot const e = spot(mode);
  Vec3 const one = e.axis, two = cross(mode.travel, e.axis);
  auto const curvature = [&](Vec3 a, Vec3 b) {
    double const ax = dot(a, mode.e1), ay = dot(a, mode.e2), bx = dot(b, mode.e1), by = dot(b, mode.e2);
    return ax * bx * mode.q11.real() + (ax * by + ay * bx) * mode.q12.real() + ay * by * mode.q22.real();
  };
  Astigmatism const a{one, two, e.major, e.minor, curvature(one, one), curvature(one, two), curvature(two, two)};
  // Slopes at the rim of the spot that are below 1e-9 of the divergence of the mode make no difference.
  double const least = 1e-9 * mode.wavelength / (pi * a.w1 * a.w1);
  if (a.w1 - a.w2 > 1e-9 * a.w1 || std::fabs(a.c11 - a.c22) > least + 1e-12 * std::fabs(a.c11) ||
      std::fabs(a.c12) > least) {
    f.profile = Profile::astigmatic;
    f.astigmatism = a;
    return f;
  }
  f.radius = a.w1;
  f.curvature = a.c11;
  return f;
}

std::vector<PhaseSensitivity> phase_sensitivities_of_way(World const& world, std::span<BeamStep const> way, double k) {
  std::vector<PhaseSensitivity> phase_sensitivities;
  for (BeamStep const& s : way)
    add_hit(phase_sensitivities, world, s.surface, s.point, k * (s.n_in * s.in - s.n_out * s.out),
            s.path_length / speed_of_light);
  return phase_sensitivities;
}

void add_lit_surface(World& world, std::uint32_t beam, double share, std::uint32_t mirror, BeamSpot const& spot,
                     std::span<BeamStep const> way) {
  Footprint f = footprint_of(spot.mode, spot.index);
  f.surface = spot.surface;
  double const alone = beside_rim(world.view(), spot.surface, spot.mode);  // of lines that screens had taken, too
  f.share = share * spot.power * (alone < 1 ? (1 - spot.clipped) / (1 - alone) : 1);
  f.polarisation = polarisation_of(spot.field);
  f.beam = beam;
  f.emits = scatters(world, spot.surface, spot.front);
  f.receives = false;
  world.add_footprint(f, {true, spot.path_length, phase_sensitivities_of_way(world, way), mirror, spot.order, alone});
}

void add_lit_screen(World& world, std::uint32_t beam, double share, std::uint32_t mirror, ScreenSpot const& spot,
                    std::span<BeamStep const> way) {
  constexpr double closer = 0.95;  // edges of stripes lie between azimuths too
  Screened const& screen = spot.screen;
  double const nearest = closer * screen.nearest;
  Footprint f = footprint_of(screen.mode, spot.index);
  f.surface = screen.surface;
  f.hollow = std::exp(-2 * nearest * nearest);
  f.share = share * spot.power * f.hollow * screen.share / screen.alone;
  f.backoff = screen.along;
  f.polarisation = polarisation_of(spot.field);
  f.beam = beam;
  f.emits = scatters(world, screen.surface, spot.front);
  f.receives = false;
  double const missed = std::max(0.0, 1 - screen.alone / f.hollow);
  world.add_footprint(f, {true, spot.path_length, phase_sensitivities_of_way(world, way), mirror, spot.order, missed});
}

std::vector<LitRow> lit_rows(World const& world) {
  WorldView const view = world.view();
  std::vector<LitRow> rows;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    bool const launched = std::ranges::find(world.spans, i, &NetworkSpan::footprint) != world.spans.end();
    if (f.free || launched) continue;
    Feed const& feed = world.feeds()[i];
    LitRow row{i, f.radius, f.radius};
    if (f.profile == Profile::astigmatic) {
      row.major = f.astigmatism.w1;
      row.minor = f.astigmatism.w2;
    }
    Crossing const met = view.cross(f.surface.value, {f.centre - f.backoff * f.travel, f.travel}, {});
    Vec3 const p = met.distance < infinity ? f.centre + (met.distance - f.backoff) * f.travel
                                           : view.project(f.surface, f.centre, met.piece);
    Vec3 const normal = view.normal(f.surface, p, met.piece);
    bool const known = met.distance < infinity || flat_rims(view, f.surface).size() == 1;
    row.incidence = known ? angle_between(dot(normal, f.travel) < 0 ? -f.travel : f.travel, normal) : not_a_number;
    row.scatters = scatters(world, f.surface, dot(normal, f.travel) < 0);
    bool const round = f.profile == Profile::gaussian;
    row.resolution = feed.propagated || round ? 1e-15 : 1.0 / (lines_tried * lines_tried);
    row.clipped = feed.propagated ? feed.clipped
                  : round
                      ? beside_rim(view, f.surface, circular_mode(p, f.travel, f.radius, f.curvature, world.wavelength))
                      : beside(view, f);
    rows.push_back(row);
  }
  return rows;
}

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double straight = 0.999;  // cosine of a rim that is taken as across the beam

// The mode whose intensity is the modulus of the field.
Mode modulus(Mode m) {
  for (auto* q : {&m.q11, &m.q12, &m.q22}) *q = {q->real(), 0.5 * q->imag()};
  return m;
}

// A circle, perhaps with teeth outwards, that the beam passes or whose inside it meets.
struct Circle {
  Vec3 centre, axis;
  double radius = 0, tooth_depth = 0;  // m, of the tips
  double mean(Mode const& mode) const { return BeamAperture::Round{centre, axis, radius, tooth_depth, mode}.clipped(); }
  // Mean of the modulus of the field over the rim, seen from the chief ray.
  double on_rim(Mode const& mode) const {
    constexpr int azimuths = 256;
    Frame const f = Frame::around(axis);
    FlatRim const inside{centre, f.e1, f.e2, axis, {radius, radius}, {}, false};
    BeamLines const lines(mode);
    double sum = 0;
    for (int i = 0; i < azimuths; ++i)
      for (Stripe const& s : inside.met(lines.origin, lines.towards(sincos_turn((i + 0.5) / azimuths)), lines.travel))
        sum += std::exp(-s.to * s.to);
    return sum / azimuths;
  }
};

// Where the chief ray crosses the plane of the circle.
double crossing(Circle const& c, Mode const& m) { return dot(c.centre - m.origin, c.axis) / dot(m.travel, c.axis); }

BeamInPlane in_plane(Mode const& m) {
  Spot const s = spot(m);
  return {std::sqrt(s.major * s.minor), 0.5 * (m.q11.real() + m.q22.real()), m.wavelength};
}
bool round_beam(Mode const& m) {
  double const size = std::abs(m.q11) * 1e-4;
  return std::abs(m.q12) < size && std::abs(m.q11 - m.q22) < size;
}

void measure(BeamAperture& a, Circle const& circle, Mode const& here) {
  Spot const s = spot(here);
  a.round = {circle.centre, circle.axis, circle.radius, circle.tooth_depth, here};
  a.w_major = s.major;
  a.w_minor = s.minor;
  double const cosine = std::min(1.0, std::fabs(dot(circle.axis, here.travel)));
  a.tilt = std::acos(cosine);
  a.at = in_plane(here);
  a.clipped = circle.mean(here);
  double const field = 1 - circle.mean(modulus(here));
  a.axis_far = field * field;
  a.ripple = 2 * circle.on_rim(here);
  a.across = round_beam(here) && cosine > straight;
  a.opening.radius = circle.radius + 0.5 * circle.tooth_depth;
  a.opening.tooth_height = circle.tooth_depth;
  a.opening.x = length(circle.centre - here.origin - dot(circle.centre - here.origin, here.travel) * here.travel);
}

// x across the beam points to the centre of the opening, or along e1 of the rim.
void lay_teeth(BeamAperture& a, InnerRim const& rim, Mode const& here) {
  Vec3 const o = rim.centre - here.origin, offset = o - dot(o, here.travel) * here.travel;
  Vec3 const x = length(offset) > 0 ? unit(offset) : rim.e1, y = cross(here.travel, x);
  Vec3 const tip = std::cos(rim.phase) * rim.e1 + std::sin(rim.phase) * rim.e2;
  a.opening.teeth = unsigned(rim.teeth);
  a.opening.phase = std::atan2(dot(tip, y), dot(tip, x));
}

// Of the surface that the chief ray meets.
std::optional<Circle> outer_rim(World const& world, SurfaceId id) {
  auto const rims = flat_rims(world.view(), id);
  if (rims.size() != 1 || rims[0].hole || rims[0].outer.sides != 0 || rims[0].outer.semi_x != rims[0].outer.semi_y)
    return {};
  return Circle{rims[0].centre, rims[0].axis, rims[0].outer.semi_x, 0};
}

struct Hole {
  Circle circle;
  std::optional<InnerRim> rim;  // of a ring
};
std::optional<Hole> round_hole(World const& world, SurfaceId id) {
  if (auto const rim = rim_of(world, id)) return Hole{{rim->centre, rim->axis, rim->radius, rim->tooth_depth}, rim};
  auto const flat = flat_rims(world.view(), id);
  if (flat.size() != 1 || !flat[0].hole || flat[0].inner.sides != 0 || flat[0].inner.semi_x != flat[0].inner.semi_y)
    return {};
  return Hole{{flat[0].centre, flat[0].axis, flat[0].inner.semi_x, 0}, {}};
}

// Round holes that the chief ray passes on a flight.
void add_holes(World const& world, std::uint32_t beam, Mode const& start, double flight, double before,
               std::vector<BeamAperture>& all) {
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    auto const hole = round_hole(world, {id});
    if (!hole || world.surfaces()[id].clear || std::fabs(dot(hole->circle.axis, start.travel)) < 1e-6) continue;
    double const z = crossing(hole->circle, start);
    Vec3 const p = start.origin + z * start.travel;
    if (!(z > 1e-9 && z < flight * (1 - 1e-9)) || length(p - hole->circle.centre) > hole->circle.radius) continue;
    Mode const here = propagated(start, z);
    BeamAperture a;
    a.beam = beam;
    a.group = world.surfaces()[id].group;
    a.surface = {id};
    a.along = before + z * world.wavelength / start.wavelength;
    measure(a, hole->circle, here);
    if (hole->rim) lay_teeth(a, *hole->rim, here);
    all.push_back(a);
  }
}

// Follows the main beam of one launch.
class Passed final : public BeamSink {
 public:
  Passed(World const& world, BeamLaunch const& launch, std::vector<BeamAperture>& all)
      : world_(world), launch_(launch), all_(all) {}

  void left(LeavingBeam const& beam, std::span<BeamStep const> way) override {
    flight_ = beam.mode;
    before_ = beam.path_length;
    main_way_ = comes_back() && beam.field.power() > 0.5;
    if (way.empty() || way.back().spot != last_spot_ || last_row_ >= all_.size()) return;
    BeamAperture& a = all_[last_row_];  // the beam as it leaves
    a.reflected = way.back().event == Event::reflect;
    a.across = a.across && round_beam(beam.mode);
    a.at = in_plane(beam.mode);
    last_row_ = all_.size();
  }
  void screened(ScreenSpot const& spot, std::span<BeamStep const>) override { touched_.push_back(spot); }
  void arrived(BeamSpot const& spot, std::uint32_t number, std::span<BeamStep const> way) override {
    bool const first = way.empty() && launch_.arrives_at.valid();
    if (!first) fly(length(spot.mode.origin - flight_.origin));
    last_spot_ = number;
    last_row_ = std::numeric_limits<std::size_t>::max();
    if (first && !launch_.cavity.empty()) return;  // the mirror of the cavity itself
    BeamAperture a = row(spot.surface, spot.path_length);
    bool const carries_mode = std::ranges::find(launch_.cavity, spot.surface) != launch_.cavity.end();
    a.main_way = comes_back() && !carries_mode && spot.power > 0.5;
    if (auto const rim = outer_rim(world_, spot.surface))
      measure(a, *rim, spot.mode);
    else
      rough(a, spot.mode, beside_rim(world_.view(), spot.surface, spot.mode), false);
    if (std::isnan(a.ripple) && !(a.clipped > 0)) return;
    last_row_ = all_.size();
    all_.push_back(a);
  }
  void ended(BeamEnd how, BeamSpot const*, LeavingBeam const&, std::span<BeamStep const>) override {
    if (how == BeamEnd::escaped) fly(infinity);
  }

 private:
  // Light of the network behind an input mirror does, what an end mirror transmits does not.
  bool comes_back() const { return launch_.cavity.empty() || launch_.span; }
  BeamAperture row(SurfaceId id, double along) const {
    BeamAperture a;
    a.beam = launch_.beam;
    a.group = world_.surfaces()[id.value].group;
    a.surface = id;
    a.along = along;
    return a;
  }
  void rough(BeamAperture& a, Mode const& here, double share, bool screen) const {
    Spot const s = spot(here);
    a.w_major = s.major;
    a.w_minor = s.minor;
    a.at = in_plane(here);
    a.clipped = share;
    a.axis_far = a.ripple = a.tilt = a.opening.radius = a.opening.x = unknown;
    auto const rims = flat_rims(world_.view(), a.surface);
    if (rims.size() == 1) a.flat = {rims[0], here, screen};
  }
  void fly(double flight_length) {
    std::vector<BeamAperture> found;
    add_holes(world_, launch_.beam, flight_, flight_length, before_, found);
    for (ScreenSpot const& s : touched_) {
      if (std::ranges::any_of(found, [&](auto const& a) { return a.surface == s.screen.surface; })) continue;
      BeamAperture a = row(s.screen.surface, s.path_length);
      rough(a, s.screen.mode, s.screen.alone, true);
      found.push_back(a);
    }
    touched_.clear();
    for (BeamAperture& a : found) a.main_way = main_way_;
    std::ranges::sort(found, [](auto const& a, auto const& b) { return a.along < b.along; });
    all_.insert(all_.end(), found.begin(), found.end());
  }

  World const& world_;
  BeamLaunch const& launch_;
  std::vector<BeamAperture>& all_;
  Mode flight_;
  double before_ = 0;
  bool main_way_ = false;
  std::vector<ScreenSpot> touched_;
  std::uint32_t last_spot_ = BeamSpot::none;
  std::size_t last_row_ = std::numeric_limits<std::size_t>::max();
};

// The mirror of a cavity reverses the wavefront of its own mode.
void add_mirror(World const& world, Footprint const& f, double along, std::vector<BeamAperture>& all) {
  auto const rim = outer_rim(world, f.surface);
  if (!rim) return;
  BeamAperture a;
  a.beam = f.beam;
  a.group = world.surfaces()[f.surface.value].group;
  a.surface = f.surface;
  a.reflected = true;
  a.standing = true;
  a.along = along;
  measure(a, *rim, circular_mode(f.centre, f.travel, f.radius, f.curvature, world.wavelength));
  a.at.curvature = -f.curvature;
  all.push_back(a);
}

// The mode between the mirrors, from the first.
void add_cavity(World const& world, Footprint const& one, Footprint const& two, std::vector<BeamAperture>& all) {
  double const span = length(two.centre - one.centre);
  add_mirror(world, one, 0, all);
  std::size_t const first = all.size();
  add_holes(world, one.beam, circular_mode(one.centre, -one.travel, one.radius, -one.curvature, world.wavelength), span,
            0, all);
  for (std::size_t i = first; i < all.size(); ++i) all[i].standing = true;
  add_mirror(world, two, span, all);
}

// The launched beam: of a cavity, the part transmitted by its mirror.
class FirstPower final : public BeamSink {
 public:
  void left(LeavingBeam const& beam, std::span<BeamStep const>) override {
    power = std::max(power, first_ ? beam.field.power() : 0);
    first_ = false;
  }
  double power = 0;

 private:
  bool first_ = true;
};
// Down to a part of that the main beam is followed; splitters in a loop would multiply it without limit.
TreeLimits main_limits(World const& world, BeamLaunch const& launch, double part) {
  FirstPower first;
  grow_tree(world, launch, {0, 0, 1}, first);
  return {part * first.power, 0};
}

class Losses final : public BeamSink {
 public:
  Losses(BeamLaunch const& launch, double least, std::vector<MainLoss>& all)
      : launch_(launch), least_(least), all_(all) {}
  void arrived(BeamSpot const& spot, std::uint32_t, std::span<BeamStep const> way) override {
    if (way.empty() && launch_.arrives_at.valid()) return;  // the spot is stated
    note(spot.surface, spot.clipped, true);
  }
  void screened(ScreenSpot const& spot, std::span<BeamStep const>) override {
    note(spot.screen.surface, spot.screen.share, false);
  }

 private:
  void note(SurfaceId surface, double share, bool beside) {
    if (share > least_) all_.push_back({launch_.beam, surface, share, beside});
  }
  BeamLaunch const& launch_;
  double least_;
  std::vector<MainLoss>& all_;
};

}  // namespace

double BeamAperture::Round::clipped() const {
  auto const at = [&](double r) { return clipped_share(Aperture{centre, axis, r}, mode); };
  if (tooth_depth == 0) return at(radius);
  using Rule = boost::math::quadrature::gauss<double, 20>;
  return Rule::integrate(at, radius, radius + tooth_depth) / tooth_depth;
}

std::vector<BeamAperture> apertures_of(World const& world) {
  std::vector<BeamAperture> all;
  auto const& spots = world.footprints();
  for (std::size_t i = 1; i < spots.size(); ++i)
    if (spots[i - 1].standing && spots[i].standing && spots[i - 1].beam == spots[i].beam)
      add_cavity(world, spots[i - 1], spots[i], all);
  for (BeamLaunch const& launch : launches(world)) {
    Passed passed(world, launch, all);
    grow_tree(world, launch, main_limits(world, launch, 1e-5), passed);
  }
  std::ranges::stable_sort(all, [](auto const& a, auto const& b) { return a.beam < b.beam; });
  return all;
}

double paraxial_beyond(BeamAperture const& a) {
  return std::cbrt(2 * pi / a.at.wavelength * std::pow(a.opening.radius, 4) / 8);
}

ApertureProfile profile_behind(BeamAperture const& a, std::string const& name, double z, std::size_t points) {
  double const size = 1 / std::abs(free_field(a.at, z, 0, 0));  // w there over w at the rim
  double const reach = 2 * a.at.w * size;
  ApertureProfile out;
  for (std::size_t i = 0; i < points; ++i) {
    double const x = reach * (2 * double(i) / double(points - 1) - 1);
    out.x.push_back(x);
    try {
      out.with.push_back(std::norm(field_behind(a.at, a.opening, z, x, 0)));
    } catch (NumericalError const&) {
      throw NumericalError(fmt::format(
          "the field {:g} m behind '{}' at x = {:g} m cannot be integrated to 1e-3\n  choose a larger distance", z,
          name, x));
    }
    out.without.push_back(std::norm(free_field(a.at, z, x, 0)));
  }
  return out;
}

std::vector<MainLoss> main_losses(World const& world, double least) {
  std::vector<MainLoss> all;
  for (BeamLaunch const& launch : launches(world)) {
    Losses losses(launch, least, all);
    grow_tree(world, launch, main_limits(world, launch, 0.1), losses);
  }
  return all;
}

}  // namespace straytrace::world
