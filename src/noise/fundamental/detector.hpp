// SPDX-License-Identifier: BSD-3-Clause
// Parameters of the fundamental noises of an interferometer. SI units; temperatures in K. NaN: not given.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math/constants.hpp"
#include "ifo/interferometer.hpp"
#include "ifo/network.hpp"

namespace straytrace::noise {

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

}  // namespace straytrace::noise
