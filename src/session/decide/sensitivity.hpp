// SPDX-License-Identifier: BSD-3-Clause
// straytrace sensitivity: which input decides the noise of a run, and which uncertainty (docs/theory/decisions.md).
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "noise/bands/elasticity.hpp"
#include "session/open_run.hpp"
#include "session/options.hpp"

namespace straytrace::session {

enum class InputClass : std::uint8_t { strength, shape, motion, response, traced };
constexpr std::array input_class_names{"strength", "shape", "motion", "response", "traced"};
constexpr char const* name_of(InputClass c) { return input_class_names[std::size_t(c)]; }

// What h depends on, and how far.
struct SensitiveInput {
  InputClass kind = InputClass::strength;
  std::string name;               // "material steel", "motion of tube", "interferometer.mirror_mass", "rim"
  std::string value;              // "scatters 3.1e-05", "42 kg"; of motions empty
  std::string method;             // in words
  BinValues elasticity;           // d ln h/d ln p per bin; value NaN: not known, or no noise
  double factor = 1;              // stated uncertainty, one standard deviation of the logarithm; 1: none
  double low = 1, high = 1;       // stated bracket, a range
  std::vector<double> share{};    // of the variance of ln h by all stated standard deviations, per bin; empty: no part
  std::vector<double> halving{};  // relative narrowing of the band of ln h with half its standard deviation, per bin
  double correlation = not_a_number;  // of the traces at both ends, class traced
  double step = not_a_number;         // of the logarithm, either way, class traced
  BinValues extrapolated{};           // by Richardson from this step and its double, where the step was chosen
  bool stated() const { return factor > 1 || low < 1 || high > 1; }
};

struct Sensitivity {
  FrequencyGrid grid;
  std::vector<SensitiveInput> inputs;  // largest |elasticity| at any of `frequencies` first
  std::vector<std::string> idle;       // inputs that change h nowhere by more than 1e-4 of their own change
  std::vector<double> frequencies;     // Hz, to print
  std::vector<double> band;            // standard deviation of ln h by the stated ones, per bin
  std::vector<bool> sampled;           // bins where band and shares are sampled: first order fails (eq. D.13)
  std::size_t decides = 0;             // bin where h is closest to the line; without a line that of the first frequency
  std::string line;                    // "0.1 x adv-lal"; empty: none
  NoiseTrace total;
  std::vector<std::string> warnings;
  bool stopped = false;  // by a signal: inputs to trace are missing
};

struct SensitivityOrder {
  std::vector<double> frequencies;  // Hz, to print
  std::vector<InputClass> only;     // empty: all
  std::vector<std::string> traced;  // parameters or places of values, for a trace at both ends of a step
  std::optional<double> step{};     // of their logarithms; none: chosen
  TraceOptions options{};           // of these traces
  bool wants(InputClass c) const { return only.empty() || std::ranges::find(only, c) != only.end(); }
};

// Adds an error for each name in `traced` that the scene of the run does not have.
void add_errors_of_traced(OpenRun const&, SensitivityOrder const&, std::vector<InputError>&);

// `progress`: gets the name of each input before it is computed.
Sensitivity sensitivity(OpenRun const&, SensitivityOrder const&,
                        std::function<void(std::string const&)> const& progress);

// "Measure the BRDF of steel next: ...".
std::string next_measurement(Sensitivity const&);
std::string sensitivity_text(Sensitivity const&);
std::string sensitivity_csv(Sensitivity const&);
std::string sensitivity_json(Sensitivity const&);

}  // namespace straytrace::session
