// SPDX-License-Identifier: BSD-3-Clause
// The fundamental noises of a detector as a list of named functions (docs/theory/sensitivity.md).
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math/constants.hpp"
#include "ifo/dual_recycled.hpp"
#include "ifo/interferometer.hpp"
#include "ifo/network.hpp"

namespace straytrace::noise {

// Parameters of the fundamental noises of an interferometer. SI units; temperatures in K. NaN: not given.

// Of wires, fibres and blades.
struct WireMaterial {
  double density = not_a_number, heat_capacity = not_a_number,
         conductivity = not_a_number;                             // kg/m^3, J/(kg K), W/(m K)
  double expansion = not_a_number, modulus_slope = not_a_number;  // 1/K, (dY/dT)/Y
  double loss = not_a_number, young = not_a_number;               // loss angle, Pa
  double surface_depth = 0;  // m: surface losses count like bulk losses of this depth
};

// One mass and its suspension.
struct SuspensionStage {
  double mass = not_a_number, length = not_a_number;            // kg, m
  double wires = not_a_number, wire_radius = not_a_number;      // of each wire, m
  double dilution = not_a_number;                               // NaN: length over bending length
  double vertical_spring = not_a_number, blade = not_a_number;  // N/m and thickness in m of the blades; NaN: no blades
  double temperature = not_a_number, upper_temperature = not_a_number;  // of the lower and the upper joints
  WireMaterial upper{}, lower{}, blades{};
  double ribbon_thickness = not_a_number;                       // ribbons: wire_radius is their width
  double end_radius = not_a_number, end_length = not_a_number;  // tapered fibres: thicker ends
};

struct SuspensionChain {
  std::vector<SuspensionStage> stages;      // from the top to the test mass
  double vertical_coupling = not_a_number;  // rad: vertical motion seen along the beam
};

struct SubstrateMaterial {
  double temperature = not_a_number, young = not_a_number, poisson = not_a_number, density = not_a_number;
  double expansion = not_a_number, heat_capacity = not_a_number, conductivity = not_a_number, index = not_a_number;
  double loss = not_a_number, loss_exponent = not_a_number;  // loss angle of the bulk = loss (f/1 Hz)^loss_exponent
  double surface_loss = not_a_number;                        // m: loss angle times depth of the surface
  double index_slope = not_a_number;                         // dn/dT, 1/K; NaN: no thermo-refractive noise
};

struct CoatingMaterial {
  double young = not_a_number, poisson = not_a_number, index = not_a_number;
  double heat_capacity = not_a_number, conductivity = not_a_number;  // J/(K m^3), W/(m K)
  double expansion = not_a_number, index_slope = not_a_number;       // 1/K
  double loss = not_a_number, loss_slope = 0;                        // loss angle = loss (f/100 Hz)^loss_slope
  double loss_at(double hz) const;
};

// One mirror. Layers by thickness over the wavelength in them, from the vacuum to the substrate, low index first.
struct CoatedMirror {
  double transmission = not_a_number, curvature = not_a_number;  // power; radius of curvature in m
  double low_layer = not_a_number, cap = not_a_number;  // of the layers, when they are computed from the transmission
  std::vector<double> layers;                           // given, or empty: doublets that reach the transmission
};

struct GasSpecies {
  std::string name;
  double tube_pressure = not_a_number, chamber_pressure = not_a_number;  // Pa
  double mass = not_a_number, polarisability = not_a_number;             // kg, m^3
};

// Ground near the mirrors and platform they hang from.
struct Ground {
  std::string platform = "BSC";  // motion that drives the suspensions, by name: see platform_asd
  // Vertical ground motion as source of gravity gradients: `level` m/sqrt(Hz) up to `knee` Hz, then 1/f^2.
  double knee = not_a_number, level = not_a_number, abruptness = not_a_number;
  double density = not_a_number, rayleigh_speed = not_a_number, p_speed = not_a_number, s_speed = not_a_number;
  double p_level = not_a_number, s_level = not_a_number;  // of the low-noise model
  double height = not_a_number;                           // m above the ground; negative: below
  double subtraction = 1;  // by which feed-forward lowers the amplitude of Rayleigh waves
  bool steeper = false;    // below the knee level knee/f instead of level
};
struct Air {
  double pressure = not_a_number, density = not_a_number, adiabatic_index = not_a_number, sound_speed = not_a_number;
};

struct Detector {
  std::string name;
  double arm_length = not_a_number, wavelength = not_a_number;  // m
  double input_power = not_a_number, arm_power = not_a_number;  // W; one of the two is given
  CoatedMirror input, end;
  double power_recycling = not_a_number, signal_recycling = 1;  // transmission of power; 1: no mirror
  double mirror_loss = 0, splitter_loss = 0, signal_loss = 0;   // per mirror; of round trips: splitter, signal cavity
  double signal_length = 0, signal_detuning = 0;                // m; rad of one round trip
  double readout_angle = pi / 2, detection_efficiency = 1;      // rad, pi/2: the quadrature of the signal
  double mirror_mass = not_a_number;                            // kg
  double mirror_radius = not_a_number, mirror_thickness = not_a_number;  // m
  double tube_temperature = not_a_number;
  std::optional<SuspensionChain> suspension;
  std::optional<SubstrateMaterial> substrate;
  struct Coating {
    CoatingMaterial low, high;
  };
  std::optional<Coating> coating;
  std::vector<GasSpecies> gas;
  std::optional<Ground> ground;
  std::optional<Air> air;
  std::optional<Squeezer> squeezer;

  double circulating_power() const;  // W in one arm, eq. 6.11 unless given
  DetectorNumbers numbers() const;   // characteristic numbers of an interferometer
  struct Spots {
    double input, end;  // 1/e^2 intensity radii on the mirrors, m
    double waist, rayleigh, waist_position;
  };
  Spots spots() const;  // eq. 6.3
  // (dh/dL)^2 in 1/m^2: 1/L^2 at low frequency. Waves that come 15 degrees off the normal of the arm, in the plane of
  // both, as public budgets take them (Schilling 1997): at f = c/2L the response does not vanish.
  double strain_per_length_squared(double hz) const;
};

struct FundamentalNoise {
  std::string_view name;   // as in budget files: letters only
  std::string_view words;  // description
  std::string_view needs;  // parameters that the detector must state
  bool (*known)(Detector const&);
  std::vector<double> (*psd)(Detector const&, std::span<double const> hz);  // strain^2/Hz, one-sided
  std::span<FundamentalNoise const> parts = {};                             // whose PSDs sum to it; empty: no parts
};
std::span<FundamentalNoise const> fundamental_noises();

// Quantum noise of a detector, from the network of its mirrors (ifo/dual_recycled.hpp): includes all losses, radiation
// pressure, optical springs and squeezing.

// Loss of all mirrors of an arm counts at its end mirror; balanced homodyne read-out.
DualRecycledParameters dual_recycled(Detector const&);

// Strain PSD, 1/Hz, one-sided.
std::vector<double> quantum_psd(Detector const&, std::span<double const> hz);
std::vector<double> shot_psd(Detector const&, std::span<double const> hz);  // mirrors held: no radiation pressure
double quantum_limit(double length, double mass, double hz);                // strain ASD, eq. 12.5

// Suspended test masses: response to ground motion, and thermal noise (docs/theory/sensitivity.md, eq. 12.9 for one
// stage).

constexpr double standard_gravity = 9.80665;  // m/s^2

// One direction of a chain of masses and lossy springs, at one frequency. Motion goes as exp(i w t).
struct ChainResponse {
  std::complex<double> from_top;    // test mass per displacement of the support of the chain
  std::complex<double> compliance;  // of the test mass, m/N
  double thermal_psd = 0;           // m^2/Hz of the test mass, one-sided
};
enum class Direction { horizontal, vertical };
// Horizontal: pendulums whose wires lose energy where they bend, dilution by gravity; the last stage with the violin
// modes of its fibres (Gonzalez and Saulson 1994). Vertical: blades, and the stretch of the fibres.
ChainResponse chain_response(SuspensionChain const&, Direction, double hz);

// Thermal noise along the beam of one test mass, m^2/Hz: horizontal, and vertical times the coupling squared.
double suspension_thermal_psd(SuspensionChain const&, double hz);
// |displacement along the beam per displacement of the platform|^2, both directions shaken alike and independently.
double seismic_transfer_squared(SuspensionChain const&, double hz);

// Disturbances of test masses and beams from outside: ground motion, gravity of ground and air, residual gas.

// Motion of the platform of the suspensions, m/sqrt(Hz) (docs/theory/motion.md). "BSC": in-vacuum platform of LIGO,
// straight lines in log-log between the knots; "6D": the same with a six-axis seismometer; "intermediate": geometric
// mean of both; "low", "typical", "high": Peterson's models; "quiet": 1e-7/f^2; "virgo": 1e-6/f^2. NaN: no such name.
double platform_asd(std::string_view name, double hz);
std::span<std::string_view const> platform_names();

// Displacement PSD along the beam of one test mass by gravity of the ground and the air, m^2/Hz (Harms 2019, eq. 35,
// 96, 98; Amann et al. 2020 below ground; 172 for infrasound).
double rayleigh_newtonian_psd(Ground const&, double hz);
double body_wave_newtonian_psd(Ground const&, double hz);
double infrasound_newtonian_psd(Air const&, double hz);

// Length of one arm, m^2/Hz: molecules that cross the beam (Weiss, Zucker and Whitcomb; constant pressure).
double gas_scattering_psd(Detector const&, GasSpecies const&, double hz);
// Force on one free test mass by molecules that hit it, N^2/Hz (Cavalleri et al. 2010); no squeezed film.
double gas_damping_force_psd(Detector const&, GasSpecies const&, double temperature);

// Multilayer coatings: reflection, Brownian and thermo-optic noise. Displacement PSD of one mirror, m^2/Hz, one-sided.

// Thermal noise of substrates: mirrors of finite size under a centred Gaussian beam. Displacement PSD of one mirror,
// m^2/Hz, one-sided; w is the 1/e^2 intensity radius in m.

struct MirrorShape {
  double radius, thickness;  // m
};

// Strain energy per force squared of a static Gaussian pressure, J/N^2 (Bondu, Hello and Vinet 1998; Liu and Thorne
// 2000): S_x = 8 kT phi U/w; half space for a radius and thickness much larger than w: eq. 12.7.
double strain_energy(SubstrateMaterial const&, MirrorShape, double w);
double substrate_brownian_psd(SubstrateMaterial const&, MirrorShape, double w, double hz);
// Liu and Thorne 2000, eq. 46; heat that flows away during a period as in a half space (Cerdonio et al. 2001): cold
// crystals.
double substrate_thermoelastic_psd(SubstrateMaterial const&, MirrorShape, double w, double hz);
// Optical path of one pass through the substrate, m^2/Hz (Braginsky and Vyatchanin 2004, eq. E7): at all frequencies.
double substrate_thermorefractive_psd(SubstrateMaterial const&, double thickness, double w, double hz);

// Zeros of the Bessel function J1, ascending, and J0 there.
struct BesselZeros {
  std::vector<double> zero, j0;
};
BesselZeros const& bessel_zeros();

// Alternating layers, low index first, on the substrate. Thickness over the wavelength in the layer.
struct CoatingStack {
  std::vector<double> layers;
  CoatingMaterial low, high;
  SubstrateMaterial substrate;
  double wavelength;  // m, in vacuum

  CoatingMaterial const& material(std::size_t i) const { return i % 2 == 0 ? low : high; }
  double thickness(std::size_t i) const { return layers[i] * wavelength / material(i).index; }  // m
};

// As given, or doublets under a cap whose last layer is trimmed so that the transmission is reached.
CoatingStack coating_stack(Detector const&, CoatedMirror const&);

struct StackReflection {
  std::complex<double> amplitude;               // seen from the vacuum
  std::vector<std::complex<double>> log_slope;  // d ln(amplitude)/d(one-way phase) of each layer
};
StackReflection reflection(CoatingStack const&);

// Hong et al. 2013 with equal losses in bulk and shear and without photo-elastic effect.
double coating_brownian_psd(CoatingStack const&, double w, double hz);
// Evans et al. 2008 (thick coatings), mirrors of finite size after Braginsky and Vyatchanin 2003.
class CoatingThermoOptic {
 public:
  CoatingThermoOptic(CoatingStack const&, MirrorShape, double w);
  double psd(double hz) const;

 private:
  double elastic_, refractive_;  // m/K
  double thickness_, heat_, conductivity_;
  SubstrateMaterial substrate_;
  double w_;
};

}  // namespace straytrace::noise
