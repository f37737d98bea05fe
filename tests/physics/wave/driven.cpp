// SPDX-License-Identifier: BSD-3-Clause
// The field that an input beam builds up in a cavity (docs/theory/wave.md, eq. W.50 to W.52): the Airy function
// (eq. 6.4), the modes that a tilted and shifted beam excites (eq. 5.1, 5.2), the balance of power, and the error of
// the Krylov space.
#include "wave/modes/driven.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "beams/cavity_mode.hpp"
#include "beams/overlap.hpp"
#include "support/recorded.hpp"

namespace straytrace::wave_driven {
namespace {

using testing::deviation;
using wave::Complex;

constexpr double wavelength = 1.064e-6;  // m
std::array<MirrorCoating, 2> const coatings{MirrorCoating{0.014, 0}, {1e-3, 0}};
double const r1 = std::sqrt(1 - 0.014), r2 = std::sqrt(1 - 1e-3), t1 = std::sqrt(0.014);

WaveCavity two_mirrors(double radius, double tilt = 0) {
  WaveMirror const mirror{1 / 2500., {radius}, 0, 0, {}, 0};
  WaveCavity cavity{wavelength, 1000, mirror, mirror, {}, {256, 0.4}};
  cavity.mirror2.tilt_x = tilt;
  return cavity;
}
double const spot_of_mode = cavity_mode(1000, 2500, 2500, wavelength).w1;
// Round trip of order n less that of order 0, in turns.
double resonance_of(int order) { return order * 2 * std::acos(0.6) / (2 * pi); }

// The Gaussian mode of the cavity behind mirror 1, tilted and shifted.
beams::Mode input_beam(double tilt = 0, double shift = 0, double size = 1) {
  return circular_mode({shift, 0, 0}, unit(Vec3{tilt, 0, 1}), size * spot_of_mode, -1 / 2500., wavelength);
}

// V2: the loss of 38.3338 ppm is in the round trip.
TEST(DrivenCavity, AiryFunctionOfACavityWithLoss) {
  CavityWaves const waves(two_mirrors(0.05));
  WaveMode const mode = waves.mode(waves.hermite_gauss());
  std::vector<double> const detunings{0, 1e-4, 5e-4, 1e-3, 0.01, 0.1, 0.5};
  DrivenCavity const driven(waves, coatings, mode.eigenvalue, mode.spectrum, detunings);
  double const trip = std::sqrt(1 - 38.3338e-6), way = std::sqrt(trip);  // of amplitude; the way out is half of it
  double const entered = driven.entered();                               // the edge takes 1e-6 of the mode once more
  EXPECT_LT(std::abs(entered - 1), 2e-6);  // so powers agree with the Airy function to some 1e-6
  for (double d : detunings) {
    Complex const gain = t1 / (1.0 - r1 * r2 * trip * turned(d));
    DrivenPowers const found = driven.at(d);
    EXPECT_LT(deviation(found.circulating, std::norm(gain)), 5e-6) << d;
    EXPECT_LT(deviation(found.transmitted, 1e-3 * way * way * std::norm(gain)), 5e-6) << d;
    EXPECT_LT(deviation(found.reflected, std::norm(-r1 + t1 * r2 * trip * turned(d) * gain)), 1e-5) << d;
    // What does not come out is lost on both ways.
    double const lost = std::norm(gain) * (1 - way * way) * (1 + r2 * r2 * way * way);
    EXPECT_NEAR(found.reflected + found.transmitted + lost, entered, 4e-6) << d;
    EXPECT_GT(found.orders[0], 0.999) << d;
  }
  double const lossless = std::norm(t1 / (1 - r1 * r2));
  EXPECT_GT(deviation(driven.at(0).circulating, lossless), 1e-3);  // negative control: without the loss
  EXPECT_LT(driven.round_trips(), 8);                              // the input is the mode itself
}

// Far from the edges of the mirrors: each order resonates at its own detuning with the share that the overlap gives it.
TEST(DrivenCavity, TiltedAndShiftedInputExcitesHigherModes) {
  CavityWaves const waves(two_mirrors(0.075));
  WaveMode const mode = waves.mode(waves.hermite_gauss());
  double const tilt = 1e-6, shift = 1e-3;
  beams::Mode const beam = input_beam(tilt, shift), basis = input_beam();
  beams::ModeCoefficients const shares = beams::hermite_coefficients(beam, basis, 2);
  std::vector<double> const detunings{0, resonance_of(1), -resonance_of(1)};
  DrivenCavity const driven(waves, coatings, mode.eigenvalue, gaussian_field(waves, beam), detunings);
  double const gain = std::norm(t1 / (1 - r1 * r2));
  DrivenPowers const first = driven.at(resonance_of(1));
  double const of_order1 = first.circulating * first.orders[1] / gain;
  EXPECT_LT(deviation(of_order1, std::norm(shares(1, 0)) + std::norm(shares(0, 1))), 1e-3);
  // To second order, eq. 5.1 and 5.2: the tilt towards the wavefront at the shifted place adds to that of the beam.
  double const angle = tilt + shift / 2500, by_angle = pi * spot_of_mode * angle / wavelength;
  double const second_order = by_angle * by_angle + std::pow(shift / spot_of_mode, 2);
  EXPECT_LT(deviation(of_order1, second_order), 2 * second_order);
  EXPECT_LT(deviation(driven.at(0).circulating * driven.at(0).orders[0] / gain, std::norm(shares(0, 0))), 1e-3);
  DrivenPowers const other = driven.at(-resonance_of(1));  // negative control: the wrong sign of the detuning
  EXPECT_LT(other.circulating * other.orders[1] / gain, 1e-3 * of_order1);
  for (double d : detunings) {
    DrivenPowers const p = driven.at(d);
    EXPECT_NEAR(p.reflected + p.transmitted, 1, 1e-4) << d;  // these mirrors clip nearly nothing
  }
}

// A mismatched beam feeds LG10 = order 2; the beam through the axis of a cavity with a tilted mirror does not see it.
TEST(DrivenCavity, MismatchAndMisalignment) {
  CavityWaves const waves(two_mirrors(0.075));
  WaveMode const mode = waves.mode(waves.hermite_gauss());
  DrivenCavity const wide(waves, coatings, mode.eigenvalue, gaussian_field(waves, input_beam(0, 0, 1.1)), {0});
  double const gain = std::norm(t1 / (1 - r1 * r2)), matched = std::pow(2 * 1.1 / (1 + 1.21), 2);  // eq. 5.3
  DrivenPowers const at_resonance = wide.at(0);
  EXPECT_LT(deviation(at_resonance.circulating * at_resonance.orders[0] / gain, matched), 1e-3);
  EXPECT_LT(at_resonance.orders[1], 1e-12);

  CavityWaves const tilted(two_mirrors(0.075, 0.3e-6));
  WaveMode const turned_mode = tilted.mode(tilted.hermite_gauss());
  CavityAxis const axis = axis_of(tilted.cavity());
  beams::Mode const along_axis = circular_mode({axis.x1, 0, 0}, unit(Vec3{(axis.x2 - axis.x1) / 1000, 0, 1}),
                                               spot_of_mode, -1 / 2500., wavelength);
  auto const build_up = [&](beams::Mode const& beam) {
    DrivenCavity const driven(tilted, coatings, turned_mode.eigenvalue, gaussian_field(tilted, beam), {0});
    return driven.at(0).circulating / gain;
  };
  EXPECT_LT(deviation(build_up(along_axis), 1), 1e-4);
  EXPECT_LT(deviation(build_up(input_beam()), beams::power_overlap(input_beam(), along_axis)), 1e-4);
  EXPECT_LT(build_up(input_beam()), 0.9995);  // negative control: the beam along the old axis
}

// The stated error bounds the error at every detuning, against many more round trips.
TEST(DrivenCavity, ErrorOfTheKrylovSpace) {
  WaveCavity cavity = two_mirrors(0.05);
  cavity.baffles.push_back({400, {0.04, 3e-3, -1.5e-3}});
  CavityWaves const waves(cavity);
  WaveMode const mode = waves.mode(waves.hermite_gauss());
  std::vector<double> detunings;
  for (int i = -50; i <= 50; ++i) detunings.push_back(i / 100.);
  Field const input = gaussian_field(waves, input_beam(2e-6, 2e-3, 1.2));
  auto const solved = [&](int most, double error) {
    DrivenOptions options;
    options.most_round_trips = most;
    options.error = error;
    return DrivenCavity(waves, coatings, mode.eigenvalue, input, detunings, options);
  };
  DrivenCavity const exact = solved(60, 1e-9), good = solved(60, 1e-4), coarse = solved(6, 1e-9);
  double worst = 0;
  for (double d : detunings) {
    auto const error = [&](DrivenCavity const& other) {
      Field const right = exact.field(d), found = other.field(d);
      double sum = 0, norm = 0;
      for (std::size_t i = 0; i < right.values.size(); ++i) {
        sum += std::norm(found.values[i] - right.values[i]);
        norm += std::norm(right.values[i]);
      }
      return std::sqrt(sum / norm);
    };
    if (std::abs(std::remainder(d, 0.1)) > 1e-6) continue;  // fields of some
    EXPECT_LT(error(good), 1.01 * good.at(d).error + 1e-8) << d;
    EXPECT_LT(error(coarse), 1.01 * coarse.at(d).error / (1 - std::min(coarse.at(d).error, 0.9))) << d;
    worst = std::max(worst, error(coarse));
  }
  for (double d : detunings) EXPECT_LT(good.at(d).error, 1e-4) << d;
  EXPECT_GT(worst, 1e-3);  // negative control: six round trips are not enough
  EXPECT_LT(good.round_trips(), exact.round_trips());
}

}  // namespace
}  // namespace straytrace::wave_driven
