// SPDX-License-Identifier: BSD-3-Clause
// Motion of one coordinate of a body: `z: {asd: tube.txt, columns: [Hz, m/sqrt(Hz)]}`.
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "base/input/table.hpp"
#include "motion/motion_files.hpp"
#include "spectra/series.hpp"
#include "spectra/spectrum.hpp"

namespace straytrace::motion {

// One coordinate as a sum over independent inputs of PSD 1/Hz, which all members of the matrix share.
struct JointMotion {
  std::string matrix;         // file, form and units: members of one matrix share their inputs
  std::vector<Transfer> row;  // m sqrt(Hz) or rad sqrt(Hz), one for each input; null: no contribution
  Spectrum unit;              // 1/Hz between the first and the last frequency of the matrix
  double scale = 1;
  Transfer through = {};
  double uncertainty = 1;  // factor, one standard deviation

  double psd(double hz) const;  // of the member, m^2/Hz or rad^2/Hz
};

// {csd: FILE, form: matrix|cross|coherence, units: [m, m/s], member: 2}: columns of text, frequency in Hz and then,
// with one-sided densities and phases as scipy.signal.csd gives them, S_ij = <conj(X_i) X_j> for exp(+2 pi i f t),
//   matrix     all elements row by row: re, im
//   cross      the upper triangle row by row: S_11, re S_12, im S_12, ..., S_22, ...
//   coherence  all S_ii, then for each pair i < j its coherence |S_ij|^2/(S_ii S_jj) and the phase of S_ij in degrees
// Empty and a problem when the file does not fit or a matrix is not positive semidefinite.
std::optional<JointMotion> read_joint(Node const& spec, bool rotation);

using ComplexMatrix = std::vector<std::vector<std::complex<double>>>;
// Lower triangle L with C = L L^+, row by row; columns of zeros where C is singular. Empty when C is not positive
// semidefinite; pivots down to -1e-6 of the diagonal count as rounding of printed numbers.
std::optional<ComplexMatrix> cholesky(ComplexMatrix const& c);

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
