// SPDX-License-Identifier: BSD-3-Clause
// Stray light to strain by a network without a preset (docs/theory/interferometer.md).
#pragma once

#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ifo/interferometer.hpp"
#include "ifo/network_model.hpp"
#include "ifo/ports.hpp"

namespace straytrace::ifo {

// Stray light from any beam of a network into any other (docs/theory/interferometer.md, eq. N.12 to N.15).

NetworkBeam reversed(NetworkBeam);
// Whether both name the same light: what leaves one end of a space enters the other.
bool same_beam(Network const&, NetworkBeam, NetworkBeam);
std::string beam_name(Network const&, NetworkBeam);

// The way back on the beam it came from, at one point.
StrayWay returning(NetworkBeam fed, double distance = 0);
// Light added to a beam where it passes the middle of its space, or leaves the network, and to its reverse there: both
// ways, a = b in eq. N.12. No mirror takes a recoil.
StrayWay passing(Network const&, NetworkBeam);
// Whether the way that starts where this one ends, and ends where it starts, adds nothing.
bool is_own_reverse(Network const&, StrayWay const&);
// Turns the way so that Re s joins in phase with the carrier there, where both ends have light of the laser's
// frequency.
void turn_to_local_light(StrayWay&, Network const&, SteadyField const&);
// Power of the light that is scattered, of the fundamental mode, W.
double lighting_power(StrayWay const&, SteadyField const&);

// Response to s: upper s(f) + lower s*(-f) (eq. N.13).
struct StrayResponse {
  Phasor upper = 0, lower = 0;
  Phasor phase() const { return Phasor(0, 0.5) * (upper - lower); }  // per Im s, eq. N.15
  Phasor amplitude() const { return 0.5 * (upper + lower); }         // per Re s
  double both() const { return std::sqrt(std::norm(phase()) + std::norm(amplitude())); }
  StrayResponse operator+(StrayResponse const& o) const { return {upper + o.upper, lower + o.lower}; }
  StrayResponse operator*(Phasor z) const { return {upper * z, lower * z}; }
};
// Eq. N.12; of both sides of a face, eq. N.20. The reference of s is the light that is scattered.
StrayResponse stray_response(LinearResponse const&, Network const&, SteadyField const&, StrayWay const&, double hz);

// Shares of power that are not in mode 00, which alone is scattered and joins in eq. N.12: of the light that is
// scattered, and of the weights of what it joins. Both terms together; 0: plane waves; not a number: no light, no
// response.
struct BeyondFundamental {
  double light = 0, weight = 0;
};
BeyondFundamental beyond_fundamental(LinearResponse const&, Network const&, SteadyField const&, StrayWay const&);

// Response of every read-out and of the strain to a way, by frequency.
struct StrayRow {
  std::string entrance{}, lit{}, fed{}, readout{}, unit{};
  double hz = 0, power = 0;    // W, that lights
  StrayResponse response{};    // of the read-out; not a number: no light is scattered
  double gain = not_a_number;  // for Gamma in eq. 9.2; of the strain
  BeyondFundamental beyond{};
  Phasor phase() const { return resolved(response.phase()); }  // not a number: rounding
  Phasor amplitude() const { return resolved(response.amplitude()); }

 private:
  Phasor resolved(Phasor part) const { return std::abs(part) > 1e-10 * response.both() ? part : not_a_number; }
};
std::vector<StrayRow> stray_rows(NetworkModel const&, std::vector<NamedWay> const&, std::vector<double> const& hz);
// A named entrance, or the way back at the end of a beam; nothing where there is neither.
std::optional<NamedWay> find_way(NetworkModel const&, std::string const& name);
// Every beam that enters a port, and every one that leaves a moving component, lit by its reverse.
std::vector<NamedWay> ways_of_all_beams(NetworkModel const&);

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
