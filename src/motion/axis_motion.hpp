// SPDX-License-Identifier: BSD-3-Clause
// What is written about one coordinate of a body: `z: {asd: tube.txt, columns: [Hz, m/sqrt(Hz)]}`.
#pragma once

#include <complex>
#include <vector>

#include "base/table.hpp"
#include "signal/spectrum.hpp"

namespace straytrace {

struct Tone {
  double frequency;                // Hz
  std::complex<double> amplitude;  // peak, m or rad, with its phase
};

// Another coordinate of the same body: the same statistics but independent, or the very same motion.
struct AxisReference {
  int axis;
  double scale;
  bool coherent;
  Node where;  // for messages
};

// Independent contributions that add.
struct AxisMotion {
  Spectrum spectrum;  // Gaussian part, m^2/Hz or rad^2/Hz
  std::vector<Tone> tones;
  std::vector<AxisReference> references;
};

constexpr std::string_view axis_names[6] = {"x", "y", "z", "rx", "ry", "rz"};
constexpr bool is_rotation(int axis) { return axis >= 3; }

// One specification or a list of them. Problems go to the document.
AxisMotion read_axis(Node const&, int axis);

}  // namespace straytrace
