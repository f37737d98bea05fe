// SPDX-License-Identifier: BSD-3-Clause
// Sine motion: lines and shelf (docs/theory/spectra.md, eq. 7.2 to 7.6, 7.10, 7.11; cases A3, A3b, A4).
#include "physics/noise/support.hpp"

namespace straytrace::testing::noise_fringe_lines {
namespace {

double bessel(int n, double x) { return std::cyl_bessel_j(n, x); }

// Closed forms of a sine motion of peak A [m]: peak phase z [rad] and highest fringe frequency [Hz], eq. 7.2; the shelf
// of z >> 1, mean over phi_0 and smoothed over lines [1/Hz], eq. 7.6.
double phase_amplitude(double peak) { return two_k * peak; }
double cutoff(double phase_peak, double motion_hz) { return phase_peak * motion_hz; }
double shelf_psd(double hz, double cutoff_hz) {
  return hz < cutoff_hz ? 1 / (pi * std::sqrt(cutoff_hz * cutoff_hz - hz * hz)) : 0;
}

// Largest difference between the power of lines n = 1...10 and a table of it.
double worst_line(PhaseSpectrum const& s, std::vector<double> const& edges, std::vector<double> const& expected) {
  double worst = 0;
  for (std::size_t n = 0; n < expected.size(); ++n)
    worst = std::max(worst, std::fabs(s.psd[2 * n] * (edges[2 * n + 1] - edges[2 * n]) - expected[n]));
  return worst;
}

MotionSet sine(double hz, double peak) {
  MotionSet m;
  m.bodies = {"body"};
  m.inputs = {tone(hz, peak)};
  return m;
}

TEST(FringeLines, SineMotionGivesBesselLines) {  // A3, tolerance 1e-6
  std::vector<double> const published = {0.053845, 0.001910, 0.047195, 0.023736, 0.012743,
                                         0.062323, 0.019815, 0.006853, 0.063967, 0.091613};
  double const hz = 0.42, z = phase_amplitude(1e-6);
  EXPECT_NEAR(z, 11.810499, 1e-6);
  std::vector<double> edges;
  for (int n = 1; n <= 10; ++n) edges.insert(edges.end(), {(n - 0.2) * hz, (n + 0.2) * hz});
  PhaseSpectrum const s = fringes(sine(hz, 1e-6), edges);
  for (std::size_t n = 0; n < 10; ++n)
    EXPECT_NEAR(s.psd[2 * n] * (edges[2 * n + 1] - edges[2 * n]), published[n], 1e-6) << "line " << n + 1;
  EXPECT_NEAR(s.constant, 9.700e-6, 1e-9);
  EXPECT_NEAR(s.total, 0.5, 1e-9);
  for (int n = 1; n <= 10; ++n)
    EXPECT_LT(deviation(s.psd[2 * n - 2] * 0.4 * hz, std::pow(bessel(n, z), 2)), 1e-6) << "line " << n;
  for (std::size_t gap = 1; gap < s.psd.size(); gap += 2) EXPECT_LT(s.psd[gap], 1e-12);
  // Controls: rms read as peak, and one line too few in the constant part.
  EXPECT_GT(worst_line(fringes(sine(hz, 1e-6 * std::sqrt(2)), edges), edges, published), 1e-3);
  EXPECT_GT(std::fabs(s.constant - std::pow(bessel(0, z), 2)), 1e-9);
}

// Case A3b: power near |n f1 + m f2| for two tones on one path against J_n(z1)^2 J_m(z2)^2 and against a plain sum over
// time of the same field.
struct TwoTones {
  double f1 = 1, f2 = 1.37, z1 = 2.2, z2 = 1.4;
  double line(int n, int m) const { return std::pow(bessel(std::abs(n), z1) * bessel(std::abs(m), z2), 2); }
  double direct(
      double f) const {  // |mean over 100 s of exp(i phi) exp(-2 pi i f t)|^2, one line of the two-sided field
    int const steps = 40000;
    std::complex<double> sum = 0;
    for (int i = 0; i < steps; ++i) {
      double const t = 100.0 * i / steps;
      sum += std::polar(1.0, z1 * std::sin(2 * pi * f1 * t) + z2 * std::sin(2 * pi * f2 * t) - 2 * pi * f * t);
    }
    return std::norm(sum / static_cast<double>(steps));
  }
};

TEST(FringeLines, TwoTonesMultiply) {
  TwoTones const two;
  MotionSet m;
  m.bodies = {"body"};
  m.inputs = {tone(two.f1, two.z1 / two_k), tone(two.f2, two.z2 / two_k)};
  double worst = 0, worst_sum = 0;
  for (auto [n, k] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 1}, {2, -1}, {3, 2}, {0, 3}}) {
    double const f = std::fabs(n * two.f1 + k * two.f2), half = 0.012;
    double const power = fringes(m, {f - half, f + half}).psd[0] * 2 * half;
    worst = std::max({worst, std::fabs(power - two.line(n, k)), std::fabs(power - two.direct(f))});
    worst_sum = std::max(worst_sum, std::fabs(power - bessel(std::abs(n), two.z1) * bessel(std::abs(k), two.z2)));
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(worst_sum, 1e-2);  // control: products of fields instead of powers
  PhaseSpectrum const s = fringes(m, {0.5, 20});
  EXPECT_NEAR(s.constant, two.line(0, 0) / 2, 1e-9);
  EXPECT_NEAR(s.total, 0.5, 1e-9);
}

TEST(FringeLines, ManyLinesMakeAShelf) {  // A4, tolerance 1 %
  double const hz = 0.15, top = cutoff(phase_amplitude(10e-6), hz);
  EXPECT_LT(deviation(std::sqrt(shelf_psd(0, top)), 0.13404), 1e-4);
  std::vector<double> const edges = {0.5 * hz, 13.5 * hz, 59.5 * hz, 79.5 * hz, 2 * top};
  PhaseSpectrum const s = fringes(sine(hz, 10e-6), edges);
  auto const power = [&](std::size_t i) { return s.psd[i] * (edges[i + 1] - edges[i]); };
  double const mean = (power(1) + power(2)) / (66 * hz);  // 66 lines from 2 to 12 Hz
  EXPECT_LT(deviation(mean, 0.01992), 1e-3);
  double closed = 0;
  for (int n = 14; n < 80; ++n) closed += shelf_psd(n * hz, top) / 66;
  EXPECT_LT(deviation(closed, 0.02006), 1e-3);
  EXPECT_LT(deviation(mean, closed), 0.01);
  double const below_half = s.constant + power(0) + power(1);
  EXPECT_LT(deviation(below_half, 0.16775), 1e-3);
  EXPECT_LT(deviation(below_half, 1.0 / 6), 0.01);
  EXPECT_GT(deviation(mean, closed * std::sqrt(pi / 2)), 0.1);  // control: the rms-mean level, root of pi/2 higher
}

// R2.41: the closed forms, and the lines of the program below a third of the edge and over the whole shelf.
TEST(FringeLines, PlateauAndRmsMeanOfMicroseism) {
  double const hz = 0.35, top = cutoff(phase_amplitude(3e-6), hz), g = 1.955e-20;
  EXPECT_LT(deviation(top, 12.40), 1e-3);
  double const plateau = g * std::sqrt(shelf_psd(0, top)), rms_mean = g / std::sqrt(2 * top);
  EXPECT_LT(deviation(plateau, 3.13e-21), 2e-3);
  EXPECT_LT(deviation(rms_mean, 3.93e-21), 2e-3);
  double const seen = g * std::sqrt(fringes(sine(hz, 3e-6), {0.5 * hz, 12.5 * hz}).psd[0]);
  EXPECT_LT(deviation(seen, plateau), 0.1);
  EXPECT_GT(deviation(seen, rms_mean), 0.1);  // control: the two levels confused
  PhaseSpectrum const whole = fringes(sine(hz, 3e-6), {0.5 * hz, 3 * top});
  double const power = whole.constant + whole.psd[0] * (3 * top - 0.5 * hz);
  EXPECT_LT(deviation(g * std::sqrt(power / top), rms_mean), 1e-3);  // all of 1/2, spread evenly up to the edge
}

}  // namespace
}  // namespace straytrace::testing::noise_fringe_lines
