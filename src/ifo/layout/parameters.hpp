// SPDX-License-Identifier: BSD-3-Clause
// The numbers of a network by name: "ITM.transmission", "ETM.tuning", "EOM1.index", "PRM.back.length" (of the space at
// this port), "DARM".
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/units/quantity.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

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

}  // namespace straytrace::ifo
