// SPDX-License-Identifier: BSD-3-Clause
// straytrace scan --invert: the scatter, motion or parameter that keeps the total under a line.
#pragma once

#include <string>
#include <vector>

#include "noise/bands/inversion.hpp"
#include "results/results.hpp"
#include "session/model.hpp"
#include "session/scan/scan_points.hpp"

namespace straytrace::session {

struct InvertOrder {
  std::string what;            // "brdf(steel)", "motion(tube)", "param(aperture)"
  bool per_frequency = false;  // the whole curve
  double tolerance = 0.01;     // param: width of the answer over the range
};

// Prints the result; returns the exit code. `axes`: for param, the single search range.
// Throws `errors`, those of other options, together with its own.
int invert(ScanOptions const&, Requirement const&, InvertOrder const&, std::vector<ScanAxis> const& axes,
           std::vector<InputError> errors);

// The case of a parameter: traces at both ends of the range and between them.
int invert_parameter(ScanOptions const&, Requirement const&, InvertOrder const&, std::string const& name,
                     std::vector<ScanAxis> const& axes);

// The answer of an inversion in words and as JSON.

struct Answer {
  enum class Subject { scatter, motion } subject = Subject::scatter;
  std::string what, line;  // "brdf(steel)", "0.1 x adv-lal"
  Inversion inversion;
  FrequencyGrid grid;
  std::vector<double> line_asd;         // 1/sqrt(Hz)
  std::vector<std::string> unresolved;  // routes that are not in the total: then there is no result
  double tis = not_a_number;            // scattered share at normal incidence, of the traced model
  std::vector<double> motion;           // m/sqrt(Hz), root of the sum over the axes, per bin
  bool complete = true;
};

Answer answer_about(ProjectionModel const&, NoiseBudget const&, Inversion);
// Root of the summed PSD of the three translations of a body, m/sqrt(Hz).
std::vector<double> root_spectrum(MotionSet const&, BodyId, FrequencyGrid const&);

std::string answer_text(Answer const&, bool per_frequency);
std::string answer_json(Answer const&);

}  // namespace straytrace::session
