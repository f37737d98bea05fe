// SPDX-License-Identifier: BSD-3-Clause
// Sensors on the beams of ports: docs/theory/time_domain.md, eq. N.22 to N.24.
#include "base/math/rng.hpp"
#include "ifo/network.hpp"
#include "noise/project/sensor_noise.hpp"
#include "noise/time_domain/time_domain.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

constexpr double coupling = 4e-10;

// Two ports, each with one path that body 0 moves.
CouplingTable two_ports() {
  CouplingTable t = known_table({known_class(1, coupling, {record(1, 1, {phase_sensitivity(0, 2, two_k)})}),
                                 known_class(2, 9 * coupling, {record(2, 1, {phase_sensitivity(0, 2, two_k)})})});
  t.ports = {"A", "B"};
  t.classes[1].port = PortId{1};
  return t;
}

NoiseSettings band() {
  NoiseSettings s;
  s.grid = logarithmic_grid(5, 50, 10);
  return s;
}

// Small motion: dP/P = 2 Re s and phase Im s with the mean S = C f (2k)^2 S_x/2 of either quadrature.
TEST(Sensors, SmallMotionN22) {
  double const level = 1e-12;  // m/sqrt(Hz)
  MotionSet const motion = moving({power_law_asd(level, 10, 0, 1, 100)});
  CouplingTable const table = two_ports();
  auto const asd = [&](std::uint32_t port, SensorKind kind) {
    SensorNoise const n = sensor_noise(table, motion, band(), PortId{port}, kind);
    EXPECT_EQ(n.routes.size(), 1u);
    return n.budget.total.asd[5];
  };
  double const field = std::sqrt(table.classes[0].reverse * coupling), rms = field * two_k * level / std::sqrt(2);
  EXPECT_NEAR(asd(0, SensorKind::phase) / rms, 1, 1e-3);
  EXPECT_NEAR(asd(0, SensorKind::power) / (2 * rms), 1, 1e-3);
  EXPECT_NEAR(asd(0, SensorKind::quadrant) / (2 * rms), 1, 1e-3);
  EXPECT_NEAR(asd(1, SensorKind::power) / (3 * 2 * rms), 1, 1e-3) << "its own port";
  NoiseBudget const both = project_noise(table, motion, UnitDetector(), band());
  EXPECT_GT(both.total.asd[5] / asd(0, SensorKind::phase), 3) << "control: the light of both ports";
}

// A computed route, a ghost for one, has a pattern of its own: a quadrant leaves it out and says so.
TEST(Sensors, QuadrantsLeaveOutComputedRoutes) {
  CouplingTable table = two_ports();
  table.classes[0].kind = ClassKind::ghost;
  MotionSet const motion = moving({power_law_asd(1e-12, 10, 0, 1, 100)});
  EXPECT_EQ(sensor_noise(table, motion, band(), PortId{0}, SensorKind::quadrant).left_out, 1u);
  EXPECT_EQ(sensor_noise(table, motion, band(), PortId{0}, SensorKind::power).left_out, 0u);
}

// In time: power is 2 Re s of the field whose phase channel is Im s; X and Y have the same power and are uncorrelated.
TEST(Sensors, SeriesOfOneRealisation) {
  CouplingTable table = two_ports();
  MotionSet motion = moving({Spectrum()});
  motion.inputs = {tone(10, 1e-6)};
  TimeDomainSettings s;
  s.paths.routes = {0, 1};
  s.duration = 1;
  s.rate = 1024;
  SensorSeries const series = sensor_series(table, motion, s);
  ASSERT_EQ(series.channels.size(), 8u);
  EXPECT_EQ(series.channels[0].name, "A power");
  EXPECT_EQ(series.channels[2].name, "A phase");
  double const field = std::sqrt(table.classes[0].reverse * coupling);
  for (std::size_t i = 0; i < 1024; i += 100)
    EXPECT_NEAR(std::hypot(series.channels[0].samples[i] / 2, series.channels[2].samples[i]) / field, 1, 1e-12);
  EXPECT_NE(series.channels[4].samples[0], series.channels[0].samples[0]) << "static phases of their own";
  EXPECT_NE(series.channels[4].samples[0], series.channels[6].samples[0]);
}

// Eq. N.22, N.23: speckle finer than a round sensor in the middle of its beam. <|s_D|^2> is that of the whole beam over
// eta = 1 - exp(-2 a^2/w^2).
TEST(Sensors, SpeckleOnASmallSensorN23) {
  constexpr int side = 80, draws = 2000;
  constexpr double width = 5, a = 0.6, step = width / side;  // beam radii
  double const eta = 1 - std::exp(-2 * a * a);
  Rng rng(7, 1, 1, Stream::static_phase);
  double whole = 0, cut = 0, on = 0;
  std::vector<double> u;
  std::vector<bool> inside;
  for (int i = 0; i < side; ++i)
    for (int k = 0; k < side; ++k) {
      double const x = (i + 0.5 - side / 2.0) * step, y = (k + 0.5 - side / 2.0) * step;
      u.push_back(std::exp(-x * x - y * y));
      inside.push_back(x * x + y * y < a * a);
    }
  double norm = 0;
  for (std::size_t i = 0; i < u.size(); ++i) norm += u[i] * u[i], on += inside[i] ? u[i] * u[i] : 0;
  EXPECT_NEAR(on / norm, eta, 0.01) << "the grid";
  for (int d = 0; d < draws; ++d) {
    Phasor all = 0, part = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      Phasor const e = std::polar(u[i], 2 * pi * rng.uniform());
      all += e;
      if (inside[i]) part += e;
    }
    whole += std::norm(all) / draws;
    cut += std::norm(part) / (eta * eta) / draws;
  }
  double const error = 5 * std::sqrt(2.0 / draws);  // both exponentially distributed; they share light
  EXPECT_NEAR(cut / whole * eta, 1, error);
  EXPECT_GT(std::fabs(1 * eta - 1), 2 * error) << "control: the formula without the cut";

  Sensor const sensor{"PD", PortId{0}, eta, {}};
  CouplingTable const table = two_ports(), small = cut_by({&sensor, 1}, table);
  MotionSet const motion = moving({power_law_asd(1e-12, 10, 0, 1, 100)});
  auto const asd = [&](CouplingTable const& t, std::uint32_t port) {
    return sensor_noise(t, motion, band(), PortId{port}, SensorKind::power).budget.total.asd[5];
  };
  EXPECT_NEAR(asd(small, 0) / asd(table, 0), 1 / std::sqrt(eta), 1e-9);
  EXPECT_EQ(asd(small, 1), asd(table, 1)) << "the sensor of another port";
  Sensor const faint{"PD", PortId{0}, 1, {}, 0.01};
  EXPECT_NEAR(asd(cut_by({&faint, 1}, table), 0) / asd(table, 0), 100, 1e-6) << "main light of a hundredth";
}

// P_in of eq. N.22: light without overlap has the tones 2a of its source, of several routes in phase.
TEST(Sensors, LightWithoutOverlap) {
  auto const route = [](double watts, std::uint32_t beam, double delay) {
    CouplingClass c = known_class(1, watts, {record(1, watts, {})});
    c.records[0].beam = beam;
    c.records[0].path_length = delay * speed_of_light;
    return c;
  };
  double const a = 0.01, hz = 20;
  CouplingClass const first = route(1e-3, 0, 0), second = route(2e-3, 0, 0), late = route(2e-3, 0, 0.5 / hz),
                      other = route(5e-3, 1, 0);
  LightModulation const light{{{0, "probe", hz, a, 0, 0}}, {}};
  FrequencyGrid const grid = logarithmic_grid(5, 50, 10);
  std::size_t const bin = grid.bin_of(hz);
  auto const line = [&](std::vector<CouplingClass const*> const& routes) {
    return asd_of(source_lines(routes, light), grid)[bin] * std::sqrt(2 * grid.width(bin));
  };
  EXPECT_NEAR(line({&first}) / (2 * a * 1e-3), 1, 1e-12);
  EXPECT_NEAR(line({&first, &second}) / (2 * a * 3e-3), 1, 1e-12);
  EXPECT_NEAR(line({&first, &late}) / (2 * a * 1e-3), 1, 1e-9) << "half a period late";
  EXPECT_EQ(line({&other}), 0) << "control: light of a steady beam";
  std::vector<CouplingClass const*> const both{&first, &second};
  EXPECT_EQ(asd_of(source_lines(both, light), grid)[0], 0);
  TimeSeries series{"power", "1", 0, 200, std::vector<double>(200)};
  add_lines(series, source_lines(both, light), 10);
  for (std::size_t i = 0; i < 200; i += 7)
    EXPECT_NEAR(series.samples[i], 10 * 2 * a * 3e-3 * std::cos(2 * pi * hz * double(i) / 200), 1e-15) << i;
}

// Eq. N.24: plane waves of all directions up to a finest one, of random phase. Light much finer than the beam is as
// strong in a mode with one half reversed as in the mode itself, and independent there.
TEST(Sensors, SpeckleOnAQuadrantN24) {
  struct Overlap {
    double ratio, correlation;
  };
  auto const overlap = [](double finest) {  // rad per beam radius
    constexpr int samples = 2000, waves = 2001;
    constexpr double width = 8;  // beam radii
    double sum = 0, half = 0;
    Phasor cross = 0;
    for (int k = 0; k < waves; ++k) {
      Phasor whole = 0, reversed = 0;
      double const q = finest * (2.0 * k / (waves - 1) - 1);
      for (int i = 0; i < samples; ++i) {
        double const x = (i + 0.5 - samples / 2.0) * width / samples;
        Phasor const part = std::polar(std::exp(-x * x), q * x);
        whole += part;
        reversed += x > 0 ? part : -part;
      }
      sum += std::norm(whole);
      half += std::norm(reversed);
      cross += whole * std::conj(reversed);
    }
    return Overlap{half / sum, std::abs(cross) / sum};
  };
  double const finer = 4 / (100 * pi * std::sqrt(pi / 2));  // of the reversed mode: its edge scatters as 1/q^2
  EXPECT_NEAR(overlap(100).ratio, 1 - finer, 1e-3);
  EXPECT_LT(overlap(100).correlation, 1e-6);
  EXPECT_LT(overlap(0.5).ratio, 0.2) << "control: light as smooth as the beam";
}

}  // namespace
}  // namespace straytrace::testing
