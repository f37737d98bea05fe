// SPDX-License-Identifier: BSD-3-Clause
// The fundamental noises of a whole detector against closed forms (docs/theory/sensitivity.md, eq. 12.6, 12.7, 12.9) in
// their limits.
#include "noise/fundamental/budget.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "physics/noise/fundamental/closed_forms.hpp"
#include "physics/noise/support.hpp"

namespace straytrace::testing {
namespace {

// No losses, no signal recycling, small transmission: what eq. 12.6 assumes.
Detector lossless(double transmission = 1e-4) {
  Detector d;
  d.arm_length = 3000;
  d.wavelength = 1.064e-6;
  d.arm_power = 650e3;
  d.input = {transmission, 1420, not_a_number, not_a_number, {}};
  d.end = {0, 1683, not_a_number, not_a_number, {}};
  d.power_recycling = 1;
  d.mirror_mass = 42;
  return d;
}

double quantum_at(Detector const& d, double hz) { return std::sqrt(quantum_psd(d, std::vector<double>{hz})[0]); }

TEST(QuantumNetwork, KimbleWithoutSignalRecycling) {  // eq. 12.6, tolerance 1e-3 (T/2 is the size of its error)
  Detector const d = lossless();
  for (double const hz : {3.0, 10.0, 100.0}) {
    double const form = closed_forms::quantum(1.064e-6, 3000, 42, 1e-4, 650e3, hz);
    EXPECT_LT(deviation(quantum_at(d, hz), form), 1e-3) << hz;
  }
  EXPECT_GT(deviation(quantum_at(d, 3), closed_forms::quantum(1.064e-6, 3000, 21, 1e-4, 650e3, 3)),
            0.1);  // negative control
}

TEST(QuantumNetwork, ShotNoiseAlone) {  // eq. 12.2 with F = 2 pi/T, P at the splitter = P_arm T/2, to 1e-3
  Detector const d = lossless();
  for (double const hz : {3.0, 100.0}) {
    double const form = closed_forms::shot(1.064e-6, 3000, 2 * pi / 1e-4, 650e3 * 1e-4 / 2, hz);
    EXPECT_LT(deviation(std::sqrt(shot_psd(d, std::vector<double>{hz})[0]), form), 1e-3) << hz;
  }
  EXPECT_GT(quantum_at(d, 3), 2 * std::sqrt(shot_psd(d, std::vector<double>{3})[0]));  // control: mirrors that move
}

TEST(QuantumNetwork, SqueezedLight) {  // 10 dB: noise down by sqrt(10) where shot noise rules, up below
  Detector d = lossless();
  double const high = quantum_at(d, 1000), low = quantum_at(d, 3);
  d.squeezer = Squeezer{};
  d.squeezer->decibels = 10;
  EXPECT_NEAR(high / quantum_at(d, 1000), std::sqrt(10), 0.01);
  EXPECT_NEAR(quantum_at(d, 3) / low, std::sqrt(10), 0.01);
  d.squeezer->angle = pi / 2;  // control: the other quadrature
  EXPECT_NEAR(quantum_at(d, 1000) / high, std::sqrt(10), 0.01);
  d.squeezer = Squeezer{};
  d.squeezer->decibels = 10;
  d.squeezer->loss = 0.5;
  EXPECT_NEAR(high / quantum_at(d, 1000), 1 / std::sqrt(0.55), 0.005);
}

TEST(QuantumNetwork, LossOfDetection) {  // shot noise as 1/sqrt(efficiency)
  Detector d = lossless();
  double const all = quantum_at(d, 1000);
  d.detection_efficiency = 0.81;
  EXPECT_NEAR(quantum_at(d, 1000) / all, 1 / 0.9, 1e-3);
}

TEST(QuantumNetwork, SignalRecyclingWidensTheBand) {  // eq. 6.8: the pole of the differential mode
  Detector d = lossless(0.014);
  double const plain = quantum_at(d, 1000);
  d.signal_recycling = 0.2;
  EXPECT_LT(quantum_at(d, 1000), 0.5 * plain);
  d.signal_detuning = 0.5;  // detuned: an optical spring and a dip, different from both
  EXPECT_GT(deviation(quantum_at(d, 1000), plain), 0.1);
}

SuspensionChain one_pendulum(double bulk_loss) {
  WireMaterial steel{7800, 486, 49, 0, 0, bulk_loss, 212e9, 0};
  SuspensionStage upper, mirror;
  mirror.mass = 42;
  mirror.length = 0.7;
  mirror.wires = 4;
  mirror.wire_radius = 50e-6;
  mirror.temperature = mirror.upper_temperature = 300;
  mirror.upper = mirror.lower = steel;
  return {{mirror}, 0};
}

TEST(Suspension, OneStageIsThePendulum) {  // eq. 12.9 with the loss diluted by length over bending length, to 2 %
  SuspensionChain const chain = one_pendulum(1e-4);
  double const tension = 42 * 9.80665 / 4, bend = std::sqrt(212e9 * pi * std::pow(50e-6, 4) / 4 / tension);
  double const resonance = std::sqrt(9.80665 / (0.7 - 2 * bend)) / (2 * pi), loss = 1e-4 * bend / 0.7;
  for (double const hz : {5.0, 10.0, 30.0}) {
    double const form = closed_forms::pendulum(300, 42, resonance, loss, hz);
    EXPECT_LT(deviation(std::sqrt(suspension_thermal_psd(chain, hz)), form), 0.02) << hz;
  }
  EXPECT_LT(deviation(std::sqrt(seismic_transfer_squared(chain, 10)), std::pow(resonance / 10, 2)), 0.01);
}

TEST(Suspension, ViolinModes) {  // first mode at sqrt(T/(rho A))/2L, to 1 %
  SuspensionChain const chain = one_pendulum(1e-4);
  double const speed = std::sqrt(42 * 9.80665 / 4 / (7800 * pi * 50e-6 * 50e-6));
  double best = 0, where = 0;
  for (double hz = 200; hz < 1200; hz += 0.5)
    if (double const p = suspension_thermal_psd(chain, hz) * std::pow(hz, 5); p > best) best = p, where = hz;
  EXPECT_NEAR(where / (speed / 1.4), 1, 0.01);
}

TEST(Suspension, DissipationSumsToTheImaginaryCompliance) {  // one temperature: S = 4 kT Im(x/F)/w, to 1e-9
  SuspensionChain chain = one_pendulum(1e-4);
  SuspensionStage above = chain.stages[0];
  above.wire_radius = 200e-6;
  above.vertical_spring = 2000;
  above.blade = 4e-3;
  above.blades = above.upper;
  chain.stages.insert(chain.stages.begin(), above);
  for (Direction const d : {Direction::horizontal, Direction::vertical})
    for (double const hz : {0.3, 2.0, 20.0}) {
      ChainResponse const r = chain_response(chain, d, hz);
      double const all = 4 * boltzmann * 300 * -r.compliance.imag() / (2 * pi * hz);
      EXPECT_LT(deviation(r.thermal_psd, all), 1e-9);
      EXPECT_GT(deviation(r.thermal_psd, 2 * all), 0.4);  // control: a two-sided density
    }
}

SubstrateMaterial silica() {
  SubstrateMaterial m;
  m.temperature = 295, m.young = 7.27e10, m.poisson = 0.167, m.density = 2200, m.expansion = 3.9e-7;
  m.heat_capacity = 739, m.conductivity = 1.38, m.index = 1.45, m.loss = 1e-8, m.loss_exponent = 0, m.surface_loss = 0;
  m.index_slope = 8.5e-6;
  return m;
}

TEST(Substrate, HalfSpaceLimit) {  // eq. 12.7 for w much smaller than the mirror, to 3 %
  double const w = 0.01;
  double const large = std::sqrt(substrate_brownian_psd(silica(), {0.5, 0.5}, w, 100)),
               form = closed_forms::substrate_brownian(295, 7.27e10, 0.167, 1e-8, w, 100);
  EXPECT_LT(deviation(large, form), 0.03);
  double const control = closed_forms::substrate_brownian(295, 7.27e10, 0.167, 1e-8, w * std::sqrt(2), 100);
  EXPECT_GT(deviation(large, control), 0.1);  // 1/e^2 radius, not 1/e
}

TEST(Substrate, ThermoElasticHalfSpace) {  // Braginsky, Gorodetsky and Vyatchanin 1999, to 3 %
  SubstrateMaterial const m = silica();
  double const w = 0.01, r0 = w / std::sqrt(2), omega = 2 * pi * 100;
  double const form = 8 / std::sqrt(2 * pi) * std::pow(m.expansion * (1 + m.poisson), 2) * m.conductivity * boltzmann *
                      m.temperature * m.temperature /
                      (std::pow(m.heat_capacity * m.density, 2) * std::pow(r0, 3) * omega * omega);
  EXPECT_LT(deviation(substrate_thermoelastic_psd(m, {0.5, 0.5}, w, 100), form), 0.03);
}

TEST(Substrate,
     HeatFlowsAwayInColdCrystals) {  // Cerdonio et al. 2001: 1 - 2/sqrt(pi x) for x = w rho C r0^2/kappa large
  SubstrateMaterial m = silica();
  double const w = 0.05, r0 = w / std::sqrt(2), omega = 2 * pi * 10;
  auto const adiabatic = [&](double conductivity) {  // PSD over conductivity: proportional to what is left
    m.conductivity = conductivity;
    return substrate_thermoelastic_psd(m, {0.17, 0.2}, w, 10) / conductivity;
  };
  double const none = adiabatic(1e-4);
  for (double const x : {1e3, 1e4}) {
    double const left = adiabatic(omega * m.density * m.heat_capacity * r0 * r0 / x) / none;
    EXPECT_NEAR(left, 1 - 2 / std::sqrt(pi * x), 1e-3) << x;
    EXPECT_GT(std::fabs(left - 1), 5e-3);  // control: adiabatic
  }
  EXPECT_LT(adiabatic(omega * m.density * m.heat_capacity * r0 * r0 / 0.1) / none, 0.05);
}

TEST(Substrate, ThermoRefractiveAdiabatic) {  // Braginsky and Vyatchanin 2004, eq. 5.3, above all relaxation
  SubstrateMaterial const m = silica();
  double const w = 0.05, r0 = w / std::sqrt(2), rate = 2 * pi * 100 * m.density * m.heat_capacity;
  double const form = 4 * 0.2 * std::pow(m.index_slope * m.temperature, 2) * m.conductivity * boltzmann /
                      (pi * std::pow(r0, 4) * rate * rate);
  EXPECT_LT(deviation(substrate_thermorefractive_psd(m, 0.2, w, 100), form), 1e-3);
}

Detector coated() {
  Detector d = lossless();
  d.substrate = silica();
  d.coating = Detector::Coating{{70e9, 0.19, 1.45, 1.64e6, 1.38, 5.1e-7, 8e-6, 2.3e-5, 0},
                                {120e9, 0.29, 2.09, 2.1e6, 33, 3.6e-6, 1.4e-5, 3.9e-4, 0.1}};
  d.end = {5e-6, 1683, 0.27, 0.5, {}};
  return d;
}

TEST(Coating, ReachesItsTransmission) {
  Detector const d = coated();
  CoatingStack const s = coating_stack(d, d.end);
  EXPECT_LT(deviation(1 - std::norm(reflection(s).amplitude), 5e-6), 1e-4);
  EXPECT_GT(s.layers.size(), 30u);
}

TEST(Coating, SlopeOfTheReflection) {  // d ln r/d phase of each layer against finite differences, 1e-6
  Detector const d = coated();
  CoatingStack s = coating_stack(d, {0.01, 1420, 0.3, 0.5, {}});
  StackReflection const r = reflection(s);
  for (std::size_t i = 0; i < s.layers.size(); i += 3) {
    double const step = 1e-6;
    CoatingStack more = s;
    more.layers[i] += step / (2 * pi);
    std::complex<double> const slope = std::log(reflection(more).amplitude / r.amplitude) / step;
    EXPECT_NEAR(std::abs(slope - r.log_slope[i]), 0, 1e-5);
  }
}

TEST(Coating, OrderOfMagnitude) {  // eq. 12.8 is an order of magnitude: within a factor of 2
  Detector const d = coated();
  CoatingStack const s = coating_stack(d, d.end);
  double thickness = 0, lossy = 0;
  for (std::size_t i = 0; i < s.layers.size(); ++i) {
    thickness += s.thickness(i);
    lossy += s.thickness(i) * s.material(i).loss;
  }
  double const form = closed_forms::coating_brownian(295, 7.27e10, 0.167, lossy / thickness, thickness, 0.06, 100);
  double const full = std::sqrt(coating_brownian_psd(s, 0.06, 100));
  EXPECT_GT(full / form, 0.5);
  EXPECT_LT(full / form, 2);
}

TEST(ResidualGas, UniformTubeAtLowFrequency) {  // flat below v/w: 4 (2 pi alpha)^2 p/(v kT) times the mean of 1/w
  Detector d = lossless();
  d.tube_temperature = 300;
  GasSpecies const h2{"H2", 1e-7, 1e-7, 3.35e-27, 7.8e-31};
  double const slow = gas_scattering_psd(d, h2, 1), speed = std::sqrt(2 * boltzmann * 300 / 3.35e-27);
  EXPECT_LT(deviation(gas_scattering_psd(d, h2, 100), slow), 0.05);
  double const w = d.spots().waist,
               largest = 4 * std::pow(2 * pi * 7.8e-31, 2) * 1e-7 * 3000 / (speed * boltzmann * 300 * w);
  EXPECT_LT(slow, largest);
  EXPECT_GT(slow, largest / 6);
}

TEST(Fundamental, OmitsNoisesWithoutData) {
  FundamentalEntries const all = fundamental_entries(lossless(), std::vector<double>{10, 100});
  ASSERT_EQ(all.entries.size(), 1u);
  EXPECT_EQ(all.entries[0].name, "Quantum");
  EXPECT_EQ(all.left_out.size(), fundamental_noises().size() - 1);
}

TEST(Fundamental, StrainAtHighFrequency) {  // 1/L at low frequency; arms of 40 km lose a few per cent at 1 kHz
  Detector d = lossless();
  EXPECT_LT(deviation(d.strain_per_length_squared(1), 1 / 9e6), 1e-6);
  d.arm_length = 40e3;
  double const normal =
      std::pow(std::sin(2 * pi * 1000 * 40e3 / speed_of_light) / (2 * pi * 1000 * 40e3 / speed_of_light), -2);
  EXPECT_NEAR(d.strain_per_length_squared(1000) * 1.6e9 / normal, 1, 0.01);
}

}  // namespace
}  // namespace straytrace::testing
