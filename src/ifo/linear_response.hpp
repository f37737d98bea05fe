// SPDX-License-Identifier: BSD-3-Clause
// What small motion, stray light, forces and the vacuum do to a read-out of an interferometer, at one Fourier frequency
// (docs/theory/arm.md and docs/theory/interferometer.md). Around each carrier stand two sidebands; light pushes mirrors
// and moving mirrors change light, so radiation pressure, optical springs and recycling are in. Quantities go as Re(X
// exp(-2 pi i f t)).
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "ifo/network.hpp"
#include "ifo/squeezed_light.hpp"

namespace straytrace {

// What is read: linear in the sidebands that enter a port.
struct Readout {
  // Power, W, of the light that enters this port.
  static Readout power(std::uint32_t port) { return {port, Kind::power, 0, 0}; }
  // Beat with a strong local oscillator of phase `angle` (rad), sqrt(W): e^{-i angle} a + e^{i angle} b.
  static Readout homodyne(std::uint32_t port, double angle) { return {port, Kind::homodyne, angle, 0}; }
  // Power demodulated at `hz` with cos(2 pi hz t + phase) and averaged, W (eq. 6.10).
  static Readout demodulated(std::uint32_t port, double hz, double phase) {
    return {port, Kind::demodulated, phase, hz};
  }
  // Sum of displacements of components, m, each with a factor.
  static Readout motion(std::vector<std::pair<ComponentId, double>> of) {
    return {0, Kind::motion, 0, 0, std::move(of)};
  }
  enum class Kind : std::uint8_t { power, homodyne, demodulated, motion };
  std::uint32_t port = 0;
  Kind kind = Kind::power;
  double angle = 0, hz = 0;
  std::vector<std::pair<ComponentId, double>> moving{};
};

// The demodulated light itself, W: what a lock looks at. Light by carriers, sqrt(W) and Hz.
double demodulated(std::span<double const> carriers, std::span<Phasor const> light, double hz, double phase);
double demodulated(SteadyField const&, std::uint32_t port, double hz, double phase);
// The same of a sampled power, W, at a constant rate, Hz: mean of P cos(2 pi hz t + phase) over whole periods.
double demodulated(std::span<double const> power, double rate, double hz, double phase);

// Squeezed vacuum instead of the vacuum that leaves a dump (or laser) at this port of it, about carrier 0. Its first
// quadrature is the one at `angle`, rad.
struct Squeezing {
  std::uint32_t port = 0;
  QuadratureCovariance covariance = QuadratureCovariance::Identity();
  double angle = 0;
};

// Stray light that joins what enters or what leaves a port, as a share of what enters or leaves it; `turn`: phase, rad,
// on the way back.
struct Injection {
  std::uint32_t port = 0;
  bool joins_leaving = false, of_leaving = false;
  double turn = 0;
};

class LinearResponse {
 public:
  // One solution answers for every cause.
  LinearResponse(Network const&, SteadyField const&, Readout const&, double hz);

  Phasor to_displacement(ComponentId) const;  // per m that an actuator or the ground adds
  Phasor to_force(ComponentId) const;         // per N
  // Stray field s (docs/theory/interferometer.md), of what enters this port of a component unless said otherwise: s = i
  // e for phase, s = e for amplitude. Carriers get it alike.
  Phasor to_phase(std::uint32_t port) const { return to_phase(Injection{port}); }
  Phasor to_amplitude(std::uint32_t port) const { return to_amplitude(Injection{port}); }
  Phasor to_phase(Injection const&) const;
  Phasor to_amplitude(Injection const&) const;
  // Angle of the quadrature of what leaves a dump (or laser) that the read-out sees most of: the one to squeeze.
  double seen_quadrature(std::uint32_t port) const;
  // One-sided PSD of the read-out from the vacuum that enters at losses and open ports, squared units per Hz.
  double quantum_noise(std::span<Squeezing const> = {}) const;

 private:
  Phasor injected(Injection const&, Phasor upper, Phasor lower) const;
  Phasor of_leaving(std::uint32_t port, int side) const;  // weight around carrier 0

  Network const& network_;
  SteadyField const& field_;
  double hz_;
  Eigen::VectorXcd weight_;  // of every equation in the read-out
};

}  // namespace straytrace
