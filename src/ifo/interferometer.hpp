// SPDX-License-Identifier: BSD-3-Clause
// What a stray field does to h (physics.md section 9).
#pragma once

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "base/ids.hpp"
#include "base/table.hpp"

namespace straytrace {

class Interferometer {
 public:
  virtual ~Interferometer() = default;
  // Strain per unit relative field entering at a port, at frequency hz: the part in quadrature with the main field
  // (Im s, phase) and the part in phase (Re s, radiation pressure).
  virtual std::complex<double> strain_per_phase(PortId, double hz) const = 0;
  virtual std::complex<double> strain_per_amplitude(PortId, double hz) const = 0;
  // How many equal, independent copies of what was traced at this port the detector has (two arms: 2). Powers add.
  virtual double copies(PortId) const = 0;
  virtual double arm_length() const { return not_a_number; }  // m; NaN: not known
  virtual std::string description() const = 0;                // one line for reports: formulas and numbers used
};

// Reads the table `interferometer`; `ports` in the order of PortId; wavelength in m; beam_power in W is the power in an
// arm where the table gives none, 0 when unknown.
std::unique_ptr<Interferometer> make_interferometer(Node const& table, std::vector<std::string> const& ports,
                                                    double wavelength, double beam_power = 0);

}  // namespace straytrace
