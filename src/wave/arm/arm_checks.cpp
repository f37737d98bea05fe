// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unistd.h>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

constexpr int most_points = 8192;
constexpr double largest_tilt = 0.1;      // rad: the opening across the beam is half a per cent narrower
constexpr int fewest_pitches = 8;         // of a radius of an opening
constexpr double largest_shift = 0.2;     // of a speckled rim, over its radius
constexpr double nearest_in_spots = 1.5;  // of a speckled rim from the axis: 1 % of the power lies beyond
constexpr double clear_in_spots = 3.5;    // 2e-11 lie beyond

// 1/e^2 radius of the mode at a place between the mirrors, from its radius and curvature on mirror 1.
double mode_radius(ArmCavity const& arm, double z) {
  double const w = arm.mirrors[0].spot, rayleigh = pi * w * w / arm.cavity.wavelength;
  return w * std::hypot(1 - z * arm.mirrors[0].curvature, z / rayleigh);
}

std::string where(World const& world, ArmRim const& rim) {
  return fmt::format("wave: the inner edge of '{}' at {:.6g} m", world.name_of(rim.surface), rim.centre.z);
}

// Both waves of eq. W.22 are speckle about a centred edge, without direct light of the mode.
void check_speckled(World const& world, ArmCavity& arm, ArmRim const& rim, std::vector<InputError>& errors) {
  double const shift = std::hypot(rim.centre.x, rim.centre.y), nearest = rim.rim.radius - shift;
  double const spot = mode_radius(arm, rim.centre.z), angle = std::fmax(rim.angle1, rim.angle2);
  std::string const remedy = fmt::format(
      "let the grid solve it with a 'crossover' of {:.4g} urad or more, or remove it from 'baffles'", 1e6 * angle);
  if (nearest < nearest_in_spots * spot)
    errors.emplace_back(
        fmt::format("{} comes within {:.3g} m of the axis, where the mode has a radius of {:.3g} m: light of the "
                    "mode itself meets it, which the mean over speckle (eq. W.22) leaves out",
                    where(world, rim), nearest, spot),
        remedy);
  else if (shift > largest_shift * rim.rim.radius)
    errors.emplace_back(
        fmt::format("{} is {:.3g} m off the axis of the cavity, while the mean over speckle (eq. W.22) is that of "
                    "a centred edge",
                    where(world, rim), shift),
        remedy);
  if (nearest >= nearest_in_spots * spot && nearest < clear_in_spots * spot)
    arm.warnings.push_back(
        fmt::format("{} comes within {:.2g} radii of the mode: the mean over speckle (eq. W.22) leaves out the "
                    "light of the mode itself there; {}",
                    where(world, rim), nearest / spot, remedy));
}

void check_tolerance(WaveSettings const& settings, ArmCavity& arm, std::vector<InputError>& errors) {
  if (!settings.tolerance.any()) return;
  double smallest = infinity;
  for (ArmRim const& rim : arm.rims)
    if (rim.in_band) smallest = std::fmin(smallest, rim.rim.radius);
  if (!(smallest < infinity)) {
    arm.warnings.push_back(
        "wave: 'tolerance' has no effect: both mirrors see no inner edge within the crossover angle");
    return;
  }
  if (double const largest = std::fmax(settings.tolerance.rim, settings.tolerance.centre); largest > 0.1 * smallest)
    errors.emplace_back(fmt::format("wave: a tolerance of {:.3g} m is too large for an inner edge of radius {:.3g} m",
                                    largest, smallest),
                        fmt::format("state one standard deviation of at most {:.3g} m", 0.1 * smallest));
}

struct LegReach {
  double length, reach;  // m; sum of the radii of both ends
};
// Between neighbouring openings; first that from mirror to mirror, which the search for the mode starts with.
std::vector<LegReach> legs_of(ArmCavity const& arm) {
  std::vector<LegReach> legs{{arm.cavity.length, arm.mirrors[0].radius + arm.mirrors[1].radius}};
  double before = 0, radius = arm.mirrors[0].radius;
  for (ArmRim const& r : arm.rims) {
    double const opening = r.rim.radius + std::hypot(r.centre.x, r.centre.y);
    legs.push_back({r.centre.z - before, radius + opening});
    before = r.centre.z;
    radius = opening;
  }
  legs.push_back({arm.cavity.length - before, radius + arm.mirrors[1].radius});
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
  return slope;
}

void check_points(ArmCavity const& arm, std::vector<InputError>& errors) {
  Grid const& grid = arm.cavity.grid;
  double const slope = slope_of_mode(arm), carried = 0.6 * grid.largest_angle(arm.cavity.wavelength) - slope;
  if (carried >= arm.crossover) return;
  double const wanted = (arm.crossover + slope) / 0.6;
  int const allowed = allowed_points(int(std::ceil(2 * grid.window * wanted / arm.cavity.wavelength)));
  double const most = 0.6 * most_points * arm.cavity.wavelength / (2 * grid.window) - slope;
  std::string const smaller =
      carried > 0 ? fmt::format(", or a 'crossover' of at most {:.4g} urad", 1e6 * carried) : "";
  errors.emplace_back(
      fmt::format("wave: a grid of {} points over {:.4g} m does not carry a crossover angle of {:.4g} urad",
                  grid.points, grid.window, 1e6 * arm.crossover),
      allowed
          ? fmt::format("state 'points: {}' in 'grid'{}", allowed, smaller)
          : fmt::format("choose a 'crossover' of at most {:.4g} urad, which {} points carry", 1e6 * most, most_points));
}

void check_memory(ArmCavity const& arm, std::vector<InputError>& errors) {
  double const field = 16 * double(arm.cavity.grid.size());
  auto const kept = double(std::ranges::count_if(arm.rims, &ArmRim::in_band));  // a field each
  double const needed = field * (17 + 0.4 * 30 + kept),
               there = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  if (needed > 0.9 * there)
    errors.emplace_back(
        fmt::format("wave: a grid of {} points needs some {:.2g} GB of memory; this machine has {:.2g} GB",
                    arm.cavity.grid.points, 1e-9 * needed, 1e-9 * there),
        "choose fewer points, with a smaller 'crossover' or 'window'");
}

}  // namespace

bool clear_of_mode(ArmCavity const& arm, ArmRim const& rim) {
  return rim.rim.radius - std::hypot(rim.centre.x, rim.centre.y) >= clear_in_spots * mode_radius(arm, rim.centre.z);
}

int allowed_points(int least) {
  for (int n = std::max(64, least + least % 2); n <= most_points; n += 2) {
    int rest = n;
    for (int const factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
  return 0;
}

void check_rims(World const& world, WaveSettings const& settings, ArmCavity& arm) {
  std::vector<InputError> errors;
  for (ArmRim const& rim : arm.rims) {
    double const tilt = std::acos(std::fmin(1.0, std::fabs(dot(rim.rim.axis, arm.frame.z))));
    if (tilt > largest_tilt)
      errors.emplace_back(
          fmt::format("{} is tilted by {:.3g} deg against the beam; openings on the grid are circles across it",
                      where(world, rim), tilt * 180 / pi),
          "remove it from 'baffles'");
    else if (!rim.in_band)
      check_speckled(world, arm, rim, errors);
  }
  check_tolerance(settings, arm, errors);
  throw_all(errors);
}

void choose_grid(ArmCavity& arm, WaveSettings const& settings) {
  Grid& grid = arm.cavity.grid;
  grid.window = settings.window > 0 ? settings.window : window_for(arm, 5);
  grid.points = int(settings.points);
  if (settings.points > 0) return;
  double const wanted = (arm.crossover + slope_of_mode(arm)) / 0.6;
  int const needed = int(std::ceil(2 * grid.window * wanted / arm.cavity.wavelength));
  grid.points = 64;
  while (grid.points < needed && grid.points < most_points) grid.points *= 2;
}

void check_grid(World const& world, ArmCavity& arm) {
  Grid const& grid = arm.cavity.grid;
  std::vector<InputError> errors;
  if (double const least = window_for(arm, 1.2); grid.window < least)
    errors.emplace_back(
        fmt::format("wave: a window of {:.4g} m is too narrow: light would wrap around it", grid.window),
        fmt::format("state 'window: {:.4g} m' or more in 'grid', or leave it out", 1.01 * least));
  check_points(arm, errors);
  check_memory(arm, errors);
  for (ArmRim const& rim : arm.rims)
    if (rim.rim.radius < fewest_pitches * grid.pitch())
      errors.emplace_back(fmt::format("{} has a radius of {:.3g} m, less than {} points of the grid", where(world, rim),
                                      rim.rim.radius, fewest_pitches),
                          "choose more points or a narrower window");
  throw_all(errors);
  double divergence = 0;
  for (ArmMirror const& m : arm.mirrors) divergence = std::fmax(divergence, arm.cavity.wavelength / (pi * m.spot));
  if (arm.crossover < 3 * divergence)
    arm.warnings.push_back(
        fmt::format("wave: the crossover angle of {:.3g} urad is next to the divergence of the mode, {:.3g} urad",
                    1e6 * arm.crossover, 1e6 * divergence));
}

}  // namespace straytrace::wave
