// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unistd.h>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "wave/heights/defects.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

constexpr int most_for_edges = 2048;      // that light at edges alone makes the program choose
constexpr double largest_tilt = 0.1;      // rad: the opening across the beam is half a per cent narrower
constexpr int fewest_pitches = 8;         // of a radius of an opening
constexpr double largest_shift = 0.2;     // of a speckled rim, over its radius
constexpr double nearest_in_spots = 1.5;  // of a speckled rim from the axis: 1 % of the power lies beyond
constexpr double clear_in_spots = 3.5;    // 2e-11 lie beyond
constexpr double entered = 0.99;          // of the input beam; less is worth a warning
constexpr double hardly_entered = 0.01;

// 1/e^2 radius of the mode at a place between the mirrors, from its radius and curvature on mirror 1.
double mode_radius(ArmCavity const& arm, double z) {
  double const w = arm.mirrors[0].spot, rayleigh = pi * w * w / arm.cavity.wavelength;
  return w * std::hypot(1 - z * arm.mirrors[0].curvature, z / rayleigh);
}

// m; of the centre of an edge from the axis of the mode, which misaligned mirrors move (eq. W.23).
double off_axis(ArmCavity const& arm, ArmRim const& rim) {
  CavityAxis const axis = axis_of(arm.cavity);
  double const along = rim.centre.z / arm.cavity.length;
  return std::hypot(rim.centre.x - axis.x1 - along * (axis.x2 - axis.x1),
                    rim.centre.y - axis.y1 - along * (axis.y2 - axis.y1));
}

// rad; of an opening against the plane across the beam.
double tilt_of(ArmCavity const& arm, ArmRim const& rim) {
  return std::acos(std::fmin(1.0, std::fabs(dot(rim.rim.axis, arm.frame.z))));
}

// Of the nearest point of an edge from the axis of the mode, in radii of the mode there; below 0: beyond the axis.
double radii_from_axis(ArmCavity const& arm, ArmRim const& rim) {
  return (rim.rim.radius - off_axis(arm, rim)) / mode_radius(arm, rim.centre.z);
}

using Rims = std::vector<ArmRim const*>;

// "the inner edge of 'a' at 1 m", or of several: the first ones and a count.
std::string where(World const& world, Rims const& rims) {
  constexpr std::size_t named = 3;
  std::string text = rims.size() > 1 ? "the inner edges of " : "the inner edge of ";
  std::size_t const shown = rims.size() > named + 1 ? named : rims.size();
  for (std::size_t i = 0; i < shown; ++i)
    text += fmt::format("{}'{}' at {:.6g} m",
                        i == 0                 ? ""
                        : i + 1 == rims.size() ? " and "
                                               : ", ",
                        world.name_of(rims[i]->surface), rims[i]->centre.z);
  return shown < rims.size() ? fmt::format("{} and {} others", text, rims.size() - shown) : text;
}

// Edges beyond the crossover angle that eq. W.22 does not describe: both of its waves are speckle about a centred edge,
// without direct light of the mode.
struct UnlikeSpeckle {
  Rims in_mode, off_axis, next_to_mode;
};

UnlikeSpeckle unlike_speckle(ArmCavity const& arm) {
  UnlikeSpeckle found;
  for (ArmRim const& rim : arm.rims) {
    if (rim.in_band || tilt_of(arm, rim) > largest_tilt) continue;
    double const shift = off_axis(arm, rim), spots = radii_from_axis(arm, rim);
    if (spots < nearest_in_spots)
      found.in_mode.push_back(&rim);
    else if (shift > largest_shift * rim.rim.radius)
      found.off_axis.push_back(&rim);
    else if (spots < clear_in_spots)
      found.next_to_mode.push_back(&rim);
  }
  return found;
}

// One problem for all of these edges. `verb`: of one and of several of them.
void tell_of_edges(World const& world, ArmCavity& arm, Rims const& rims, std::array<char const*, 2> verb,
                   std::string const& what, Severity severity = Severity::error) {
  if (rims.empty()) return;
  double angle = 0;
  for (ArmRim const* rim : rims) angle = std::fmax(angle, std::fmax(rim->angle1, rim->angle2));
  arm.problems.push_back(
      {{"baffles"},
       fmt::format("{} {} {}", where(world, rims), verb[rims.size() > 1 ? 1 : 0], what),
       fmt::format("let the grid solve {} with a 'crossover' of {:.4g} urad or more, or remove {} from 'baffles'",
                   rims.size() > 1 ? "them" : "it", 1e6 * angle, rims.size() > 1 ? "them" : "it"),
       severity,
       {},
       severity == Severity::warning});
}

void check_speckled(World const& world, ArmCavity& arm) {
  UnlikeSpeckle const found = unlike_speckle(arm);
  auto const nearest = [&](Rims const& rims) {
    double least = infinity;
    for (ArmRim const* rim : rims) least = std::fmin(least, radii_from_axis(arm, *rim));
    return fmt::format("{}{}",
                       least > 0 ? fmt::format("within {:.2g} radii of the mode from its axis", least)
                                 : std::string("across the axis of the mode"),
                       rims.size() > 1 ? " at the nearest" : "");
  };
  constexpr std::array comes{"comes", "come"};
  tell_of_edges(world, arm, found.in_mode, comes,
                nearest(found.in_mode) +
                    ": light of the mode itself meets the edge, which the mean over speckle (eq. W.22) leaves out");
  double farthest = 0;
  for (ArmRim const* rim : found.off_axis) farthest = std::fmax(farthest, off_axis(arm, *rim));
  tell_of_edges(world, arm, found.off_axis, {"is", "are up to"},
                fmt::format("{:.3g} m off the axis of the cavity, while the mean over speckle (eq. W.22) is that of a "
                            "centred edge",
                            farthest));
  tell_of_edges(
      world, arm, found.next_to_mode, comes,
      nearest(found.next_to_mode) + ": the mean over speckle (eq. W.22) leaves out the light of the mode itself there",
      Severity::warning);
}

void check_tolerance(WaveSettings const& settings, ArmCavity& arm) {
  if (!settings.tolerance.any()) return;
  double smallest = infinity;
  for (ArmRim const& rim : arm.rims)
    if (rim.in_band) smallest = std::fmin(smallest, rim.rim.radius);
  if (!(smallest < infinity)) {
    arm.problems.push_back({{"tolerance"},
                            "'tolerance' has no effect: both mirrors see no inner edge within the crossover angle",
                            "raise 'crossover', or remove 'tolerance'",
                            Severity::warning});
    return;
  }
  for (auto const& [key, size] :
       {std::pair{"radius", settings.tolerance.radius}, {"centre", settings.tolerance.centre}})
    if (size > 0.1 * smallest)
      arm.problems.push_back(
          {{"tolerance", key},
           fmt::format("a tolerance of {:.3g} m is too large for an inner edge of radius {:.3g} m", size, smallest),
           fmt::format("state one standard deviation of at most {:.3g} m", 0.1 * smallest)});
}

struct LegReach {
  double length, reach;  // m; sum of the radii of both ends
};
// Between neighbouring openings, with the photodiodes around them; first that from mirror to mirror, which the search
// for the mode starts with.
std::vector<LegReach> legs_of(ArmCavity const& arm) {
  struct End {
    double z, opening, lit;  // m
  };
  WaveCavity const& c = arm.cavity;
  auto const reach = [](RoundHole const& hole) { return hole.radius + std::hypot(hole.x, hole.y); };
  double const r1 = reach(c.mirror1.outline), r2 = reach(c.mirror2.outline);
  std::vector<End> ends{{0, r1, std::fmax(r1, c.mirror1.lit)}};
  for (std::size_t i = 0; i < arm.rims.size(); ++i) {
    ArmRim const& r = arm.rims[i];
    double const opening = r.rim.radius + std::hypot(r.centre.x, r.centre.y);
    ends.push_back({r.centre.z, opening, std::fmax(opening, c.baffles[i].lit)});
  }
  ends.push_back({c.length, r2, std::fmax(r2, c.mirror2.lit)});
  auto const leg = [](End const& a, End const& b) -> LegReach {
    return {b.z - a.z, std::fmax(a.opening + b.lit, a.lit + b.opening)};
  };
  std::vector<LegReach> legs{leg(ends.front(), ends.back())};
  for (std::size_t i = 1; i < ends.size(); ++i) legs.push_back(leg(ends[i - 1], ends[i]));
  return legs;
}

// m; a window in which light that reaches both ends of each leg, and `widths` of Fresnel diffraction beyond, does not
// wrap (eq. W.5, W.6).
double window_for(ArmCavity const& arm, double widths) {
  double window = 0;
  for (LegReach const& leg : legs_of(arm))
    window = std::fmax(window, 2 * leg.reach + widths * std::sqrt(arm.cavity.wavelength * leg.length));
  return window;
}

// rad; on top of the slopes of the mode (theory, Mirrors, legs and masks).
double slope_of_mode(ArmCavity const& arm) {
  double slope = 0;
  for (ArmMirror const& m : arm.mirrors) slope = std::fmax(slope, 2.5 * m.spot * std::fabs(m.curvature));
  CavityAxis const axis = axis_of(arm.cavity);
  return slope + std::hypot(axis.x2 - axis.x1, axis.y2 - axis.y1) / arm.cavity.length;
}

// rad; the largest angle that the grid must carry well.
double wanted_angle(ArmCavity const& arm) { return arm.crossover + slope_of_mode(arm); }

// Points along one side of a window; more than the largest number where no grid suffices.
int needed_points(ArmCavity const& arm, double window) {
  double const points = std::ceil(2 * window * wanted_angle(arm) / (0.6 * arm.cavity.wavelength));
  return int(std::fmin(points, most_points + 1));
}

// rad; the largest angle of eq. W.5 between neighbouring baffles that both clip the mode: light that the edge of one
// diffracts meets that of the other. 0: no such baffles.
double angle_between_edges(ArmCavity const& arm) {
  auto const opening = [](ArmRim const& r) { return r.rim.radius + std::hypot(r.centre.x, r.centre.y); };
  double angle = 0;
  for (std::size_t i = 1; i < arm.rims.size(); ++i) {
    ArmRim const &one = arm.rims[i - 1], &two = arm.rims[i];
    double const leg = two.centre.z - one.centre.z;
    if (leg > 0 && !clear_of_mode(arm, one) && !clear_of_mode(arm, two))
      angle = std::fmax(angle, (opening(one) + opening(two)) / leg + std::sqrt(arm.cavity.wavelength / leg));
  }
  return angle;
}

// rad; the largest angle between the outline of a mirror and an edge that the grid lights with it (eq. W.64). 0: no
// such edges, or light of the mode itself meets them.
double angle_from_outlines(ArmCavity const& arm) {
  double angle = 0;
  for (ArmRim const& rim : arm.rims) {
    if (!clear_of_mode(arm, rim)) continue;
    double const opening = rim.rim.radius + std::hypot(rim.centre.x, rim.centre.y);
    if (rim.angle1 <= arm.crossover) angle = std::fmax(angle, (arm.mirrors[0].radius + opening) / rim.centre.z);
    if (rim.angle2 <= arm.crossover)
      angle = std::fmax(angle, (arm.mirrors[1].radius + opening) / (arm.cavity.length - rim.centre.z));
  }
  return angle;
}

// For light at this angle.
int points_for(ArmCavity const& arm, double angle) {
  return int(std::fmin(std::ceil(2 * arm.cavity.grid.window * angle / (0.6 * arm.cavity.wavelength)), 1e9));
}

// A grid with fewer is wrong by some parts in a thousand of the loss.
int points_for_edges(ArmCavity const& arm) { return points_for(arm, angle_between_edges(arm)); }

void check_edges_in_grid(ArmCavity& arm) {
  int const needed = points_for_edges(arm);
  if (arm.cavity.grid.points >= needed) return;
  int const allowed = allowed_points(needed);
  arm.problems.push_back(
      {{"grid", "points"},
       fmt::format("light diffracted from baffle to baffle reaches {:.3g} urad where they clip the mode; a grid of {} "
                   "points carries {:.3g} urad of it: the loss may be wrong by some parts in a thousand",
                   1e6 * angle_between_edges(arm), arm.cavity.grid.points,
                   0.6e6 * arm.cavity.grid.largest_angle(arm.cavity.wavelength)),
       allowed > 0 ? fmt::format("state 'points: {}' in 'grid', or compare with other 'points'", allowed)
                   : "compare with other 'points' in 'grid'",
       Severity::warning});
}

void check_points(WaveSettings const& settings, ArmCavity& arm) {
  Grid const& grid = arm.cavity.grid;
  if (grid.points >= needed_points(arm, grid.window)) return;
  double const slope = slope_of_mode(arm), carried = 0.6 * grid.largest_angle(arm.cavity.wavelength) - slope;
  int const allowed = allowed_points(needed_points(arm, grid.window));
  double const most = 0.6 * most_points * arm.cavity.wavelength / (2 * grid.window) - slope;
  std::string const smaller =
      carried > 0 ? fmt::format(", or a 'crossover' of at most {:.4g} urad", 1e6 * carried) : "";
  bool const stated = settings.points > 0;
  arm.problems.push_back(
      {stated ? std::vector<std::string>{"grid", "points"} : std::vector<std::string>{"crossover"},
       fmt::format("a grid of {} points over {:.4g} m does not carry a crossover angle of {:.4g} urad", grid.points,
                   grid.window, 1e6 * arm.crossover),
       allowed > 0 ? fmt::format("state 'points: {}' in 'grid'{}", allowed, smaller)
                   : fmt::format("choose a 'crossover' of at most {:.4g} urad, which {} points carry", 1e6 * most,
                                 most_points)});
}

void check_memory(ArmCavity& arm) {
  double const needed = needed_memory(arm), there = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  if (needed > 0.9 * there)
    arm.problems.push_back(
        {{"grid", "points"},
         fmt::format("a grid of {} points needs some {:.2g} GB of memory; this machine has {:.2g} GB",
                     arm.cavity.grid.points, 1e-9 * needed, 1e-9 * there),
         "choose fewer points, with a smaller 'crossover' or 'window'"});
}

}  // namespace

bool clear_of_mode(ArmCavity const& arm, ArmRim const& rim) { return radii_from_axis(arm, rim) >= clear_in_spots; }

int allowed_points(int least) {
  for (int n = std::max(64, least + least % 2); n <= most_points; n += 2) {
    int rest = n;
    for (int const factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
  return 0;
}

double needed_memory(ArmCavity const& arm) {
  auto const kept = double(std::ranges::count_if(arm.rims, &ArmRim::in_band));  // a field each
  return 16 * double(arm.cavity.grid.size()) * (17 + 0.4 * 30 + kept);
}

void check_rims(World const& world, WaveSettings const& settings, ArmCavity& arm) {
  Rims tilted;
  double most = 0;
  for (ArmRim const& rim : arm.rims)
    if (double const tilt = tilt_of(arm, rim); tilt > largest_tilt) {
      tilted.push_back(&rim);
      most = std::fmax(most, tilt);
    }
  if (!tilted.empty())
    arm.problems.push_back(
        {{"baffles"},
         fmt::format("{} {} tilted by {:.3g} deg against the beam; openings on the grid are circles across it",
                     where(world, tilted), tilted.size() > 1 ? "are" : "is", most * 180 / pi),
         fmt::format("remove {} from 'baffles'", tilted.size() > 1 ? "them" : "it")});
  check_speckled(world, arm);
  check_tolerance(settings, arm);
}

bool check_shifts(World const& world, WaveSettings const& settings, ArmCavity& arm) {
  bool inside = true;
  for (std::size_t i : {0, 1}) {
    double const shift = std::hypot(settings.mirrors[i].shift[0], settings.mirrors[i].shift[1]);
    if (!(shift > arm.mirrors[i].radius)) continue;
    inside = false;
    std::string const& name = world.name_of(arm.mirrors[i].surface);
    arm.problems.push_back(
        {{"mirrors", name, "shift"},
         fmt::format("a shift of {:.3g} m exceeds the clear aperture of '{}', whose radius is {:.3g} m", shift, name,
                     arm.mirrors[i].radius),
         "check its unit"});
  }
  return inside;
}

void check_alignment(World const& world, ArmCavity& arm) {
  CavityAxis const axis = axis_of(arm.cavity);
  for (std::size_t i : {0, 1}) {
    RoundHole const& hole = (i == 0 ? arm.cavity.mirror1 : arm.cavity.mirror2).outline;
    double const x = i == 0 ? axis.x1 : axis.x2, y = i == 0 ? axis.y1 : axis.y2;
    if (double const off = std::hypot(x - hole.x, y - hole.y); off > hole.radius - 1.5 * arm.mirrors[i].spot)
      arm.problems.push_back({{"mirrors"},
                              fmt::format("tilts and shifts take the axis of the mode {:.3g} m off the centre of '{}', "
                                          "whose radius is {:.3g} m (eq. W.23)",
                                          off, world.name_of(arm.mirrors[i].surface), hole.radius),
                              "lower them; a mode needs 1.5 of its radii to the edge of each mirror"});
  }
}

namespace {

// Of the power of a Gaussian beam, within a circle whose centre is `off` from its axis: across the direction of `off`
// by the error function, along it by Gauss's rule.
double share_within(double beam_radius, double off, double radius) {
  double const from = std::fmax(-radius, off - 4 * beam_radius), to = std::fmin(radius, off + 4 * beam_radius);
  if (!(from < to)) return 0;
  GaussPoints const gauss(96);
  double const scale = std::sqrt(2) / beam_radius;  // intensity exp(-2 r^2/w^2)
  double sum = 0;
  for (std::size_t i = 0; i < gauss.at.size(); ++i) {
    double const x = from + (to - from) * gauss.at[i];
    sum += gauss.weight[i] * std::exp(-std::pow(scale * (x - off), 2)) *
           std::erf(scale * std::sqrt(std::fmax(0.0, radius * radius - x * x)));
  }
  return (to - from) * sum * scale / std::sqrt(pi);
}

}  // namespace

void check_input(World const& world, WaveSettings const& settings, ArmCavity& arm) {
  if (!settings.input) return;
  auto const& [x, y] = settings.input->shift;
  RoundHole const& hole = arm.cavity.mirror1.outline;
  double const w = settings.input->radius.value_or(arm.mirrors[0].spot);
  double const share = share_within(w, std::hypot(x - hole.x, y - hole.y), hole.radius);
  if (share >= entered) return;
  bool const wide = share_within(w, 0, hole.radius) < entered;
  arm.problems.push_back(
      {{"input", wide ? "radius" : "shift"},
       fmt::format("{} of the power of the input beam falls on '{}', whose clear aperture has a radius of {:.3g} m",
                   share < 1e-6 ? "less than 1e-6" : fmt::format("only {:.2g}", share),
                   world.name_of(arm.mirrors[0].surface), hole.radius),
       "check 'radius' and 'shift' of 'input', and their units",
       share < hardly_entered ? Severity::error : Severity::warning});
}

void choose_grid(ArmCavity& arm, WaveSettings const& settings) {
  Grid& grid = arm.cavity.grid;
  grid.window = settings.window > 0 ? settings.window : window_for(arm, 5);
  grid.points = int(settings.points);
  if (settings.points > 0) return;
  int const of_edges = std::max(points_for_edges(arm), points_for(arm, angle_from_outlines(arm)));
  int const needed = std::max(needed_points(arm, grid.window), std::min(of_edges, most_for_edges));
  grid.points = 64;
  while (grid.points < needed && grid.points < most_points) grid.points *= 2;
}

void check_grid(World const& world, WaveSettings const& settings, ArmCavity& arm) {
  Grid const& grid = arm.cavity.grid;
  if (double const least = window_for(arm, 1.2); grid.window < least)
    arm.problems.push_back({{"grid", "window"},
                            fmt::format("a window of {:.4g} m is too narrow: light would wrap around it", grid.window),
                            fmt::format("state 'window: {:.4g} m' or more in 'grid', or leave it out", 1.01 * least)});
  check_points(settings, arm);
  check_edges_in_grid(arm);
  check_memory(arm);
  Rims small;
  for (ArmRim const& rim : arm.rims)
    if (rim.rim.radius < fewest_pitches * grid.pitch()) small.push_back(&rim);
  if (!small.empty()) {
    auto const least = std::ranges::min_element(small, {}, [](ArmRim const* r) { return r->rim.radius; });
    arm.problems.push_back(
        {{"grid", "points"},
         fmt::format("{} {} a radius of {:.3g} m, less than {} points of the grid", where(world, small),
                     small.size() > 1 ? "have" : "has", (*least)->rim.radius, fewest_pitches),
         "choose more points or a narrower window"});
  }
  double divergence = 0;
  for (ArmMirror const& m : arm.mirrors) divergence = std::fmax(divergence, arm.cavity.wavelength / (pi * m.spot));
  if (arm.crossover < 3 * divergence)
    arm.problems.push_back(
        {{"crossover"},
         fmt::format("the crossover angle of {:.3g} urad is next to the divergence of the mode, {:.3g} urad",
                     1e6 * arm.crossover, 1e6 * divergence),
         fmt::format("choose {:.4g} urad or more", 3e6 * divergence),
         Severity::warning});
}

// Mirrors: their BSDF beyond the crossover angle, and measured maps.

namespace {

// rad; from where on a BSDF model scatters that is zero at a smaller angle, such as one with the key `above`. 0: none.
double begins_beyond(World const& world, ArmMirror const& mirror, double from) {
  auto const models = mirror_models(world, mirror);
  double begin = 0;
  for (auto const& brdf : models) {
    if (brdf(from) > 0) continue;
    double high = from;
    while (high < pi / 2 && !(brdf(high) > 0)) high *= 1.02;
    if (high >= pi / 2) continue;
    double low = high / 1.02;
    for (int i = 0; i < 30; ++i) (brdf((low + high) / 2) > 0 ? high : low) = (low + high) / 2;
    begin = std::fmax(begin, high);
  }
  return begin;
}

}  // namespace

std::optional<HeightMap> checked_map(WaveSettings::Mirror const& settings, LightOnMirror const& light,
                                     double wavelength, std::vector<ArmProblem>& problems) {
  std::vector<std::string> const keys{"maps", settings.name, "file"};
  try {
    return measured_map(settings, light, wavelength);
  } catch (InputError const& e) {
    for (Problem const& p : e.problems) {
      bool const in_file = !e.files.empty();
      problems.push_back({keys, in_file ? p.what : fmt::format("{}: {}", settings.file, p.what),
                          p.suggestion.empty() ? "check the map and its units" : p.suggestion, Severity::error,
                          in_file ? std::optional(p.place) : std::nullopt});
    }
  }
  return {};
}

void check_defects(WaveSettings::Mirror const& settings, MirrorInLight const& mirror,
                   std::vector<ArmProblem>& problems) {
  std::vector<std::string> const keys{"maps", settings.name, "defects"};
  for (WaveSettings::Absorber const& a : settings.absorbers)
    if (double const distance = std::hypot(a.x, a.y); !(distance < mirror.radius))
      problems.push_back({keys, fmt::format("an absorber at [{:g} m, {:g} m] is not on the mirror", a.x, a.y),
                          fmt::format("choose a place within {:.4g} m of the vertex of the mirror", mirror.radius)});
  for (WaveSettings::Ripple const& r : settings.ripples)
    if (double const angle = angle_of_ripple(r, mirror.cosine, mirror.wavelength);
        angle > mirror.crossover * (1 + 1e-12))
      problems.push_back(
          {keys,
           fmt::format("a ripple of {:.4g} m scatters to {:.4g} urad, beyond the crossover angle of {:.4g} urad",
                       r.period, 1e6 * angle, 1e6 * mirror.crossover),
           fmt::format("choose a 'crossover' of {:.4g} urad or more", 1.001e6 * angle)});
}

namespace {

// Rays of the mirror begin at the crossover angle whatever its heights are.
void check_smooth(World const& world, WaveSettings::Mirror const& settings, ArmMirror const& mirror, ArmCavity& arm) {
  double const within = scattered_within(world, mirror, arm.crossover);
  if (!(within > 1e-3 * mirror.scattered)) return;
  arm.problems.push_back({{"maps", settings.name, "spectrum"},
                          fmt::format("'{}' scatters {:.2g} of the light within {:.4g} urad by its BSDF, which neither "
                                      "a perfect mirror nor its rays contain",
                                      world.name_of(mirror.surface), within, 1e6 * arm.crossover),
                          "write 'spectrum: material' for the light at small angles",
                          Severity::warning});
}

}  // namespace

void check_mirrors(World const& world, WaveSettings const& settings, ArmCavity& arm) {
  for (std::size_t i : {0, 1}) {
    WaveSettings::Mirror const& mirror = settings.mirrors[i];
    double const spot = arm.mirrors[i].spot;
    check_defects(mirror, {arm.mirrors[i].radius, 1, arm.cavity.wavelength, arm.crossover}, arm.problems);
    if (mirror.heights == WaveSettings::Heights::file)
      arm.maps[i] = checked_map(mirror, {{spot, spot}}, arm.cavity.wavelength, arm.problems);
    if (mirror.heights == WaveSettings::Heights::none) {
      check_smooth(world, mirror, arm.mirrors[i], arm);
      continue;
    }
    if (double const begin = begins_beyond(world, arm.mirrors[i], arm.crossover); begin > 0)
      arm.problems.push_back(
          {{"crossover"},
           fmt::format("a BSDF model of '{}' begins at {:.4g} urad, above the crossover angle of {:.4g} urad: light "
                       "between these angles would be missing",
                       world.name_of(mirror.surface), 1e6 * begin, 1e6 * arm.crossover),
           fmt::format("choose a 'crossover' of {:.4g} urad or more, or lower 'above' of the model", 1e6 * begin)});
  }
}

}  // namespace straytrace::wave
