// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_cavity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "optics/scatter/mixture.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/arm/irradiance.hpp"
#include "wave/heights/defects.hpp"
#include "world/model/vertex.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

struct Spots {
  std::array<Footprint const*, 2> of{};
};

Spots spots_of(World const& world, WaveSettings const& settings) {
  Spots spots;
  for (Footprint const& f : world.footprints())
    if (f.standing && f.beam == settings.beam)
      for (std::size_t i : {0, 1})
        if (f.surface == settings.mirrors[i].surface) spots.of[i] = &f;
  return spots;
}

CavityFrame frame_of(Vec3 one, Vec3 two) {
  CavityFrame frame;
  frame.origin = one;
  frame.z = unit(two - one);
  // x follows that of the scene, so that levers have its axes where the arm runs along z.
  Vec3 const across = std::fabs(frame.z.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  frame.x = unit(across - dot(across, frame.z) * frame.z);
  frame.y = cross(frame.z, frame.x);
  return frame;
}

ArmMirror mirror_of(World const& world, Footprint const& spot) {
  auto const footprint = std::uint32_t(&spot - world.footprints().data());
  ArmMirror mirror{spot.surface, 0, 0, spot.radius, 0, 0, spot.travel, footprint};
  world.view().shapes.visit(world.surfaces()[spot.surface.value].shape, [&](auto const& s) {
    using Shape = std::decay_t<decltype(s)>;
    if constexpr (std::is_same_v<Shape, Cap> || std::is_same_v<Shape, Disk>) mirror.radius = s.outer_radius;
    if constexpr (std::is_same_v<Shape, Cap>) mirror.curvature = s.curvature;
  });
  return mirror;
}

// Seen from a mirror at this distance, the farthest point of a rim. rad
double angle_of(ArmRim const& rim, double distance) {
  return std::atan2(rim.rim.radius + std::hypot(rim.centre.x, rim.centre.y), distance);
}

std::vector<ArmRim> rims_of(World const& world, WaveSettings const& settings, CavityFrame const& frame, double length,
                            std::vector<ArmProblem>& problems) {
  std::vector<ArmRim> rims;
  std::size_t outside = 0;
  for (std::uint32_t id = 0; id < world.surfaces().size(); ++id) {
    if (std::ranges::find(settings.groups, world.name_of({id})) == settings.groups.end()) continue;
    auto const rim = rim_of(world, {id});
    if (!rim) continue;
    ArmRim arm{{id}, *rim, frame.to_local(rim->centre)};
    if (!(arm.centre.z > 0 && arm.centre.z < length)) {
      ++outside;
      continue;
    }
    arm.angle1 = angle_of(arm, arm.centre.z);
    arm.angle2 = angle_of(arm, length - arm.centre.z);
    rims.push_back(arm);
  }
  if (outside > 0)
    problems.push_back(
        {{"baffles"},
         fmt::format("{} of the {} inner edges in 'baffles' are not between the mirrors; they are left out", outside,
                     outside + rims.size()),
         "name the baffles between the mirrors",
         Severity::warning});
  std::ranges::sort(rims, {}, [](ArmRim const& r) { return r.centre.z; });
  return rims;
}

// The angle at which the far mirror sees the rims next to the near one, and some more; and twenty angles of divergence
// of the mode.
double chosen_crossover(std::array<ArmMirror, 2> const& mirrors, std::vector<ArmRim> const& rims, double length,
                        double wavelength) {
  double angle = 0;
  for (ArmMirror const& m : mirrors) angle = std::fmax(angle, 20 * wavelength / (pi * m.spot));
  for (ArmRim const& r : rims) angle = std::fmax(angle, 1.5 * r.rim.radius / length);
  return angle;
}

// eq. W.2, in steps of a factor 1.2 of the angle.
double scattered_beyond(std::function<double(double)> const& brdf, double crossover) {
  GaussPoints const gauss(8);
  double sum = 0;
  for (double from = crossover; from < pi / 2;) {
    double const to = std::fmin(1.2 * from, pi / 2);
    for (std::size_t i = 0; i < gauss.at.size(); ++i) {
      double const angle = from + (to - from) * gauss.at[i];
      sum += (to - from) * gauss.weight[i] * brdf(angle) * std::cos(angle) * 2 * pi * std::sin(angle);
    }
    from = to;
  }
  return sum;
}

void add(std::vector<double>& heights, std::vector<double> const& more) {
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] += more[i];
}

Vertex centre_of(World const& world, ArmMirror const& mirror, Vec3 travel) {
  WorldView const view = world.view();
  Vec3 const centre = view.shapes.visit(world.surfaces()[mirror.surface.value].shape,
                                        [](auto const& s) -> Vec3 { return s.reference(); });
  return make_vertex(view, mirror.surface, centre, travel);
}

}  // namespace

double height_rms(std::vector<double> const& heights) {
  double sum = 0;
  for (double h : heights) sum += h * h;
  return heights.empty() ? 0 : std::sqrt(sum / double(heights.size()));
}

MirrorBrdf::MirrorBrdf(World const& world, ArmMirror const& mirror, Vec3 travel)
    : view_(world.view()), optic_(*centre_of(world, mirror, travel).optic) {
  optic_.crossover = 0;
}

double MirrorBrdf::operator()(double angle) const {
  return scatter_eval(view_.laws, optic_, {0, 0, 1}, {std::sin(angle), 0, std::cos(angle)});
}

std::vector<std::function<double(double)>> mirror_models(World const& world, ArmMirror const& mirror) {
  std::vector<std::function<double(double)>> models;
  WorldView const view = world.view();
  Vertex const vertex = centre_of(world, mirror, mirror.travel);
  for (int i = 0; i < vertex.optic->laws; ++i)
    if (!vertex.optic->through[i])
      models.emplace_back([view, optic = vertex.optic, i](double angle) {
        Vec3 const out{std::sin(angle), 0, std::cos(angle)};
        return visit_law(view.laws, *optic, i, [&](auto const& l) { return l.eval({0, 0, 1}, out); });
      });
  return models;
}

namespace {

bool has_heights(WaveSettings::Mirror const& settings) {
  return settings.heights != WaveSettings::Heights::none || !settings.absorbers.empty() || !settings.ripples.empty();
}

// Heights below the crossover angle: as measured, and beyond the largest frequency of the map as the BSDF of the mirror
// yields; without a map as the BSDF alone. `number`: of the mirror, and 2 more for each draw.
std::vector<double> figure_of(World const& world, WaveSettings::Mirror const& settings, ArmMirror const& mirror,
                              ArmCavity const& arm, std::uint32_t number, RandomHeights random) {
  Grid const& grid = arm.cavity.grid;
  if (settings.heights == WaveSettings::Heights::none) return std::vector<double>(grid.size());
  double const wavelength = arm.cavity.wavelength, highest = arm.crossover / wavelength;
  std::optional<HeightMap> map = arm.maps[number % 2];
  MirrorBrdf const brdf(world, mirror, mirror.travel);
  auto const spectrum = [&](double f) { return height_spectrum(brdf(f * wavelength), wavelength); };
  std::vector<double> heights(grid.size());
  if (random == RandomHeights::drawn)
    heights = synthesise(spectrum, grid, map ? map->nyquist() : 0, highest, settings.seed, number);
  if (!map) return heights;
  fill_holes(*map);
  add(heights, resample(*map, grid, highest));
  return heights;
}

std::vector<double> heights_of(World const& world, WaveSettings::Mirror const& settings, ArmMirror const& mirror,
                               ArmCavity const& arm, std::uint32_t number, RandomHeights random) {
  if (!has_heights(settings)) return {};
  std::vector<double> heights = figure_of(world, settings, mirror, arm, number, random);
  Grid const& grid = arm.cavity.grid;
  double const highest = arm.crossover / arm.cavity.wavelength;
  for (WaveSettings::Absorber const& a : settings.absorbers)
    add(heights, heights_of_absorber(a, grid, mirror.radius, highest));
  for (WaveSettings::Ripple const& r : settings.ripples) add(heights, heights_of_ripple(r, grid));
  return heights;
}

// Without heights. A mirror that is shifted leans by the slope that its curvature has at the axis.
WaveMirror aligned_as(WaveSettings::Mirror const& settings, ArmMirror const& mirror) {
  auto const& [x, y] = settings.shift;
  return {mirror.curvature,
          {mirror.radius, x, y},
          settings.tilt[0] + x * mirror.curvature,
          settings.tilt[1] + y * mirror.curvature,
          {},
          0};
}

// Mirrors, edges and crossover angle, without fields.
ArmCavity outline_of(World const& world, WaveSettings const& settings, Spots const& spots) {
  ArmCavity arm;
  arm.frame = frame_of(spots.of[0]->centre, spots.of[1]->centre);
  arm.cavity.wavelength = world.wavelength;
  arm.cavity.length = length(spots.of[1]->centre - spots.of[0]->centre);
  for (std::size_t i : {0, 1}) arm.mirrors[i] = mirror_of(world, *spots.of[i]);
  arm.rims = rims_of(world, settings, arm.frame, arm.cavity.length, arm.problems);
  arm.crossover =
      settings.crossover.value_or(chosen_crossover(arm.mirrors, arm.rims, arm.cavity.length, world.wavelength));
  for (ArmRim const& r : arm.rims)
    arm.cavity.baffles.push_back({r.centre.z, {r.rim.radius + r.rim.tooth_depth / 2, r.centre.x, r.centre.y}});
  arm.cavity.mirror1 = aligned_as(settings.mirrors[0], arm.mirrors[0]);
  arm.cavity.mirror2 = aligned_as(settings.mirrors[1], arm.mirrors[1]);
  place_diodes(settings, arm);
  for (ArmRim& r : arm.rims) r.in_band = r.angle1 <= arm.crossover && r.angle2 <= arm.crossover;
  return arm;
}

std::array<std::vector<double>, 2> heights_of_both(World const& world, WaveSettings const& settings,
                                                   ArmCavity const& arm, std::uint32_t draw, RandomHeights random) {
  std::array<std::vector<double>, 2> heights;
  for (std::uint32_t i : {0u, 1u}) {
    heights[i] = heights_of(world, settings.mirrors[i], arm.mirrors[i], arm, i + 2 * draw, random);
    shift(heights[i], arm.cavity.grid, settings.mirrors[i].shift);
  }
  return heights;
}

}  // namespace

std::array<std::vector<double>, 2> drawn_heights(World const& world, WaveSettings const& settings, ArmCavity const& arm,
                                                 std::uint32_t draw) {
  return heights_of_both(world, settings, arm, draw, RandomHeights::drawn);
}

double crossover_angle(World const& world, WaveSettings const& settings) {
  return outline_of(world, settings, spots_of(world, settings)).crossover;
}

double scattered_within(World const& world, ArmMirror const& mirror, double crossover) {
  Optic const& optic = *centre_of(world, mirror, mirror.travel).optic;
  double all = 0;
  for (int law = 0; law < optic.laws; ++law)
    if (!optic.through[law]) all += law_albedo(world.view().laws, optic, law, 1.0);
  double const beyond = scattered_beyond(MirrorBrdf(world, mirror, mirror.travel), crossover);
  return std::fmax(all - beyond, 0.0);
}

void begin_rays_at_crossover(World& world) {
  ArmCavity const arm = outline_of(world, world.wave, spots_of(world, world.wave));
  for (ArmMirror const& mirror : arm.mirrors)
    world.begin_scatter_at(mirror.surface, centre_of(world, mirror, mirror.travel).front, arm.crossover,
                           scattered_within(world, mirror, arm.crossover));
}

ArmCavity planned_arm(World const& world, WaveSettings const& settings) {
  ArmCavity arm = outline_of(world, settings, spots_of(world, settings));
  for (std::size_t i : {0, 1}) {
    ArmMirror& mirror = arm.mirrors[i];
    mirror.scattered = scattered_beyond(MirrorBrdf(world, mirror, mirror.travel), arm.crossover);
    for (WaveSettings::Absorber const& a : settings.mirrors[i].absorbers)
      mirror.scattered += scattered_by_absorber(a, mirror.spot, world.wavelength, arm.crossover);
  }
  choose_grid(arm, settings);
  if (check_shifts(world, settings, arm)) {
    check_rims(world, settings, arm);
    check_alignment(world, arm);
    check_grid(world, settings, arm);
    check_input(world, settings, arm);
  }
  check_mirrors(world, settings, arm);
  return arm;
}

void throw_errors(std::vector<ArmProblem> const& problems) {
  std::vector<InputError> errors;
  for (ArmProblem const& p : problems)
    if (p.severity == Severity::error) errors.emplace_back(p.what, p.remedy);
  throw_all(errors);
}

ArmCavity arm_cavity(World const& world, WaveSettings const& settings, ArmCavity planned, RandomHeights random) {
  throw_errors(planned.problems);
  ArmCavity arm = std::move(planned);
  auto heights = heights_of_both(world, settings, arm, 0, random);
  for (std::size_t i : {0, 1}) {
    ArmMirror& mirror = arm.mirrors[i];
    mirror.roughness = height_rms(heights[i]);
    WaveMirror& wave = i == 0 ? arm.cavity.mirror1 : arm.cavity.mirror2;
    wave.height = std::move(heights[i]);
    wave.scattered = mirror.scattered;
  }
  return arm;
}

RimCurve curve_of(ArmCavity const& arm, ArmRim const& rim, Vec3 displacement, double wider) {
  double const length = 2 * pi * rim.rim.radius;
  int count = points_along(length, arm.cavity.grid.pitch());
  if (rim.rim.tooth_depth > 0) {  // whole flanks, with two points on each at least
    int const flanks = std::max(1, int(2 * rim.rim.teeth));
    count = flanks * std::max(2, count / flanks + 1);
  }
  double const first = rim.rim.tooth_depth > 0 ? rim.rim.phase : 0;
  bool const with_axis = dot(cross(rim.rim.e1, rim.rim.e2), arm.frame.z) > 0;
  std::vector<Vec3> corners;
  for (int i = 0; i <= count; ++i) {
    double const azimuth = first + (with_axis ? 1 : -1) * 2 * pi * i / count;
    Vec3 const p = arm.frame.to_local(rim_point(rim.rim, azimuth));
    Vec3 const out = unit(Vec3{p.x - rim.centre.x, p.y - rim.centre.y, 0});
    corners.push_back(p + displacement + wider * out);
  }
  RimCurve curve{{}, rim.centre + displacement};
  // Between the corners of a polygon: teeth are straight, and a round rim is one to second order.
  for (int i = 0; i < count; ++i) {
    Vec3 const a = corners[std::size_t(i)], b = corners[std::size_t(i) + 1];
    curve.points.push_back({0.5 * (a + b), b - a});
  }
  return curve;
}

}  // namespace straytrace::wave
