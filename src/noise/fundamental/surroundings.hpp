// SPDX-License-Identifier: BSD-3-Clause
// Disturbances of test masses and beams from outside: ground motion, gravity of ground and air, residual gas.
#pragma once

#include <span>
#include <string_view>

#include "noise/fundamental/detector.hpp"

namespace straytrace::noise {

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

}  // namespace straytrace::noise
