// SPDX-License-Identifier: BSD-3-Clause
// Options of `straytrace fit` and `fit edge`, and the records and ranges that follow from them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/fringes/fringe_fit.hpp"
#include "cli/data_options.hpp"
#include "session/options.hpp"

namespace straytrace::session {
struct Model;
}  // namespace straytrace::session

namespace straytrace::cli {

struct FitOptions {
  DataOptions data;
  std::string run, body, axis;    // of the model; none: fit data alone
  std::vector<std::size_t> rows;  // --path: ranks in its path table
  std::string target, target_unit, witness, witness2, witness_unit, witness2_unit, corner;
  std::string wavelength, multiplicity, delay, drift, ratio, gain;
  std::vector<std::string> free;
  std::size_t paths = 1;
  std::string train = "70 %", method = "frequency", false_alarm = "1e-3", subtract;
  std::string stride = "10 s", segment = "1 s", factor = "0.2..3";  // of `edge`
};

// Prediction of a run for a route, for the witness of one body along one axis.
struct RoutePrediction {
  std::size_t rank = 0;
  std::string route, port, body, axis;
  double coupling = 0, sigma = 0;       // f_r, mean over the speckle, of one copy of the port; Monte-Carlo error
  bool speckle = true;                  // scattered light: one realisation varies; a ghost does not
  double multiplicity = 0, spread = 0;  // rms over the paths in units of 2k, m for a rotation; their standard deviation
  StrainResponse phase, amplitude;      // of its port; keep the model alive
};
// Throws InputError when the run has no such row, detector or motion of that body, and for an axis that a witness of
// this kind does not measure.
std::vector<RoutePrediction> predictions(FitOptions const&, bool rotation);
double wavelength_of_run(FitOptions const&);

// The records in SI units, within --gps: velocities and accelerations integrated behind the high pass of --corner.
FringeRecords records_of(FitOptions const&);
// The witness is an angle: theta = W (4 pi/lambda) angle, so that multiplicities and factors are in m (per rad).
bool is_rotation(FringeRecords const&);
Dimension multiplicity_dimension(FringeRecords const&);
std::string multiplicity_unit(FringeRecords const&);  // "", or "m" for a rotation
double wavelength_of(FitOptions const&);              // m; of the run, of --wavelength, or 1064 nm
// "1..6", "-20 ms..20 ms", or one value. InputError names the option.
SearchRange option_range(std::string const& text, Dimension, std::string const& option, std::string const& example);
// Common options of a fit of phases and one of edges: band (required), wavelength, and ratio of the second witness.
struct FitGround {
  double low = 0, high = 0, wavelength = 0;  // Hz; m
  SearchRange ratio;
};
FitGround ground_of(FitOptions const&, FringeRecords const&);
FringeFitSettings settings_of(FitOptions const&, FringeRecords const&, std::vector<RoutePrediction> const&);

void add_record_options(CLI::App&, FitOptions&);  // --target ... --gps, --wavelength, --ratio
void add_fit_edge(CLI::App& fit, int& exit_code);

}  // namespace straytrace::cli
