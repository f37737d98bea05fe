// SPDX-License-Identifier: BSD-3-Clause
// The answer of an inversion in words and as JSON.
#pragma once

#include <string>
#include <vector>

#include "app/model.hpp"
#include "noise/inversion.hpp"
#include "report/report.hpp"

namespace straytrace {

struct Answer {
  enum class Subject { scatter, motion } subject = Subject::scatter;
  std::string what, line;  // "brdf(steel)", "0.1 x adv-lal"
  Inversion inversion;
  FrequencyGrid grid;
  std::vector<double> line_asd;         // 1/sqrt(Hz)
  std::vector<std::string> unresolved;  // routes that are not in the total: no answer then
  double tis = not_a_number;            // scattered share at normal incidence, of what was traced
  std::vector<double> motion;           // m/sqrt(Hz), root of the sum over the axes, per bin
  bool complete = true;
};

Answer answer_about(Model const&, NoiseBudget const&, Inversion);
// Root of the summed PSD of the three translations of a body, m/sqrt(Hz).
std::vector<double> root_spectrum(MotionSet const&, BodyId, FrequencyGrid const&);

std::string answer_text(Answer const&, bool per_frequency);
std::string answer_json(Answer const&);

}  // namespace straytrace
