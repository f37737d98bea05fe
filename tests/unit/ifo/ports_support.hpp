// SPDX-License-Identifier: BSD-3-Clause
// An interferometer from the keys of its table.
#pragma once

#include "ifo/interferometer.hpp"
#include "support/scene_tables.hpp"

namespace straytrace::testing {

struct Detector {
  Scene scene;
  std::unique_ptr<Interferometer> ifo;
  std::string problems;
};

inline std::vector<TracedPort> const two_ports = {{.name = "ITM"}, {.name = "bench"}};

inline Detector detector(std::string const& keys, FileTexts files = {}, double wavelength = 1064e-9,
                         std::vector<TracedPort> const& ports = two_ports) {
  Detector d{scene_of("interferometer: {" + keys + "}\n", std::move(files)), {}, {}};
  d.ifo = make_interferometer(d.scene.root()["interferometer"], ports, wavelength);
  d.problems = problems_of(d.scene);
  return d;
}

}  // namespace straytrace::testing
