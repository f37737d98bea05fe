// SPDX-License-Identifier: BSD-3-Clause
// A network with what is asked of it: read-outs and degrees of freedom by name.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/units/quantity.hpp"
#include "ifo/network.hpp"
#include "spectra/curve.hpp"
#include "spectra/filters.hpp"

namespace straytrace::ifo {

struct NamedReadout {
  std::string name;
  Readout readout{};
  bool is_power() const { return readout.kind == Readout::Kind::power; }
  bool is_demodulated() const { return readout.kind == Readout::Kind::demodulated; }
};

// Displacements of mirrors and splitters, m per m of the degree of freedom.
struct NamedFreedom {
  std::string name;
  std::vector<std::pair<ComponentId, double>> moves{};
};

// What acts on a network: "DARM" or "ETM" (displacement, m), "ETM.force" (N), "laser.amplitude" (relative),
// "laser.phase" (rad), "laser.frequency" (Hz).
struct NetworkCause {
  enum class Kind : std::uint8_t { displacement, force, amplitude, phase, frequency };
  std::string name;
  Kind kind = Kind::displacement;
  std::vector<std::pair<ComponentId, double>> moves{};  // or one laser
  char const* unit() const;
  Dimension density() const;         // of an ASD
  std::string density_unit() const;  // "Hz/sqrt(Hz)"
};
// One-sided noise of a cause, in its unit per sqrt(Hz): a power law, or a curve.
struct NamedNoise {
  NetworkCause cause;
  double level = 0, at = 100, exponent = 0;  // asd = level (f/at)^exponent; Hz
  spectra::Curve curve{};                    // instead, where it has samples; NaN outside them
  std::string file{};
  double asd(double hz) const;
};

// A beam at a port: what enters it or what leaves it.
struct NetworkBeam {
  std::uint32_t port = 0;
  bool leaving = false;
};
// A point on a beam, m from its port.
struct BeamPlace {
  NetworkBeam beam{};
  double distance = 0;
};
// Light of one beam that joins another (docs/theory/interferometer.md, eq. N.12). What leaves a mirror at no distance
// was scattered there: the mirror takes the recoil.
struct StrayWay {
  BeamPlace lit{}, fed{};
  double delay = 0;    // m, optical path besides the distances
  double turn = 0;     // rad
  bool alone = false;  // its reverse adds nothing: `lit` is but the reference of s
  // A thin lossless face there, which returns the light of both sides: s on the side of `lit`, -s* behind (eq. N.20).
  bool both_sides = false;
};
struct NamedWay {
  std::string name;
  StrayWay way{};
  double share = 1;  // field that joins, over that of the name
};
// How a read-out becomes strain.
struct StrainScale {
  Readout readout{};
  NamedFreedom freedom{};
  double length = not_a_number;  // m
};
// How the length of a degree of freedom is controlled.
struct ControlLoop {
  // held: the length does not change, as with an ideal sensor and infinite gain. closed: a sensor of the light and an
  // open-loop gain. free: no loop.
  enum class Kind : std::uint8_t { held, closed, free };
  Kind kind = Kind::held;
  NamedReadout sensor{};                  // of a closed loop
  spectra::TransferFunction open_loop{};  // G, with no other loop acting; positive: suppresses by 1/(1 + G)
  // Share of the way from the actuator to the read-out of strain that a feed-forward filter subtracts; 1: all of it.
  spectra::TransferFunction feedforward{};
};
// A read-out whose signal, filtered, is added to that of strain.
struct SubtractedChannel {
  NamedReadout channel{};
  // Read-out of strain per unit of the channel; nothing: the filter of the least noise, of the stated noises and the
  // vacuum.
  std::optional<spectra::TransferFunction> filter{};
};
struct ControlledLength {
  Readout length{};  // its displacement, m
  NamedFreedom freedom{};
  ControlLoop loop{};
};

struct NetworkModel {
  std::string preset;  // "none": the network is of the scene alone
  Network network{1064e-9};
  std::vector<NamedReadout> readouts{};
  std::vector<NamedFreedom> freedoms{};
  std::vector<NamedNoise> noises{};
  std::vector<NamedWay> entrances{};
  std::optional<StrainScale> strain{};
  std::vector<ControlledLength> controlled{};
  std::vector<SubtractedChannel> subtracted{};

  NamedReadout const* readout(std::string const& name) const;
  NamedFreedom const* freedom(std::string const& name) const;
};

std::vector<std::string> port_names(Network const&);
std::optional<std::uint32_t> find_port(Network const&, std::string const& name);  // "PRM.front", "laser"
std::optional<NetworkBeam> find_beam(Network const&, std::string const& name);    // "PRM.front.out", "laser.in"
std::string beam_name(Network const&, Readout const&);
// Steady value of a read-out; not a number where it is rounding, below 1e-12 of the power of its beam.
double resolved_value(Readout const&, SteadyField const&);
double power_of_beam(Readout const&, SteadyField const&);  // W

// What a scene adds to a network or replaces in it. A space takes its ports from the spaces that were there.
struct NetworkChanges {
  struct Space {
    std::string from, to;  // names of ports
    double length = 0, phase = 0;
    std::string origin{};  // of the length, when it is not stated
  };
  struct Shape {  // of a mirror or splitter that is there
    std::string component;
    std::optional<double> curvature{};
    std::optional<std::array<double, 2>> tilt{};
    std::optional<double> curvature_across{};
    std::string origin{};
  };
  std::vector<Network::Component> components;
  std::vector<Space> spaces;
  std::vector<Shape> shapes{};
  std::optional<ModeSettings> modes{};
  bool empty() const { return components.empty() && shapes.empty() && spaces.empty() && !modes; }
};
void apply(NetworkChanges const&, Network&);

// "plane waves", or "modes up to order 4".
std::string wave_text(Network const&);
// The network as a scene of its own, numbers with all digits.
std::string network_text(NetworkModel const&);

}  // namespace straytrace::ifo
