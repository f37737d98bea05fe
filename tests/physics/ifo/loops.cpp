// SPDX-License-Identifier: BSD-3-Clause
// Demodulation and loops: docs/theory/interferometer.md, eq. 6.10, R2.12 and R2.14.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/every_module.hpp"
#include "ifo/network.hpp"
#include "physics/ifo/demodulated.hpp"
#include "spectra/filters.hpp"
#include "support/recorded.hpp"

namespace straytrace::ifo_loops {
namespace {

using straytrace::testing::demodulated;

// A = 1, B = 0.1, phase 0.3 between carrier and sideband: I, Q and the phase, in time and in frequency.
TEST(Demodulation, HeterodyneR2_12) {
  double const a = 1, b = 0.1, phase = 0.3;
  for (double const hz : {6e6, 8e6, 56e6, 112e6}) {
    std::array<double, 2> const carriers = {0, hz};
    std::array<Phasor, 2> const light = {a, std::polar(b, -phase)};  // exp(-i w t): the beat is cos(w t + phase)
    std::vector<double> power;
    for (int i = 0; i < 64; ++i) power.push_back(a * a + b * b + 2 * a * b * std::cos(2 * pi * i / 16 + phase));
    double const i1 = demodulated(carriers, light, hz, 0), q1 = demodulated(carriers, light, hz, pi / 2);
    double const i2 = demodulated(power, 16 * hz, hz, 0), q2 = demodulated(power, 16 * hz, hz, pi / 2);
    EXPECT_NEAR(i1, 0.095534, 5e-7);
    EXPECT_NEAR(q1, 0.029552, 5e-7);
    EXPECT_NEAR(i2, i1, 1e-12);
    EXPECT_NEAR(q2, q1, 1e-12);
    EXPECT_NEAR(std::atan2(q1, i1), 0.3, 1e-12);
    EXPECT_GT(std::fabs(demodulated(carriers, light, hz, -pi / 2) - q1), 0.05) << "control: the sign of Q";
  }
}

// A modulated beam that a short unbalanced Michelson turns into amplitude: the network against the sampled power.
TEST(Demodulation, NetworkAgainstTimeSeriesR2_12) {
  double const unit = 1e6;
  Network n(1064e-9);
  ComponentId const laser = n.add_laser("laser", 1), slow = n.add_modulator("6 MHz", 0.2, 6 * unit),
                    fast = n.add_modulator("56 MHz", 0.1, 56 * unit, 2),
                    splitter = n.add_splitter("splitter", {.transmission = 0.5}), x = n.add_mirror("x", {}),
                    y = n.add_mirror("y", {}), diode = n.add_dump("diode");
  n.link({laser, 0}, {slow, 0}, 0);
  n.link({slow, 1}, {fast, 0}, 0);
  n.link({fast, 1}, {splitter, 0}, 0);
  n.link({splitter, 2}, {x, 0}, 1.3, 0.4);
  n.link({splitter, 1}, {y, 0}, 0.9);
  n.link({splitter, 3}, {diode, 0}, 0);
  SteadyField const field(n);
  std::uint32_t const port = n.number_of({diode, 0});
  std::vector<double> power;
  constexpr int samples = 1024;  // of one microsecond: all carriers are whole multiples of 1 MHz
  for (int i = 0; i < samples; ++i) {
    Phasor sum = 0;
    for (std::size_t c = 0; c < field.carriers().size(); ++c)
      sum += field.in(port, c) * std::polar(1.0, -2 * pi * field.carriers()[c] * i / (samples * unit));
    power.push_back(std::norm(sum));
  }
  for (double const mhz : {6.0, 12.0, 50.0, 56.0, 62.0, 112.0})
    for (double const phase : {0.0, 1.0, pi / 2}) {
      double const sampled = demodulated(power, samples * unit, mhz * unit, phase);
      EXPECT_NEAR(demodulated(field, port, mhz * unit, phase), sampled, 1e-14) << mhz;
    }
  EXPECT_GT(std::hypot(demodulated(field, port, 56 * unit, 0), demodulated(field, port, 56 * unit, pi / 2)), 1e-3)
      << "there is something to see";
}

TEST(Loops, SuppressionR2_14) {
  EXPECT_NEAR(std::abs(suppression(9)), 0.1, 1e-15);
  EXPECT_GT(std::abs(suppression(-0.9)), 9) << "control: the sign of the loop";
  TransferFunction const integrator({}, {0}, 100);  // unity gain at 100 Hz
  EXPECT_NEAR(std::abs(suppression(integrator(100))), 1 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(std::abs(suppression(integrator(1))), 0.01, 1e-6);
  EXPECT_EQ(suppression(TransferFunction()(10)), 1.0);
}

TEST(Loops, ZerosPolesAndTables) {
  TransferFunction const pole({}, {10}, 5), lead({10}, {}, 0.2);
  EXPECT_NEAR(std::abs(pole(10)), 5 / std::sqrt(2), 1e-12);
  EXPECT_NEAR(std::arg(pole(10)), pi / 4, 1e-12);  // exp(-i w t): a low pass turns forward
  EXPECT_NEAR(std::abs(pole(33) * lead(33) - 1.0), 0, 1e-12);
  std::vector<double> hz;
  std::vector<std::complex<double>> values;
  for (int i = 0; i <= 60; ++i) {
    hz.push_back(std::pow(10, i / 20.0));
    values.push_back(std::pow(pole(hz.back()), 5));  // turns by more than pi: phases must be unwrapped
  }
  TransferFunction const table("loop.txt", hz, values);
  for (double const f : {1.0, 3.3, 9.7, 80.0, 1000.0})
    EXPECT_LT(std::abs(table(f) / std::pow(pole(f), 5) - 1.0), 0.01) << f;
  EXPECT_THROW(table(0.9), InputError);
  EXPECT_THROW(table(1001), InputError);
}

}  // namespace
}  // namespace straytrace::ifo_loops
