// SPDX-License-Identifier: BSD-3-Clause
// Motion of one coordinate of a body: `z: {asd: tube.txt, columns: [Hz, m/sqrt(Hz)]}`.
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "base/input/table.hpp"
#include "motion/chain.hpp"
#include "motion/joint_motion.hpp"
#include "motion/motion_files.hpp"
#include "spectra/series.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {

struct Tone {
  double frequency;                // Hz
  std::complex<double> amplitude;  // peak, m or rad, with its phase: Im(amplitude exp(+2 pi i f t))
  double uncertainty = 1;          // factor, one standard deviation
};

// Motion from a source of its own, seen through the chain between the source and the body.
struct OwnMotion {
  Spectrum spectrum;  // Gaussian, m^2/Hz or rad^2/Hz
  double uncertainty = 1;
  Transfer through = {};
  std::shared_ptr<TimeSeries const> recorded = {};  // m or rad
  double scale = 1;                                 // of the record; without a record the spectrum contains it
};

// Reference to another coordinate, seen through a chain: an independent copy with the same statistics, or the same
// motion.
struct AxisReference {
  std::string body;  // none: the same one
  int axis;
  double scale;
  bool coherent;
  Transfer through;
  Node where;  // for messages
};

// Independent contributions that add.
struct AxisMotion {
  std::vector<OwnMotion> own;
  std::vector<Band> bands;  // Hz, of each contribution to `own`
  std::vector<Tone> tones;
  std::vector<AxisReference> references;
  std::vector<JointMotion> joint;
  std::vector<MotionFile> files;  // contributions to `own` and `joint` that end where a file ends
  double drift = 0;               // m/s or rad/s
};

constexpr std::string_view axis_names[6] = {"x", "y", "z", "rx", "ry", "rz"};
constexpr bool is_rotation(int axis) { return axis >= 3; }

// Whether a key selects a kind of motion of one coordinate: asd, series, power-law ...
bool says_how_one_moves(std::string_view key);

// Adds one specification or a list of them; `uncertainty` where it states none. Problems go to the document.
void read_axis(Node const&, int axis, double uncertainty, AxisMotion& into);

// Bodies that hang: `suspended: {from: ground, vertical: y, stages: [...], vertical_stages: [...]}`.

// Adds the motion through the suspension to the coordinates of a body: the two horizontal ones through `stages`, the
// one named by `vertical` through `vertical_stages` if there are any; rotations of the support are not transmitted.
// Returns the coordinates that it covers.
std::array<bool, 6> add_suspended(Node const& suspended, std::array<AxisMotion, 6>& axes);

}  // namespace straytrace::motion
