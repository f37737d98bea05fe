// SPDX-License-Identifier: BSD-3-Clause
// Michelson interferometer with Fabry-Perot arms in closed forms: eq. 9.1 and 9.2 inside an arm, 9.3 to 9.6 and 9.8 at
// other ports (docs/theory).
#pragma once

#include <complex>

#include "base/input/table.hpp"
#include "base/namespaces.hpp"
#include "ifo/ports.hpp"

namespace straytrace::ifo {

// Closed forms of arm cavities and of stray light in them (docs/theory/interferometer.md and docs/theory/arm.md). Power
// transmissions and losses as fractions, lengths in m, frequencies in Hz.

// One arm: input and end mirror, loss of power per round trip.
struct ArmCavity {
  double length = 0;
  double input_transmission = 0, end_transmission = 0, round_trip_loss = 0;

  double r1() const;  // amplitude reflectivity of the input mirror
  double r2() const;  // of the end mirror, with all losses of the round trip
};

double finesse(ArmCavity const&);  // eq. 6.5
double cavity_pole(ArmCavity const&);

// The interferometer as seen by the differential field: tuned signal recycling (resonant sideband extraction), low
// frequency, eq. 6.8. The input mirror counts with r_eff, and losses of the arm as r2 below 1, so that
// signal_transmission = 1 (no mirror) is the arm alone with its losses.
struct DifferentialMode {
  double gain;  // amplitude gain Gamma of the differential field in the arm
  double pole;  // Hz
};
DifferentialMode differential_mode(ArmCavity const&, double signal_transmission);

// Circulating power per arm in W, carrier on resonance, dark fringe, eq. 6.11.
double arm_power(ArmCavity const&, double input_power, double recycling_transmission, double beam_splitter_loss);

// h = (lambda / 4 pi L) Im s for a field s inside an arm, relative to the arm field; eq. 9.1.
double strain_per_phase_in_arm(double wavelength, double length);
// h = 8 P Gamma Re s / (c M (2 pi f)^2 L) / (1 + i f/f_p); eq. 9.2. Both mirrors of mass M free.
std::complex<double> strain_per_amplitude_in_arm(double hz, double power, double mass, double length, DifferentialMode);

// h = (lambda / 4 pi L) (pi/2F) (1 + i f/f_p) Im s for a field in one short Michelson arm; eq. 9.5. The pole is that of
// the arm alone, also with signal recycling: the optics behind the arm treat the stray field like the signal. Time
// convention exp(-2 pi i f t): the arm reflects sidebands with (1 + i f/f_p)/(1 - i f/f_p) and lets the signal out with
// 1/(1 - i f/f_p).
std::complex<double> strain_per_phase_in_short_arm(ArmCavity const&, double wavelength, double hz);
// Largest h per relative field that comes back to the antisymmetric port, over the static phase; eq. 9.6.
std::complex<double> strain_at_antisymmetric_port(double dark_fringe_offset, double length, double hz,
                                                  DifferentialMode);

constexpr double least_transmission = 1e-12, most_transmission = 1 - 1e-9;  // of power, of the real mirror

class FabryPerotMichelson final : public Interferometer {
 public:
  struct Parameters {
    ArmCavity arm;
    double wavelength = 0, power = 0, mass = 0;  // m, W circulating in one arm, kg
    DifferentialMode mode{};
    double arms = 2;                // equal and independent
    double dark_fringe_offset = 0;  // m of DARM, for stray light at the antisymmetric port (eq. 9.6)
  };
  // Ports beyond the list are inside an arm.
  explicit FabryPerotMichelson(Parameters p, std::vector<PortEntry> ports = {}, Band const& band = {})
      : p_(p), inside_{.name = "", .copies = p.arms}, ports_(std::move(ports)), band_(band) {}

  std::complex<double> strain_per_phase(PortId, double hz) const override;
  std::complex<double> strain_per_amplitude(PortId, double hz) const override;
  std::optional<std::complex<double>> strain_per_passing_amplitude(PortId, double hz) const override;
  double copies(PortId port) const override { return entry(port).copies; }
  DetectorNumbers numbers() const override {
    return {p_.arm.length,          p_.power, p_.mass, finesse(p_.arm), p_.mode.gain, p_.arm.input_transmission,
            p_.arm.end_transmission};
  }
  std::string description() const override;

 private:
  PortEntry const& entry(PortId port) const { return port.value < ports_.size() ? ports_[port.value] : inside_; }

  Parameters p_;
  PortEntry inside_;
  std::vector<PortEntry> ports_;
  Band band_;  // for the description
};

std::unique_ptr<Interferometer> read_closed_forms(Node const& table, std::vector<TracedPort> const& ports,
                                                  double wavelength, Band const&);

}  // namespace straytrace::ifo
