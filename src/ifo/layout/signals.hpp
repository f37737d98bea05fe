// SPDX-License-Identifier: BSD-3-Clause
// Signals of a network: error signals at the operating point, and responses at a Fourier frequency.
#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/units/quantity.hpp"
#include "ifo/network_interferometer.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

// The numbers of a network by name: "ITM.transmission", "ETM.tuning", "EOM1.index", "PRM.back.length" (of the space at
// this port), "DARM".

struct NetworkParameter {
  std::string name;
  Dimension dimension;
  double value = 0;          // SI, as the network stands
  double low = 0, high = 0;  // allowed
  std::function<void(NetworkModel&, double)> set;
};
std::vector<std::string> parameter_names(NetworkModel const&);
std::optional<NetworkParameter> find_parameter(NetworkModel const&, std::string const& name);

// A number of the network on its way from one value to another.
struct ScanAxis {
  NetworkParameter parameter;
  double from = 0, to = 0;
  std::size_t points = 0;
  double at(std::size_t i) const { return points > 1 ? from + (to - from) * double(i) / double(points - 1) : from; }
};
// Values of all read-outs on one axis, or on a grid of two; the first axis is the fastest.
struct NetworkScan {
  std::vector<ScanAxis> axes;
  std::vector<std::vector<double>> values;  // by read-out, then by place; not a number: rounding
};
// InputError where the network has no modes at a place of the scan.
NetworkScan scan_network(NetworkModel const&, std::vector<ScanAxis> axes);

// A read-out of power, demodulated or not, against a degree of freedom.
struct ErrorSignal {
  std::string readout, freedom;
  double value = 0;                                 // W; not a number: rounding
  double slope = 0;                                 // W/m, eq. N.3
  double best_phase = not_a_number;                 // rad, eq. N.2; of a demodulated one
  double best_slope = not_a_number;                 // W/m there
  double linear_range = not_a_number;               // m: span about the operating point where the slope is within 10 %
  double offset() const { return -value / slope; }  // m from here to the zero of the tangent
};
// Without those whose slope is rounding.
std::vector<ErrorSignal> error_signals(NetworkModel const&);

// Slope of a read-out of power, demodulated or not, with respect to a number of the network, per SI unit of it; not a
// number: rounding. By one adjoint solution (eq. N.3); for modulation indices, and for curvatures and tilts in modes,
// by central differences.
struct ParameterSlope {
  NetworkParameter parameter;
  double slope = 0;
};
// Of all numbers but frequencies of modulators.
std::vector<ParameterSlope> parameter_slopes(NetworkModel const&, Readout const&);

std::vector<std::string> cause_names(NetworkModel const&);
std::optional<NetworkCause> find_cause(NetworkModel const&, std::string const& name);
// A read-out, or a mirror whose displacement is requested; the names also hold "h", the strain, where it is defined.
std::vector<std::string> effect_names(NetworkModel const&);
std::optional<NamedReadout> find_effect(NetworkModel const&, std::string const& name);
char const* unit_of(Readout const&);

// For motion proportional to exp(-2 pi i f t), per unit of the cause.
Phasor response_to(LinearResponse const&, Network const&, NetworkCause const&, double hz);

// Complex responses of an effect to a cause for motion proportional to exp(+2 pi i f t), by frequency; without an
// effect those of the strain.
std::vector<Phasor> transfer_function(NetworkModel const&, NetworkCause const&,
                                      std::optional<NamedReadout> const& effect, std::vector<double> const& hz);

// Responses of an effect to a stray field on a way, by frequency; without an effect those of the strain.
std::vector<StrayRow> stray_transfer(NetworkModel const&, NamedWay const&, std::optional<NamedReadout> const& effect,
                                     std::vector<double> const& hz);

// Read-outs (rows) by degrees of freedom (columns) at one frequency, per m, for exp(+2 pi i f t); not a number:
// rounding.
struct SensingMatrix {
  double hz = 0;
  std::vector<std::string> readouts{}, freedoms{};
  Eigen::MatrixXcd response{};
  double condition = 0;  // of rows divided by their largest, without those of rounding; infinite without an inverse
};
SensingMatrix sensing_matrix(NetworkModel const&, double hz);

}  // namespace straytrace::ifo
