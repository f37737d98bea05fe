// SPDX-License-Identifier: BSD-3-Clause
// Michelson interferometer with Fabry-Perot arms in closed forms: eq. 9.1 and 9.2 inside an arm, 9.3 to 9.6 and 9.8 at
// other ports (docs/theory).
#pragma once

#include "base/input/table.hpp"
#include "ifo/cavity.hpp"
#include "ifo/ports.hpp"

namespace straytrace::ifo {

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
