// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/arm_diodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "wave/heights/height_map.hpp"
#include "world/model/world.hpp"

namespace straytrace::wave {
namespace {

// The smallest angle to which unknown heights scatter, rad.
double unknown_from(WaveSettings::Heights heights, std::optional<HeightMap> const& map, ArmCavity const& arm) {
  switch (heights) {
    case WaveSettings::Heights::material:
      return 0;
    case WaveSettings::Heights::none:
      return arm.crossover;  // beyond it the BSDF stands for the mirror
    case WaveSettings::Heights::file:
      return std::fmin(arm.crossover, map.value().nyquist() * arm.cavity.wavelength);
  }
  return 0;
}

HaloMirror halo_mirror(World const& world, WaveSettings const& settings, ArmCavity const& arm, std::size_t i) {
  double const from = unknown_from(settings.mirrors[i].heights, arm.maps[i], arm);
  ArmMirror const& mirror = arm.mirrors[i];
  MirrorBrdf const brdf(world, mirror, (i == 0 ? -1 : 1) * arm.frame.z);
  return {mirror.spot, [brdf, from](double angle) { return angle > from ? brdf(angle) : 0; }};
}

}  // namespace

double diode_angle(ArmCavity const& arm, Photodiode const& diode) {
  int const last = int(arm.rims.size()) + 1;
  double const z = diode.plane == 0      ? 0
                   : diode.plane == last ? arm.cavity.length
                                         : arm.rims[std::size_t(diode.plane) - 1].centre.z;
  return std::atan2(diode.farthest(), diode.travel == Travel::towards_mirror2 ? z : arm.cavity.length - z);
}

void place_diodes(WaveSettings const& settings, ArmCavity& arm) {
  int const last = int(arm.rims.size()) + 1;
  for (WaveSettings::Photodiodes const& set : settings.photodiodes) {
    int plane = set.on == settings.mirrors[0].surface ? 0 : last;
    RoundHole centre;
    if (auto const rim = std::ranges::find(arm.rims, set.on, &ArmRim::surface); rim != arm.rims.end()) {
      plane = int(rim - arm.rims.begin()) + 1;
      centre = {0, rim->centre.x, rim->centre.y};
    } else if (plane == last && set.on != settings.mirrors[1].surface) {
      arm.problems.push_back({{"photodiodes"},
                              fmt::format("the photodiodes '{}' are not between the mirrors", set.name),
                              "name a baffle between them in 'on'"});
      continue;
    }
    double& lit = plane == 0      ? arm.cavity.mirror1.lit
                  : plane == last ? arm.cavity.mirror2.lit
                                  : arm.cavity.baffles[std::size_t(plane) - 1].lit;
    for (std::size_t i = 0; i < set.places.size(); ++i) {
      arm.diodes.push_back({fmt::format("{}_{}", set.name, i + 1), plane,
                            set.towards == 1 ? Travel::towards_mirror2 : Travel::towards_mirror1, centre.x, centre.y,
                            set.places[i].radius, set.places[i].azimuth, DiodeShape(int(set.shape)), set.size,
                            2 * pi / double(set.places.size())});
      lit = std::fmax(lit, arm.diodes.back().farthest());
    }
  }
  if (settings.crossover) return;
  for (Photodiode const& d : arm.diodes) arm.crossover = std::fmax(arm.crossover, 1.2 * diode_angle(arm, d));
}

DiodeExpectation expected_on_diodes(World const& world, WaveSettings const& settings, HaloMoments moments,
                                    Computing on) {
  ArmCavity const arm = arm_cavity(world, settings, planned_arm(world, settings), RandomHeights::left_out);
  on.threads = int(thread_count(unsigned(on.threads)));
  CavityWaves const waves(arm.cavity, on);
  // The tail of the mode on a diode is some 1e-4 of its amplitude; always from one start, so that parameters alone
  // change the result.
  SolveOptions solve;
  solve.loss_error = 1e-7;
  WaveMode const mode = [&] {
    try {
      return waves.mode(waves.hermite_gauss(), solve);
    } catch (NumericalError const& e) {
      throw InputError(fmt::format("wave: the mirrors hold no mode that resembles a Gaussian beam: {}", e.what()),
                       "check the mirrors, their tilts and the baffles");
    }
  }();
  DiodeExpectation out{arm.diodes, {}, {}};
  DiodeMeter meter(waves, arm.diodes);
  Field work = mode.spectrum;
  waves.round_trip(work, std::ref(meter));
  out.smooth.resize(Eigen::Index(arm.diodes.size()));
  for (std::size_t i = 0; i < arm.diodes.size(); ++i) out.smooth[Eigen::Index(i)] = meter.light()[i].power();
  out.halo = halo_on(waves, mode, {halo_mirror(world, settings, arm, 0), halo_mirror(world, settings, arm, 1)},
                     arm.diodes, moments);
  return out;
}

}  // namespace straytrace::wave
