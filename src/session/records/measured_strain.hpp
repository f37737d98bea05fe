// SPDX-License-Identifier: BSD-3-Clause
// A measured strain, drawn over the noise of a run.
#pragma once

#include <string>
#include <vector>

#include "base/namespaces.hpp"
#include "spectra/welch.hpp"

namespace straytrace::session {

struct MeasuredStrain {
  std::string name, source;       // in the legend; file, span and averages
  std::vector<double> hz, asd;    // 1/sqrt(Hz)
  std::vector<double> low, high;  // one standard error; NaN where it is not known
};

// Lines of an averaged spectrum of strain, joined to some 200 points per decade; their power is kept.
MeasuredStrain measured_from(WelchSpectrum const&, WelchSettings const&, double low_hz, double high_hz);
// Columns of text: frequency [Hz], ASD [1/sqrt(Hz)], and the standard error of the ASD where there is a third.
MeasuredStrain parse_measured(std::string const& text, std::string const& file, double low_hz, double high_hz);

std::string measured_json(std::vector<MeasuredStrain> const&);  // for pages and pictures

}  // namespace straytrace::session
