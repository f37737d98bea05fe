// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/fringes/fringe_clock.hpp"

#include <algorithm>
#include <cmath>

namespace straytrace {
namespace {

struct Alternative {
  FringeFitSettings settings;
  RefinedFit fit;
  std::vector<double> psd;
  FringeFit report;
};

Alternative fitted(FringeProblem const& problem, FringeFitSettings settings) {
  Alternative out{std::move(settings), {}, problem.stretch.psd(problem.stretch.target()), {}};
  FringeProblem again{problem.stretch, out.settings, problem.responses, out.psd};
  again.responses.resize(out.settings.paths.size());
  out.fit = fit_all(again);
  report_parameters(out.report, again, out.fit);
  out.psd = again.psd;
  return out;
}

// The first path finds the delay, which all paths share.
Alternative with_delay(FringeProblem const& problem) {
  FringeFitSettings settings = problem.settings;
  SearchRange& delay = settings.paths[0].delay;
  delay = {delay.low - settings.clock, delay.high + settings.clock};
  settings.paths.resize(1);
  Alternative first = fitted(problem, settings);
  if (problem.settings.paths.size() == 1) return first;
  settings = problem.settings;
  Fitted const common = first.report.paths[0].delay;
  for (FringePath& p : settings.paths) p.delay = {common.value, common.value};
  Alternative all = fitted(problem, settings);
  for (FittedPath& p : all.report.paths) p.delay = common;
  return all;
}

}  // namespace

ClockCheck clock_check(FringeProblem const& problem, RefinedFit const& fit, FringeFit const& found) {
  Alternative const other = with_delay(problem);
  ClockCheck out{problem.settings.clock, other.report.paths[0].delay, 0, other.report.paths};
  // Both against one noise level: that of the fit with the delay.
  FringeProblem const same{problem.stretch, problem.settings, problem.responses, other.psd};
  out.gain = refine(same, fit.place).fit.chi2 - other.fit.fit.chi2;
  FringeFitSettings first = other.settings;
  first.paths[0].delay = {-out.range, out.range};
  SearchGrid const grid = search_grid(problem.stretch, first, 0, fit.place.ratio);
  double const places = grid.transforms() * double(grid.delay.size());
  out.better = out.gain / 2 - std::log(places) > -std::log(problem.settings.false_alarm);
  for (std::size_t p = 0; p < out.paths.size(); ++p)
    out.doubtful |= out.better && std::fabs(out.paths[p].amplitude.value - found.paths[p].amplitude.value) >
                                      found.paths[p].amplitude.sigma;
  return out;
}

}  // namespace straytrace
