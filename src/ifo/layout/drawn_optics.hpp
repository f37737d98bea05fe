// SPDX-License-Identifier: BSD-3-Clause
// Curvatures, angles of incidence and lengths of a network from the optics that its scene draws
// (docs/reference/network.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "ifo/interferometer.hpp"
#include "ifo/network_model.hpp"

namespace straytrace::ifo {

class OpticReader {
 public:
  explicit OpticReader(std::vector<DrawnOptic> const& drawn) : drawn_(drawn) {}

  // The key `optic` of a mirror or splitter, where it is given; a problem where the scene does not draw it.
  void read(std::string const& component, Node const& mirror);
  // m between the optics at the ends of a space; a problem where an end names none.
  std::optional<double> distance(Node const& space, std::string const& from, std::string const& to) const;
  bool both_drawn(std::string const& from, std::string const& to) const { return find(from) && find(to); }
  // Gives the mirrors of the changes what their optics show. `network`: with the changes, for its spaces.
  void finish(NetworkChanges& changes, Network const& network) const;

 private:
  struct Used {
    std::string component;
    Node mirror;  // its table
    DrawnOptic const* optic;
  };
  // Light between a port and the next optic on its way.
  struct Meeting {
    std::string port;
    Used const* other;
    bool ahead = true;     // on the side of the axis
    bool front = true;     // of the component
    double incidence = 0;  // rad
  };
  Used const* find(std::string const& port_or_component) const;
  std::vector<Meeting> meetings(Used const&, Network const&) const;
  std::optional<double> curvature(Used const&, std::vector<Meeting> const&) const;
  std::optional<double> incidence(Used const&, std::vector<Meeting> const&, bool splitter) const;

  std::vector<DrawnOptic> const& drawn_;
  std::vector<Used> used_;
};

}  // namespace straytrace::ifo
