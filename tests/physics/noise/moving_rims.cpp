// SPDX-License-Identifier: BSD-3-Clause
// Noise of rims that move in the main beam: docs/theory/diffraction.md, eq. N.21.
#include <cmath>

#include "noise/project/static_phase.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

constexpr double removed = 1 - 0.8557401455, slope = -375.57728;  // of N.11: w 1, a 1.2, d 0.5 mm
constexpr double curvature = -4e5;                                // per m^2

// Stray fields in the light join with other responses than what the main beam loses as it passes.
class Passing final : public Interferometer {
 public:
  std::complex<double> strain_per_phase(PortId, double) const override { return 5; }
  std::complex<double> strain_per_amplitude(PortId, double) const override { return 7; }
  std::optional<std::complex<double>> strain_per_passing_amplitude(PortId, double) const override { return known_; }
  double copies(PortId) const override { return 1; }
  std::string description() const override { return "h = 3 i Re s of the light that passes"; }
  std::optional<std::complex<double>> known_ = std::complex<double>(0, 3);
};
constexpr double response = 3;

PathRecord term(RimTerm of, double weight, std::vector<PhaseSensitivity> s) {
  PathRecord r = record(0, weight, std::move(s));
  r.event = std::uint32_t(of);
  return r;
}
// A rim whose field has these derivatives by z of body 0.
CouplingClass rim(double first, double second) {
  std::vector<PathRecord> records{term(RimTerm::first, removed * removed, {phase_sensitivity(0, 2, first / removed)})};
  if (second != 0)
    records.push_back(term(second > 0 ? RimTerm::second_plus : RimTerm::second_minus, 0,
                           {phase_sensitivity(0, 2, std::sqrt(std::fabs(second) / removed))}));
  CouplingClass c = known_class(1, removed * removed, std::move(records));
  c.kind = ClassKind::rim;
  return c;
}
NoiseBudget budget(CouplingClass const& c, MotionSet const& motion, std::vector<double> edges) {
  return project_noise(known_table({c}), motion, Passing(), on(std::move(edges)));
}
double power(NoiseBudget const& b, std::size_t bin) { return b.total.psd(bin) * b.grid.width(bin); }

MotionSet sine(double hz, double peak) {
  MotionSet m = moving({Spectrum()});
  m.inputs = {tone(hz, peak)};
  return m;
}

// S_y = |T_am A|^2 S_x: a sine of peak X has X^2/2 in its bin, not halved by a static phase.
TEST(MovingRims, first_order_of_a_sine) {
  double const peak = 1e-9, whole = std::pow(response * slope * peak, 2) / 2;
  double const found = power(budget(rim(slope, 0), sine(10, peak), {5, 15, 25}), 0);
  EXPECT_NEAR(found / whole, 1, 1e-9);
  EXPECT_GT(std::fabs(found / (whole / 2) - 1), 0.9) << "control: the mean over a static phase";
  EXPECT_GT(std::fabs(found / (whole * 25 / 9) - 1), 0.6) << "control: in the phase quadrature";
  EXPECT_EQ(power(budget(rim(slope, 0), sine(10, peak), {5, 15, 25}), 1), 0);
}

TEST(MovingRims, first_order_of_noise) {
  Spectrum const x = power_law_asd(1e-11, 10, -2, 1, 100);
  NoiseBudget const b = budget(rim(slope, 0), moving({x}), {8, 10, 12});
  for (std::size_t i : {0u, 1u})
    EXPECT_NEAR(power(b, i) / (std::pow(response * slope, 2) * x.power(b.grid.edges[i], b.grid.edges[i + 1])), 1, 1e-9);
  EXPECT_NEAR(b.total.phase_asd[0], 0, 1e-30);
  EXPECT_EQ(b.total.linear_share[0], 1);
}

// A centred rim: 1/2 A' x^2 of a sine is a line of peak A' X^2/4 at twice its frequency.
TEST(MovingRims, second_order_of_a_sine) {
  double const peak = 1e-6, line = std::pow(response * curvature * peak * peak / 4, 2) / 2;
  NoiseBudget const b = budget(rim(0, curvature), sine(10, peak), {5, 15, 25});
  EXPECT_NEAR(power(b, 1) / line, 1, 1e-9);
  EXPECT_EQ(power(b, 0), 0) << "control: nothing at the frequency of the motion";
}

// Two tones: lines A' X_1 X_2/2 at the sum and the difference.
TEST(MovingRims, second_order_of_two_tones) {
  MotionSet m = sine(10, 1e-6);
  m.inputs.push_back(tone(13, 2e-6));
  NoiseBudget const b = budget(rim(0, curvature), m, {2, 4, 22, 24});
  double const line = std::pow(response * curvature * 2e-12 / 2, 2) / 2;
  for (std::size_t i : {0u, 2u}) EXPECT_NEAR(power(b, i) / line, 1, 1e-9) << i;
}

// Gaussian motion: S = A'^2/4 (S_x * S_x). Flat from 0 to B the convolution is S_x^2 (2B - f), in total A'^2 sigma^4/2.
TEST(MovingRims, second_order_of_flat_noise) {
  double const band = 100, psd = 1e-14;
  MotionSet const m = moving({Spectrum({1e-3, band}, {psd, psd})});
  NoiseBudget const b = budget(rim(0, curvature), m, logarithmic_grid(1, 200, 60).edges);
  double total = 0;
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    double const f = 0.5 * (b.grid.edges[i] + b.grid.edges[i + 1]);
    double const exact = std::pow(response * curvature, 2) / 4 * psd * psd * (2 * band - f);
    if (f < 190) {
      EXPECT_NEAR(b.total.psd(i) / exact, 1, 0.02) << f;
    }
    total += power(b, i);
  }
  double const sigma2 = psd * band;
  EXPECT_NEAR(total / (std::pow(response * curvature * sigma2, 2) / 2), 1, 0.02);
  EXPECT_LT(b.total.linear_share[50], 1e-12) << "control: nothing of it is of first order";
}

// Two axes: independent motion adds in power, the same motion as fields, and of opposite signs cancels.
TEST(MovingRims, second_order_of_two_axes) {
  Spectrum const x = power_law_asd(1e-7, 10, -1, 1, 100);
  auto const square = [&](MotionSet const& m, RimTerm second) {
    CouplingClass c = rim(0, curvature);
    PhaseSensitivity other = phase_sensitivity(0, 2, 0);
    other.d[0] = std::sqrt(-curvature / removed);
    c.records.push_back(term(second, 0, {other}));
    return power(budget(c, m, {20, 21}), 0);
  };
  double const one = power(budget(rim(0, curvature), moving({x}), {20, 21}), 0);
  MotionSet together = moving({x}), apart = moving({x});
  together.inputs[0].gains.push_back({BodyId{0}, 0, 1});
  apart.inputs.push_back({"x", x, 0, {{BodyId{0}, 0, 1}}});
  EXPECT_NEAR(square(apart, RimTerm::second_minus) / one, 2, 1e-6);
  EXPECT_NEAR(square(together, RimTerm::second_minus) / one, 4, 1e-6);
  EXPECT_LT(square(together, RimTerm::second_plus) / one, 1e-6);
}

TEST(MovingRims, unknown_response_is_refused) {
  Passing unknown;
  unknown.known_.reset();
  EXPECT_THROW(project_noise(known_table({rim(slope, 0)}), sine(10, 1e-9), unknown, on({5, 15})), InputError);
}

// In time: the same line beside a path that does not move.
TEST(MovingRims, series_agree) {
  CouplingClass still = known_class(2, 1e-20, {record(0, 1e-20, {phase_sensitivity(0, 2, 1e-3)})});
  CouplingTable const table = known_table({rim(slope, curvature), still});
  double const peak = 1e-5;
  TimeDomainSettings s;
  s.paths.routes = {0, 1};
  s.duration = 8;
  s.rate = 1024;
  s.band_low = 3;
  StrayLight const light = stray_light(table, sine(8, peak), Passing(), s);
  auto const line = [&](double hz) {
    std::complex<double> sum = 0;
    for (std::size_t i = 2048; i < 6144; ++i)  // far from both ends
      sum += light.h[i] * std::polar(1.0, -2 * pi * hz * double(i) / 1024);
    return 2 * std::norm(sum / 4096.0);
  };
  EXPECT_NEAR(line(8) / (std::pow(response * slope * peak, 2) / 2), 1, 1e-3);
  EXPECT_NEAR(line(16) / (std::pow(response * curvature * peak * peak / 4, 2) / 2), 1, 1e-2);
}

}  // namespace
}  // namespace straytrace::testing
