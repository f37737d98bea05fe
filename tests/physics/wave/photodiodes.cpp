// SPDX-License-Identifier: BSD-3-Clause
// Light on photodiodes of a screen (docs/theory/wave.md, eq. W.24).
#include <gtest/gtest.h>

#include <cmath>

#include "base/every_module.hpp"
#include "base/math/constants.hpp"
#include "support/recorded.hpp"
#include "wave/diodes/photodiode.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::wave_photodiodes {
namespace {

using testing::deviation;

WaveMirror concave(double radius) { return {1 / 2500., {radius}, 0, 0, {}, 0}; }
// A kilometre with a screen in front of mirror 2 whose opening clips the beam.
WaveCavity screened(RoundHole rim, double lit) {
  return {1.064e-6, 1000, concave(0.075), concave(0.075), {{990, rim, lit}}, {256, 0.5}};
}

std::vector<double> powers(WaveCavity const& cavity, std::vector<Photodiode> const& diodes, PowerLedger* ledger = {}) {
  CavityWaves const waves(cavity);
  WaveMode const mode = waves.mode(waves.hermite_gauss());
  DiodeMeter meter(waves, diodes);
  Field work = mode.spectrum;
  waves.round_trip(work, std::ref(meter));
  if (ledger) *ledger = waves.ledger(mode);
  std::vector<double> out;
  for (DiodeLight const& light : meter.light()) out.push_back(light.power());
  return out;
}

std::vector<Photodiode> tiles(double from, double to, int rings, int count, double x, double y) {
  std::vector<Photodiode> diodes;
  double const height = (to - from) / rings;
  for (int ring = 0; ring < rings; ++ring)
    for (int i = 0; i < count; ++i)
      diodes.push_back({"", 1, Travel::towards_mirror2, x, y, from + (ring + 0.5) * height, 2 * pi * i / count,
                        DiodeShape::sector, height, 2 * pi / count});
  return diodes;
}

// Sectors without gaps receive what the ledger has on the screen (eq. W.24), with an opening off the axis.
TEST(Photodiodes, SectorsTileTheScreen) {
  PowerLedger ledger;
  double sum = 0;
  for (double p : powers(screened({0.045, 0.003, -0.002}, 0.16), tiles(0.045, 0.16, 3, 12, 0.003, -0.002), &ledger))
    sum += p;
  EXPECT_LT(deviation(sum, ledger.towards_mirror2[0]), 1e-3);
  double short_of_one = 0;  // negative control: the innermost ring begins a millimetre farther out
  for (double p : powers(screened({0.045, 0.003, -0.002}, 0.16), tiles(0.046, 0.16, 3, 12, 0.003, -0.002)))
    short_of_one += p;
  EXPECT_GT(deviation(short_of_one, ledger.towards_mirror2[0]), 0.02);
}

// The tail of a Gaussian beam that nothing clips: |psi|^2 = 2/(pi w^2) exp(-2 r^2/w^2), on squares smaller than the
// pitch of 2 mm and on discs.
TEST(Photodiodes, SmallAreasReceiveTheTailOfTheBeam) {
  WaveCavity cavity = screened({0.074}, 0);
  cavity.baffles.clear();
  CavityWaves const waves(cavity);
  double const w = 0.0205755, r = 0.03, size = 3e-4;
  auto const at = [&](DiodeShape shape, double s) {
    return powers(cavity, {{"", 1, Travel::towards_mirror2, 0, 0, r, 0.4, shape, s, 0}}).front();
  };
  double const irradiance = 2 / (pi * w * w) * std::exp(-2 * r * r / (w * w));
  EXPECT_LT(deviation(at(DiodeShape::square, size), irradiance * size * size), 1e-3);
  EXPECT_LT(deviation(at(DiodeShape::round, size), irradiance * pi * size * size / 4), 1e-3);
  // Mean of the exponential over a square of 8 mm: erf along both axes.
  auto const half_line = [&](double from, double to) {
    return 0.5 * (std::erf(std::sqrt(2.0) * to / w) - std::erf(std::sqrt(2.0) * from / w));
  };
  double const large = 8e-3, expected = half_line(r - large / 2, r + large / 2) * half_line(-large / 2, large / 2);
  EXPECT_LT(deviation(at(DiodeShape::square, large), expected), 1e-3);
  EXPECT_GT(deviation(irradiance * large * large, expected), 0.02);  // negative control: the value at the middle
}

double law(double angle) { return angle > 20e-6 && angle < 150e-6 ? 5e-7 / (angle * angle) : 0; }

std::vector<Photodiode> ring(double radius) {
  std::vector<Photodiode> diodes;
  for (int i = 0; i < 12; ++i)
    diodes.push_back({"", 1, Travel::towards_mirror2, 0, 0, radius, 2 * pi * i / 12, DiodeShape::square, 4e-3, 0});
  return diodes;
}

// Twelve draws of the heights of both mirrors against mean and covariance (eq. W.41, W.43), with the light of the mode
// that passes beyond the opening. The mean over draws is known to some 5 %, the variance to 15 %.
TEST(Photodiodes, RandomHeightsHaveTheirMeanAndCovariance) {
  int const maps = 12;
  WaveCavity const smooth = screened({0.045}, 0.08);
  std::vector<Photodiode> const diodes = ring(0.07);
  CavityWaves const waves(smooth);
  double const spot = 0.0205755;
  HaloStatistics const halo =
      halo_on(waves, waves.mode(waves.hermite_gauss()), {HaloMirror{spot, law}, {spot, law}}, diodes);
  std::vector<double> const direct = powers(smooth, diodes);
  double mean = 0, expected = 0, variance = 0, opposite = 0;
  for (int i = 0; i < 12; ++i) expected += direct[std::size_t(i)] + halo.mean[i];
  for (int seed = 1; seed <= maps; ++seed) {
    WaveCavity rough = smooth;
    auto const spectrum = [](double f) { return height_spectrum(law(f * 1.064e-6), 1.064e-6); };
    rough.mirror1.height = synthesise(spectrum, rough.grid, 0, 150e-6 / 1.064e-6, std::uint64_t(seed), 0);
    rough.mirror2.height = synthesise(spectrum, rough.grid, 0, 150e-6 / 1.064e-6, std::uint64_t(seed), 1);
    std::vector<double> const found = powers(rough, diodes);
    auto const excess = [&](std::size_t i) { return found[i] - direct[i] - halo.mean[Eigen::Index(i)]; };
    for (std::size_t i = 0; i < 12; ++i) {
      mean += found[i] / maps;
      variance += excess(i) * excess(i) / maps;
      opposite += excess(i) * excess((i + 6) % 12) / maps;
    }
  }
  double expected_opposite = 0;
  for (int i = 0; i < 12; ++i) expected_opposite += halo.covariance(i, (i + 6) % 12);
  EXPECT_LT(deviation(mean, expected), 0.2);
  EXPECT_LT(deviation(variance, halo.covariance.trace()), 0.5);
  EXPECT_LT(deviation(opposite / variance, expected_opposite / halo.covariance.trace()), 0.6);
  // Negative controls: the light of the smooth mirrors alone; independent opposite diodes.
  double smooth_sum = 0;
  for (double d : direct) smooth_sum += d;
  EXPECT_GT(deviation(smooth_sum, mean), 0.15);
  EXPECT_GT(expected_opposite, 0.2 * halo.covariance.trace());
}

// eq. W.17 without a second way: one mirror scatters, and nothing is between it and the diodes.
TEST(Photodiodes, TheDirectWayIsTheMeanIrradiance) {
  WaveCavity cavity = screened({0.045}, 0.08);
  CavityWaves const waves(cavity);
  double const spot = 0.0205755;
  auto const far_law = [](double angle) { return angle > 60e-6 ? 5e-7 / (angle * angle) : 0; };
  auto const nothing = [](double) { return 0.0; };
  HaloStatistics const halo = halo_on(waves, waves.mode(waves.hermite_gauss()),
                                      {HaloMirror{spot, far_law}, {spot, nothing}}, ring(0.078), HaloMoments::mean);
  double const irradiance = mean_irradiance(far_law, spot, 1 / 2500., 990, 0.078);
  EXPECT_LT(deviation(halo.mean[0], irradiance * 16e-6), 0.02);
  EXPECT_GT(deviation(mean_irradiance(far_law, spot, 0, 990, 0.078), irradiance), 0.002);  // negative control: flat
}

}  // namespace
}  // namespace straytrace::wave_photodiodes
