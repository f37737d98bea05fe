// SPDX-License-Identifier: BSD-3-Clause
// What is written about one coordinate of a body: `z: {asd: tube.txt, columns: [Hz, m/sqrt(Hz)]}`.
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

namespace straytrace {

struct Tone {
  double frequency;                // Hz
  std::complex<double> amplitude;  // peak, m or rad, with its phase: Im(amplitude exp(+2 pi i f t))
  double uncertainty = 1;          // factor, one standard deviation
};

// Motion of its own, as well known as `uncertainty` says, seen through what stands between it and the body.
struct OwnMotion {
  Spectrum spectrum;  // Gaussian, m^2/Hz or rad^2/Hz
  double uncertainty = 1;
  Transfer through = {};
  std::shared_ptr<TimeSeries const> recorded = {};  // m or rad
  double scale = 1;                                 // of what is recorded; in the spectrum of what is not
};

// Another coordinate: the same statistics but independent, or the very same motion, at the end of a chain.
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
  std::vector<Band> bands;  // Hz, of all that was added to `own`
  std::vector<Tone> tones;
  std::vector<AxisReference> references;
  std::vector<JointMotion> joint;
  std::vector<MotionFile> files;  // all that is in `own` and `joint` and ends where a file ends
  double drift = 0;               // m/s or rad/s
};

constexpr std::string_view axis_names[6] = {"x", "y", "z", "rx", "ry", "rz"};
constexpr bool is_rotation(int axis) { return axis >= 3; }

// Whether a key belongs to one coordinate: asd, series, power-law ...
bool says_how_one_moves(std::string_view key);

// Adds one specification or a list of them; `uncertainty` where it states none. Problems go to the document.
void read_axis(Node const&, int axis, double uncertainty, AxisMotion& into);

// Bodies that hang: `suspended: {from: ground, vertical: y, stages: [...], vertical_stages: [...]}`.

// Adds to the coordinates of a body what comes down its suspension: the two horizontal ones through `stages`, the one
// named by `vertical` through `vertical_stages` if there are any; rotations of the support are not passed on. Returns
// which coordinates are stated by it.
std::array<bool, 6> add_suspended(Node const& suspended, std::array<AxisMotion, 6>& axes);

}  // namespace straytrace
