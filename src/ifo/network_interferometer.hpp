// SPDX-License-Identifier: BSD-3-Clause
// Stray light to strain by a network without a preset (docs/theory/interferometer.md).
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "ifo/ports.hpp"
#include "ifo/stray_response.hpp"

namespace straytrace::ifo {

class NetworkInterferometer final : public Interferometer {
 public:
  NetworkInterferometer(NetworkModel, std::string readout, std::vector<PortEntry>, Band const&);

  std::complex<double> strain_per_phase(PortId, double hz) const override;
  std::complex<double> strain_per_amplitude(PortId, double hz) const override;
  std::optional<std::complex<double>> strain_per_passing_amplitude(PortId, double hz) const override;
  double copies(PortId port) const override { return ports_.at(port.value).copies; }
  DetectorNumbers numbers() const override { return {.arm_length = model_.strain->length}; }
  NetworkModel const* network() const override { return &model_; }
  std::string description() const override;
  SteadyField const& field() const { return field_; }

 private:
  struct Answer {
    StrayResponse stray{}, passing{};
  };
  std::vector<Answer> const& answer(double hz) const;

  NetworkModel model_;
  std::string readout_;
  SteadyField field_;
  std::vector<PortEntry> ports_;
  Band band_;
  mutable std::mutex mutex_;
  mutable std::map<double, std::vector<Answer>> answers_;  // by frequency, per port
};

// Warns of ports whose light, or the beam it joins, is not in mode 00 by more than 1e-3: stray light is of mode 00
// alone (eq. N.16). At the middle of the band.
void warn_of_other_modes(Node const& interferometer, NetworkModel const&, SteadyField const&,
                         std::vector<PortEntry> const&, Band const&);

// `preset: none`. Nothing without the key `strain`.
std::unique_ptr<Interferometer> read_network_interferometer(Node const& table, std::vector<TracedPort> const& ports,
                                                            double wavelength, Band const&,
                                                            std::vector<DrawnOptic> const& optics);

}  // namespace straytrace::ifo
