// SPDX-License-Identifier: BSD-3-Clause
// Static phases that are known: one quadrature of one realisation, and coherent families (docs/theory/spectra.md,
// eq. 7.3, 7.4, 10.5).
#include "noise/wrapped/phase_spectra.hpp"
#include "physics/noise/support.hpp"
#include "physics/noise/time_domain/time_series.hpp"

namespace straytrace::testing::noise_known_phases {
namespace {

double bessel(int n, double x) { return std::cyl_bessel_j(n, std::fabs(x)) * (x < 0 && n % 2 ? -1 : 1); }

// PSD of Im s of one path with static phase phi_0: C(tau) - cos(2 phi_0) exp(-(R(0) + R(tau))), that of Re s with
// phi_0 + pi/2. A tone of known phase makes a mean over that phase.
std::vector<PhasePair> with_static_phase(double kappa, double phi_0) {
  return {{1, {kappa}, {kappa}}, {-std::cos(2 * phi_0), {kappa}, {-kappa}}};
}

struct OneTone {
  double hz = 1, z;
  std::vector<double> edges;
  explicit OneTone(double peak, int lines) : z(peak) {
    for (int n = 1; n <= lines; ++n) edges.insert(edges.end(), {(n - 0.3) * hz, (n + 0.3) * hz});
  }
  std::vector<double> lines(double phi_0, double* constant = nullptr) const {
    MotionSet m;
    m.bodies = {"body"};
    m.inputs = {tone(hz, z / two_k)};
    PhaseSpectra const spectra(group_by_shape(m), FrequencyGrid{edges});
    PairSpectrum const s = pair_spectrum(spectra, with_static_phase(z * z, phi_0));
    if (constant) *constant = s.constant;
    std::vector<double> out;
    for (std::size_t i = 0; i < edges.size(); i += 2) out.push_back(s.psd[i] * (edges[i + 1] - edges[i]));
    return out;
  }
};

// Line n of sin(phi_0 + z sin y): power 2 J_n^2 cos^2 phi_0 for odd n, 2 J_n^2 sin^2 phi_0 for even n.
TEST(StaticPhase, DecidesOnOddAndEvenLines) {
  OneTone const strong(3.2, 8);
  for (double phi_0 : {0.0, 0.4, pi / 4, 1.1, pi / 2}) {
    double constant;
    std::vector<double> const p = strong.lines(phi_0, &constant);
    for (int n = 1; n <= 8; ++n) {
      double const share = n % 2 ? std::pow(std::cos(phi_0), 2) : std::pow(std::sin(phi_0), 2);
      EXPECT_NEAR(p[n - 1], 2 * std::pow(bessel(n, strong.z), 2) * share, 1e-10) << n << " at " << phi_0;
    }
    EXPECT_NEAR(constant, std::pow(bessel(0, strong.z) * std::sin(phi_0), 2), 1e-12);
  }
}

TEST(StaticPhase, LinesOfUpConversion) {  // R2.38: z = 1, and z = 124.0102: odd lines sum to (1 - J_0(2z))/2
  std::vector<double> const one = OneTone(1, 3).lines(0);
  EXPECT_NEAR(std::sqrt(one[0] / 2), 0.440051, 1e-6);
  EXPECT_NEAR(one[1], 0, 1e-12);
  EXPECT_NEAR(std::sqrt(one[2] / 2), 0.019563, 1e-6);
  std::vector<double> const many = OneTone(124.0102, 150).lines(0);
  double sum = 0, beyond = 0;
  for (std::size_t i = 0; i < many.size(); ++i) (i < 140 ? sum : beyond) += many[i];
  EXPECT_NEAR(sum, 0.514709, 2e-6);
  EXPECT_NEAR(sum, (1 - bessel(0, 2 * 124.0102)) / 2, 1e-6);
  EXPECT_LT(beyond, 1e-4);  // lines fall steeply once n exceeds z
}

TEST(StaticPhase, LinesOfTwelveRadians) {  // eq. 7.3 at phi_0 = 0; the mean over phi_0 (eq. 7.4) is the control
  std::vector<double> const known = OneTone(11.810499, 4).lines(0), mean = OneTone(11.810499, 4).lines(pi / 4);
  double const expected[] = {0.107690, 0, 0.094390, 0}, of_mean[] = {0.053845, 0.001910};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(known[i], expected[i], 1e-6) << i + 1;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(mean[i], of_mean[i], 1e-6) << i + 1;
    EXPECT_GT(std::fabs(mean[i] - expected[i]), 1e-3) << i + 1;
  }
}

// Cross spectrum of Im s and Re s: line n is -J_n^2 sin(2 phi_0) for odd n and +J_n^2 sin(2 phi_0) for even n, from the
// products of the amplitudes of eq. 7.3 in both quadratures. Control: the opposite sign.
TEST(StaticPhase, CorrelatesTheQuadratures) {
  OneTone const motion(3.2, 8);
  MotionSet m;
  m.bodies = {"body"};
  m.inputs = {tone(motion.hz, motion.z / two_k)};
  PhaseSpectra const spectra(group_by_shape(m), FrequencyGrid{motion.edges});
  double const kappa = motion.z * motion.z;
  std::vector<double> const cross = pair_spectrum(spectra, std::vector<PhasePair>{{1, {kappa}, {-kappa}}}).psd;
  for (double phi_0 : {0.0, 0.4, pi / 4, 1.1, pi / 2}) {
    for (int n = 1; n <= 8; ++n) {
      double const j = bessel(n, motion.z), im = 2 * j * (n % 2 ? std::cos(phi_0) : std::sin(phi_0)),
                   re = 2 * j * (n % 2 ? -std::sin(phi_0) : std::cos(phi_0));
      double const width = motion.edges[2 * n - 1] - motion.edges[2 * n - 2];
      double const seen = std::sin(2 * phi_0) * cross[2 * n - 2] * width;
      EXPECT_NEAR(seen, im * re / 2, 1e-10) << n << " at " << phi_0;
      if (n < 4 && phi_0 == pi / 4) {
        EXPECT_GT(std::fabs(-seen - im * re / 2), 1e-3) << n;
      }
    }
  }
}

MotionSet gaussian(double rms) { return moving({gaussian_line(2, 0.4, rms)}); }

PairSpectrum quadrature(double rms, double phi_0, std::vector<double> edges) {
  PhaseSpectra const spectra(group_by_shape(gaussian(rms)), FrequencyGrid{std::move(edges)});
  return pair_spectrum(spectra, with_static_phase(two_k * two_k, phi_0));
}

TEST(StaticPhase, WeakMotionOnTheSlope) {  // Im s = phi cos(phi_0): twice eq. 7.9 at most, tolerance 1e-4
  std::vector<double> const edges = {1.8, 2.2};
  double const linear = two_k * two_k * gaussian_line(2, 0.4, 1e-11).power(1.8, 2.2) / 0.4;
  for (double phi_0 : {0.0, 0.7, 1.2})
    EXPECT_LT(deviation(quadrature(1e-11, phi_0, edges).psd[0], linear * std::pow(std::cos(phi_0), 2)), 1e-4);
  EXPECT_LT(quadrature(1e-11, pi / 2, edges).psd[0], 1e-4 * linear);
}

TEST(StaticPhase, BothQuadraturesAddUp) {  // R4.11; eq. 7.10 with a known phase: <sin^2> = (1 - cos(2 phi_0) e^-2R)/2
  std::vector<double> const edges = {0.01, 0.03, 0.06, 0.1, 0.2, 1, 4, 20, 200};
  for (double rms : {3e-9, 1e-7, 1e-6}) {
    for (double phi_0 : {0.0, 1.3}) {
      PairSpectrum const im = quadrature(rms, phi_0, edges), re = quadrature(rms, phi_0 + pi / 2, edges);
      PhaseSpectrum const mean = fringes(gaussian(rms), edges);
      double power = im.constant + im.psd[0] * edges[0];  // flat down to zero
      for (std::size_t i = 0; i < im.psd.size(); ++i) {
        power += im.psd[i] * (edges[i + 1] - edges[i]);
        EXPECT_NEAR(im.psd[i] + re.psd[i], 2 * mean.psd[i], 1e-4 * mean.psd[i]);
      }
      double const variance = std::pow(two_k * rms, 2);
      EXPECT_NEAR(power, (1 - std::cos(2 * phi_0) * std::exp(-2 * variance)) / 2, 2e-4) << rms << ' ' << phi_0;
    }
  }
}

// Two paths from one body with phase sensitivities z and 0.4 z: line n is sum_j s_j J_n(z_j), fields first.
TEST(CoherentFamily, LinesAddAsFields) {
  double const z = 2.7;
  MotionSet m;
  m.bodies = {"body"};
  m.inputs = {tone(1, 1)};
  std::vector<CoherentPath> const paths = {{1.0, {phase_sensitivity(0, 2, z)}},
                                           {std::polar(0.8, 1.9), {phase_sensitivity(0, 2, -0.4 * z)}}};
  std::vector<double> edges;
  for (int n = 1; n <= 6; ++n) edges.insert(edges.end(), {n - 0.3, n + 0.3});
  PhaseSpectra const spectra(group_by_shape(m), FrequencyGrid{edges});
  PairSpectrum const s = pair_spectrum(spectra, coherent_family(m, spectra.classes(), paths));
  for (int n = 1; n <= 6; ++n) {
    std::complex<double> plus = 0, minus = 0;
    double powers = 0;
    for (auto const& [field, phase_sensitivities] : paths) {
      double const zj = phase_sensitivities[0].d[2];
      plus += field * bessel(n, zj);
      minus += field * bessel(n, zj) * (n % 2 ? -1.0 : 1.0);
      powers += std::norm(field) * std::pow(bessel(n, zj), 2);
    }
    double const expected = (std::norm(plus) + std::norm(minus)) / 2;
    EXPECT_NEAR(s.psd[2 * n - 2] * 0.6, expected, 1e-10) << n;
    if (n == 1) {
      EXPECT_GT(deviation(powers, expected), 0.1);  // control: powers added
    }
  }
}

TEST(CoherentFamily, EqualPhaseSensitivitiesAreOnePath) {
  MotionSet const m = gaussian(1e-7);
  PhaseSpectra const spectra(group_by_shape(m), FrequencyGrid{{1, 3, 9, 10}});
  std::vector<CoherentPath> const two = {{0.7, {phase_sensitivity(0, 2, two_k)}},
                                         {std::polar(0.7, 2.0), {phase_sensitivity(0, 2, two_k)}}};
  std::vector<double> const one = spectra(std::vector{two_k * two_k}).psd,
                            both = pair_spectrum(spectra, coherent_family(m, spectra.classes(), two)).psd;
  double const power = std::norm(two[0].field + two[1].field);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(both[i], power * one[i], 1e-6 * power * one[i]);
}

// Three paths over two bodies that share part of their motion, against fields added in the time domain: 5 %.
TEST(CoherentFamily, AgreesWithTimeSeries) {
  MotionSet m = moving({gaussian_line(1, 0.2, 8e-8), gaussian_line(0.7, 0.1, 6e-8)});
  m.inputs[0].gains.push_back({BodyId{1}, 2, 0.6});
  std::vector<CoherentPath> const paths = {
      {1.0, {phase_sensitivity(0, 2, two_k)}},
      {std::polar(0.9, 0.8), {phase_sensitivity(1, 2, two_k)}},
      {std::polar(0.5, -1.5), {phase_sensitivity(0, 2, two_k), phase_sensitivity(1, 2, two_k)}}};
  std::vector<double> const edges = {0.5, 1.5, 2.5, 3.5, 5};
  PhaseSpectra const spectra(group_by_shape(m), FrequencyGrid{edges});
  std::vector<double> const exact = pair_spectrum(spectra, coherent_family(m, spectra.classes(), paths)).psd;
  std::vector<double> const seen = band_powers(400, 20, 1024, edges, [&](RandomMotion& a, RandomMotion& b) {
    double const first = a.next(m.inputs[0].spectrum), second = b.next(m.inputs[1].spectrum);
    double const x[2] = {first, 0.6 * first + second};
    std::complex<double> sum = 0;
    for (CoherentPath const& p : paths) {
      double phase = 0;
      for (PhaseSensitivity const& l : p.phase_sensitivities) phase += l.d[2] * x[l.body.value];
      sum += p.field * std::polar(1.0, phase);
    }
    return sum;
  });
  double apart = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_LT(deviation(seen[i], exact[i]), 0.05) << edges[i] << " Hz";
  for (CoherentPath const& p : paths)
    apart += std::norm(p.field) * spectra(kappa_of(m, spectra.classes(), p.phase_sensitivities)).psd[0];
  EXPECT_GT(deviation(apart, exact[0]), 0.1);  // control: powers added
}

TEST(UpConversion, MonteCarloInTheTimeDomain) {  // A5: 5 % up to 10 Hz
  MotionSet const m = moving({gaussian_line(0.2, 0.05, 2e-6)});
  std::vector<double> const edges = {0.5, 1.5, 4, 6, 9, 11};
  std::vector<double> const exact = fringe_psd(m, edges);
  std::vector<double> const seen = band_powers(120, 40, 4096, edges, [&](RandomMotion& a, RandomMotion&) {
    return std::polar(1.0, two_k * a.next(m.inputs[0].spectrum));
  });
  for (std::size_t i : {0u, 2u, 4u}) EXPECT_LT(deviation(seen[i], exact[i]), 0.05) << edges[i] << " Hz";
}

}  // namespace
}  // namespace straytrace::testing::noise_known_phases
