// SPDX-License-Identifier: BSD-3-Clause
// What a stray field does to h (physics.md section 9).
#pragma once

#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "base/ids.hpp"
#include "base/table.hpp"
#include "ifo/entrance.hpp"
#include "signal/band.hpp"

namespace straytrace {

// A port of the scene, as the interferometer finds it.
struct TracedPort {
  std::string name;
  Entrance entrance = Entrance::arm;  // where its light joins when the table does not say
  double power = 0;                   // W, of its beam; 0: not stated
  double cavity_length = 0;           // m, between the mirrors of its beam; 0: no cavity
};

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

// Reads the table `interferometer`; `ports` in the order of PortId; wavelength in m. Where the table gives no power,
// the arms have that of the beams whose ports join there. Files of responses must cover the band.
std::unique_ptr<Interferometer> make_interferometer(Node const& table, std::vector<TracedPort> const& ports,
                                                    double wavelength, Band const& = {});

}  // namespace straytrace
