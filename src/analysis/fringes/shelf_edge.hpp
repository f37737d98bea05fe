// SPDX-License-Identifier: BSD-3-Clause
// Effective motion from where the shelf of fringe noise ends (requirements R2.40, R2.41): edge = factor * 2
// v_max/lambda (docs/theory/spectra.md, eq. 7.1, 7.2), stride by stride. Only powers are compared, so that static
// phase, drift and delays below a segment do not matter.
#pragma once

#include <vector>

#include "analysis/fringes/fringe_fit.hpp"

namespace straytrace {

struct ShelfEdgeSettings {
  double low = 0, high = 0;  // Hz, band: the edge is searched inside
  double wavelength = 1064e-9;
  double stride = 10, segment = 1;  // s: one edge each; one periodogram each (Hann, half overlap)
  SearchRange factor{0.2, 3};       // on the motion, in units of 2k: 1 is a single bounce at normal incidence
  SearchRange ratio;                // of the second witness; free: the same for all strides
  double false_alarm = 1e-3;
};

struct EdgeStride {
  double start = 0;      // GPS s
  double predicted = 0;  // Hz, 2 v_max/lambda in the stride
  Fitted factor;         // measured edge over predicted one
  double gain = 0;       // of twice the log-likelihood over a floor without shelf
  double amplitude = 0;  // G of h = G sin(phi) at the edge, in units of the target
  bool significant = false;
};

struct ShelfEdgeFit {
  std::vector<EdgeStride> strides;
  Fitted factor;  // weighted mean, error by repetition; it grows with the scatter of the strides when that is larger,
                  // and with the error of a free ratio
  Fitted of_likelihood;  // weighted mean and error of the likelihood alone, which takes the shelf for Gaussian noise
  Fitted ratio;
  double chi2 = 0;       // of the strides about the mean
  std::size_t used = 0;  // significant strides
};

// Whittle likelihood of Welch spectra; model: |T(f)|^2 of a port times the spectrum of sin(phi + theta), mean over the
// static phase, plus a floor n_0 + n_2 f^-2 + n_4 f^-4 with no negative part; |T|^2 is any smooth positive function.
// Errors and offsets are those of the same fit to records made of the fitted model again (docs/theory/fit.md). Throws
// InputError as fit_fringes.
ShelfEdgeFit fit_shelf_edge(FringeRecords const&, ShelfEdgeSettings const&);

}  // namespace straytrace
