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

// Values of all read-outs while one number runs from `from` to `to`.
struct NetworkScan {
  NetworkParameter parameter;
  std::vector<double> at;
  std::vector<std::vector<double>> values;  // by read-out, then by place
};
NetworkScan scan_network(NetworkModel const&, NetworkParameter const&, double from, double to, std::size_t points);

}  // namespace straytrace::ifo
