// SPDX-License-Identifier: BSD-3-Clause
// Bodies with correlated motion: a measured matrix of cross spectra.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "motion/chain.hpp"
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

}  // namespace straytrace::motion
