// SPDX-License-Identifier: BSD-3-Clause
#include "noise/project/predicted_coupling.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::noise {
namespace {

// Mean-square phase [rad^2] of the test motion on a path of `many_bounces` normal-incidence bounces: first order is
// exact to a part in 1e8.
constexpr double test_phase_squared = 1e-8, many_bounces = 100;

constexpr double shows_from = 0.01;  // of the observed coupling power: routes below it do not bend the coupling

NoiseBudget project_alone(CouplingTable const& table, MotionInput input, std::vector<std::string> const& bodies,
                          Interferometer const& ifo, FrequencyGrid const& grid) {
  MotionSet motion;
  motion.bodies = bodies;
  motion.inputs.push_back(std::move(input));
  NoiseSettings settings;
  settings.grid = grid;
  return project_noise(table, motion, ifo, settings);
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

}  // namespace

PredictedCoupling predict_coupling(CouplingTable const& table, std::vector<std::string> const& bodies,
                                   Interferometer const& ifo, FrequencyGrid const& grid, BodyAxis where) {
  double const low = grid.edges.front() / 2, high = 2 * grid.edges.back();
  double const rms = std::sqrt(test_phase_squared) * table.wavelength / (4 * pi * many_bounces);
  double const psd = rms * rms / (high - low), scale = 1 / std::sqrt(psd);
  MotionInput input;
  input.name = "test motion";
  input.spectrum = Spectrum({low, high}, {psd, psd});
  input.gains = {{where.body, where.axis}};
  NoiseBudget const budget = project_alone(table, input, bodies, ifo, grid);
  PredictedCoupling out;
  out.grid = grid;
  out.factor = scaled(budget.total.asd, scale);
  out.sigma = scaled(budget.total.sigma, scale);
  out.bound_share = budget.total.bound_share;
  out.unresolved = budget.unresolved;
  double all = 0, observed = 0;
  for (NoiseTrace const& t : budget.routes) {
    PredictedRoute r;
    r.name = t.name;
    r.factor = scaled(t.asd, scale);
    r.sigma = scaled(t.sigma, scale);
    r.phase = std::sqrt(t.mean_square_phase) / rms;
    r.multiplicity = r.phase * table.wavelength / (4 * pi);
    r.resolved = t.resolved;
    r.upper_bound = t.upper_bound;
    r.why_not = t.why_not;
    for (std::size_t i = 0; i < grid.size(); ++i) r.share += r.factor[i] * r.factor[i] * grid.width(i);
    if (r.share == 0) continue;  // does not touch the body
    if (r.resolved) all += r.share;
    observed += r.share;
    out.routes.push_back(std::move(r));
  }
  double steepest = 0;
  for (PredictedRoute const& r : out.routes)
    if (r.share >= shows_from * observed) steepest = std::max(steepest, r.phase);
  if (steepest > 0) out.linear_to = 1 / steepest;
  for (PredictedRoute& r : out.routes) r.share = all > 0 ? r.share / all : not_a_number;
  std::ranges::stable_sort(out.routes, [](PredictedRoute const& a, PredictedRoute const& b) {
    return std::pair(a.resolved, a.share) > std::pair(b.resolved, b.share);
  });
  return out;
}

DrivenResponse drive_body(CouplingTable const& table, std::vector<std::string> const& bodies, Interferometer const& ifo,
                          FrequencyGrid const& grid, BodyAxis where, double peak, double hz) {
  MotionInput input;
  input.name = "drive";
  input.tone_frequency = hz;
  input.gains = {{where.body, where.axis, peak}};
  DrivenResponse out;
  out.budget = project_alone(table, input, bodies, ifo, grid);
  for (NoiseTrace const& t : out.budget.routes) {
    double const z = std::sqrt(2 * t.mean_square_phase);  // of a sine
    if (z > 0) out.routes.push_back({t.name, z, z * hz, t.resolved});
    out.phase_peak = std::max(out.phase_peak, z);
  }
  out.cutoff = out.phase_peak * hz;
  return out;
}

MotionSet motion_along(MotionSet const& motion, BodyAxis where) {
  MotionSet out;
  out.bodies = motion.bodies;
  for (MotionInput input : motion.inputs) {
    std::erase_if(input.gains, [&](Gain const& g) { return !(g.body == where.body && g.axis == where.axis); });
    if (!input.gains.empty()) out.inputs.push_back(std::move(input));
  }
  return out;
}

double rms_of(MotionSet const& motion, BodyAxis where) {
  PhaseSensitivity phase_sensitivity;
  phase_sensitivity.body = where.body;
  phase_sensitivity.d[where.axis] = 1;
  MotionSet const own = motion_along(motion, where);
  double sum = 0;
  for (std::size_t i = 0; i < own.inputs.size(); ++i) {
    MotionInput const& input = own.inputs[i];
    if (input.drift) continue;
    auto const squared = [&](double f) { return own.sensitivity(i, {&phase_sensitivity, 1}, f); };
    sum += input.tone_frequency > 0 ? squared(input.tone_frequency) / 2
                                    : input.spectrum.multiplied(squared, input.spectrum.hz()).total();
  }
  return std::sqrt(sum);
}

}  // namespace straytrace::noise
