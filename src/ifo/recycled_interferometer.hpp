// SPDX-License-Identifier: BSD-3-Clause
// Stray light to strain by the network of a dual-recycled interferometer (docs/theory/interferometer.md).
#pragma once

#include <map>
#include <mutex>

#include "ifo/dual_recycled.hpp"
#include "ifo/ports.hpp"

namespace straytrace {

class RecycledInterferometer final : public Interferometer {
 public:
  struct Servos {  // open-loop gains, for the input bench (eq. 9.7)
    TransferFunction frequency, intensity;
  };
  RecycledInterferometer(std::string name, std::unique_ptr<DualRecycled> model, std::vector<PortEntry> ports,
                         Servos servos, Band const& band = {})
      : name_(std::move(name)),
        model_(std::move(model)),
        ports_(std::move(ports)),
        servos_(std::move(servos)),
        band_(band) {}

  std::complex<double> strain_per_phase(PortId, double hz) const override;
  std::complex<double> strain_per_amplitude(PortId, double hz) const override;
  double copies(PortId port) const override { return ports_.at(port.value).copies; }
  DetectorNumbers numbers() const override;
  std::string description() const override;
  DualRecycled const& model() const { return *model_; }
  // Strain per relative field in the larger of both quadratures, without what the port and servos take of it.
  double largest_response(InjectionPoint, double hz) const;

 private:
  struct Answer {
    std::array<std::complex<double>, entrance_names.size()> phase, amplitude;  // strain per relative field
  };
  Answer const& answer(double hz) const;
  Answer solved(double hz) const;

  std::string name_;
  std::unique_ptr<DualRecycled> model_;
  std::vector<PortEntry> ports_;
  Servos servos_;
  Band band_;  // for the description
  mutable std::mutex mutex_;
  mutable std::map<double, Answer> answers_;  // by frequency: one solution serves every port
};

std::unique_ptr<Interferometer> read_recycled_interferometer(Node const& table, DualRecycledPreset const&,
                                                             std::vector<TracedPort> const& ports, double wavelength,
                                                             Band const&);

// What the table may hold, for the reader and the reference page. The fallback is that of the preset.
std::span<Key<DualRecycledParameters> const> dual_recycled_keys();

}  // namespace straytrace
