// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/driven_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/higher_modes.hpp"

namespace straytrace::wave {
namespace {

// The mode of the mirrors alone behind mirror 1, along its axis.
beams::Mode mode_of_mirrors(WaveCavity const& c) {
  CavityAxis const axis = axis_of(c);
  double const w = cavity_mode(c.length, 1 / c.mirror1.curvature, 1 / c.mirror2.curvature, c.wavelength).w1;
  Vec3 const travel = unit(Vec3{(axis.x2 - axis.x1) / c.length, (axis.y2 - axis.y1) / c.length, 1});
  return beams::circular_mode({axis.x1, axis.y1, 0}, travel, w, -c.mirror1.curvature, c.wavelength);
}

// In the frame of the cavity, which misaligned mirrors do not turn.
beams::Mode input_of(WaveSettings::Input const& input, WaveCavity const& c, double radius) {
  return beams::circular_mode({input.shift[0], input.shift[1], 0}, unit(Vec3{input.tilt[0], input.tilt[1], 1}),
                              input.radius.value_or(radius), input.wavefront_curvature.value_or(-c.mirror1.curvature),
                              c.wavelength);
}

std::vector<double> shares_by_order(beams::Mode const& beam, beams::Mode const& basis, int highest_order) {
  beams::ModeCoefficients const amplitudes = beams::hermite_coefficients(beam, basis, highest_order);
  std::vector<double> shares;
  for (int order = 0; order <= highest_order; ++order) {
    double share = 0;
    for (int m = 0; m <= order; ++m) share += std::norm(amplitudes(order - m, m));
    shares.push_back(share);
  }
  return shares;
}

}  // namespace

DrivenScan drive_arm(WaveSettings const& settings, ArmWaves const& solved, std::vector<MirrorCoating> const& coatings,
                     std::vector<double> const& detunings, DriveOptions const& options) {
  WaveCavity const& cavity = solved.arm.cavity;
  DrivenScan driven;
  driven.coatings = coatings;
  for (WaveSettings::Mirror const& m : settings.mirrors) driven.surfaces.push_back(m.surface);
  driven.free_spectral_range = speed_of_light / (2 * cavity.length);
  CavityWaves const waves(cavity, {int(thread_count(unsigned(options.threads))), options.device});
  Field input = solved.mode.spectrum;
  if (settings.input) {
    beams::Mode const beam = input_of(*settings.input, cavity, solved.arm.mirrors[0].spot);
    driven.input_orders = shares_by_order(beam, mode_of_mirrors(cavity), options.highest_order);
    input = gaussian_field(waves, beam);
  }
  DrivenOptions const solve = solve_options(options);
  driven.take(DrivenCavity(waves, {coatings[0], coatings[1]}, solved.mode.eigenvalue, input, detunings, solve),
              detunings, solve);
  return driven;
}

DrivenOptions solve_options(DriveOptions const& options) {
  DrivenOptions solve;
  solve.highest_order = options.highest_order;
  solve.progress = [say = options.progress](int trips, double error) {
    if (say) say(fmt::format("driven field, round trip {}, error {:.1e}", trips, error));
  };
  return solve;
}

}  // namespace straytrace::wave
