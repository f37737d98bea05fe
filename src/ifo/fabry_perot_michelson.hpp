// SPDX-License-Identifier: BSD-3-Clause
// Michelson interferometer with Fabry-Perot arms; all ports are inside an arm (physics.md eq. 9.1, 9.2).
#pragma once

#include <span>

#include "base/table.hpp"
#include "ifo/cavity.hpp"
#include "ifo/interferometer.hpp"

namespace straytrace {

class FabryPerotMichelson final : public Interferometer {
 public:
  struct Parameters {
    ArmCavity arm;
    double wavelength = 0, power = 0, mass = 0;  // m, W circulating in one arm, kg
    DifferentialMode mode{};
    double arms = 2;  // equal and independent
  };
  explicit FabryPerotMichelson(Parameters p) : p_(p) {}

  std::complex<double> strain_per_phase(PortId, double hz) const override;
  std::complex<double> strain_per_amplitude(PortId, double hz) const override;
  double copies() const override { return p_.arms; }
  std::string description() const override;

 private:
  Parameters p_;
};

FabryPerotMichelson::Parameters read_fabry_perot_michelson(Node const& table, double wavelength, double beam_power = 0);

// What the table may hold, for the reader and the reference page.
struct FabryPerotMichelsonKeys {
  double arm_length, mirror_mass, input_transmission, end_transmission, round_trip_loss, signal_recycling_transmission,
      arms;
};
std::span<Key<FabryPerotMichelsonKeys> const> fabry_perot_michelson_keys();

}  // namespace straytrace
