// SPDX-License-Identifier: BSD-3-Clause
// The Hermite-Gauss modes of every beam of a network, and how its components couple them
// (docs/theory/interferometer.md, eq. N.6 to N.11).
#pragma once

#include <Eigen/Core>

#include <array>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "ifo/network.hpp"

namespace straytrace::ifo {

// Coupling of Hermite-Gauss modes where a beam meets another basis, a tilted or curved mirror or a stop
// (docs/theory/interferometer.md, eq. N.6 to N.11).

// Modes u_nm with n + m <= order, by rising n + m, of one sum by rising m: 00, 10, 01, 20, 11, 02, ...
inline int mode_count(int order) { return (order + 1) * (order + 2) / 2; }
inline int mode_index(int n, int m) { return (n + m) * (n + m + 1) / 2 + m; }

// One axis. Complex curvatures 1/RoC + i wavelength/(pi w^2) in 1/m at the surface, for fields that run as
// exp(i k z - i omega t): RoC > 0 diverges.
struct AxisCoupling {
  std::complex<double> in, out;
  double kick =
      0;  // kappa, rad/m: transverse wave number that the surface adds (2 k alpha of a mirror tilted by alpha)
  double shift = 0;  // d, m: of the axis of the incoming basis from that of the outgoing one
};

// K(n, m) for n, m <= order: amplitude of the outgoing mode n for the incoming mode m (N.6). The modes of an axis are
// real but for the curvature of the wavefront: no Gouy phase is in K. `wave_number` in rad/m, in the medium.
// NumericalError unless both curvatures have a positive imaginary part.
Eigen::MatrixXcd axis_coupling(AxisCoupling const&, double wave_number, int order);

// Product of two axes for the modes n + m <= order.
Eigen::MatrixXcd mode_coupling(AxisCoupling const& x, AxisCoupling const& y, double wave_number, int order);

// Stop of radius `radius`, open inside, its centre at `offset` along x and y from the axis of the beam; all in m.
struct CircularStop {
  double radius = 0;
  std::array<double, 2> offset{};
};

// Amplitudes that pass the stop, for radii w of the beam along x and y in m, at the same basis on both sides (N.11).
Eigen::MatrixXd stop_coupling(CircularStop const&, std::array<double, 2> w, int order);

// Resonators of a network: closed ways of light with at most two reflections at normal incidence.

struct NetworkCavity {
  std::string name{};                  // components in the order in which light meets them first: "PRM-BS-ITMx"
  std::vector<std::uint32_t> beams{};  // ports that light leaves on a round trip
  double length = 0;                   // m, of a round trip
  double round_trip = 0;               // amplitude that is left of the carrier after one, without other light
  double phase = 0;                    // rad, of the carrier after one; 0: resonant. Both in plane waves
  double free_spectral_range() const;  // Hz; infinite without length
  double finesse() const;              // eq. 6.5
  double pole() const;                 // Hz, eq. 6.5: half width at half power
};

// Those of at most 24 spaces with a finesse of at least 1, shortest ways first. Either direction of a ring counts once.
// The search ends after 200000 steps: in a network of very many loops there may be more.
std::vector<NetworkCavity> cavities_of(Network const&);

// Complex curvatures 1/RoC + i wavelength/(pi w^2) along x and y of a beam in its own frame, 1/m. x lies in the planes
// of incidence; the frame of the light that runs back has x turned round.
using BeamCurvature = std::array<std::complex<double>, 2>;

// Eigenmode of a resonator, where the light of its first beam leaves.
struct CavityMode {
  NetworkCavity cavity;
  std::array<double, 2> stability{};  // (A + D)/2 of a round trip; of a stable one between -1 and 1
  BeamCurvature curvature{};
  std::array<double, 2> gouy{};  // lag per order and round trip, rad in [0, 2 pi)
  bool turned = false;           // x is turned round on a round trip: odd n get half a turn more (eq. N.10)
  bool stable() const { return std::abs(stability[0]) < 1 && std::abs(stability[1]) < 1; }
  double radius(int axis, double wavelength) const { return std::sqrt(wavelength / (pi * curvature[axis].imag())); }
  double phase_beyond(int n, int m) const;  // rad in [0, 2 pi), of a mode per round trip, beyond that of 00
};
// Without modes where it is not stable.
CavityMode mode_of(Network const&, NetworkCavity const&);

class ModeBases;
// Factor of the carrier after a round trip, in the modes of the bases: the eigenvalue of the round trip whose mode has
// the largest share of 00. It is smaller than that of plane waves by what apertures stop and modes beyond the order
// take.
Phasor round_trip_in_modes(Network const&, ModeBases const&, NetworkCavity const&);

// Power that a way takes from the fundamental mode of one basis into others.
struct BasisMismatch {
  std::string from, to;  // ports: where the light enters and leaves
  double mismatch = 0;   // 1 - |K_00|^2, of the curvatures alone
};

// A network has no modes to use: no settings, an unstable cavity, a beam that none reaches.
class ModeError : public NumericalError {
 public:
  ModeError(std::string what, std::string remedy)
      : NumericalError(what + ": " + remedy), reason(what), remedy(remedy) {}
  std::string reason, remedy;
};

class ModeBases {
 public:
  // ModeError where there are none.
  explicit ModeBases(Network const&);

  std::size_t count() const { return orders_.size(); }
  std::array<int, 2> orders(std::size_t mode) const { return orders_[mode]; }
  std::string name(std::size_t mode) const;  // "(1,0)"
  BeamCurvature const& leaving(std::uint32_t port) const { return leaving_[port]; }
  BeamCurvature entering(std::uint32_t port) const;                      // the light that runs back
  std::vector<CavityMode> const& cavities() const { return cavities_; }  // those whose modes are bases
  std::vector<BasisMismatch> const& mismatches() const { return mismatches_; }

  // Amplitudes of the modes that leave at `out`, a port of the network, for those that enter at number `in` of the
  // component.
  Eigen::MatrixXcd const& coupling(std::uint32_t out, std::uint32_t in) const {
    return couplings_[std::size_t(out) * most_ports + in];
  }
  // Factor of a mode along a space, e^{-i(n psi_x + m psi_y)}: the phase of 00 is part of that of the space.
  Phasor turn(std::size_t space, std::size_t mode) const { return turns_[space][Eigen::Index(mode)]; }
  // W that an aperture keeps of the light that enters at `in`, what it scatters to higher modes counted as passed: of
  // modes a on the open area, |a|^2 - a* S a (eq. N.11).
  double stopped(Network::Component const&, std::uint32_t in, Eigen::VectorXcd const& entering) const;
  // Unit vector of the light of a laser.
  Eigen::VectorXcd emitted(Network::Component const&) const;

 private:
  static constexpr std::size_t most_ports = 4;
  Eigen::MatrixXcd coupled(Network::Component const&, std::uint32_t out, std::uint32_t in) const;
  // Modes of the basis that leaves, of those that enter: without an aperture and the turn of x of a reflection.
  Eigen::MatrixXcd changed_basis(Network::Component const&, std::uint32_t out, std::uint32_t in) const;
  Eigen::MatrixXcd passed(Network::Component const& aperture, std::uint32_t in) const;
  Eigen::MatrixXcd kept(Eigen::MatrixXcd const& all) const;  // the modes in use, of all with n + m <= order

  double wave_number_;
  int order_;
  std::vector<std::array<int, 2>> orders_;
  std::vector<BeamCurvature> leaving_;  // by port
  std::vector<CavityMode> cavities_;
  std::vector<BasisMismatch> mismatches_;
  std::vector<Eigen::MatrixXcd> couplings_;
  std::vector<Eigen::VectorXcd> turns_;  // by space
};

// The curvature of the light that leaves a component at `out` for what enters at `in`, both numbers of its ports.
BeamCurvature through(Network::Component const&, std::uint32_t out, std::uint32_t in, BeamCurvature const&);

}  // namespace straytrace::ifo
