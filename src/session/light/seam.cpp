// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/seam.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "results/text/columns.hpp"
#include "session/diagnostics.hpp"
#include "session/interrupt.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/arm_checks.hpp"

namespace straytrace::session {
namespace {

constexpr double steps[] = {1 / 1.4142135623730951, 1, 1.4142135623730951};

// Standard error of the PSD of a route: of histories and, of routes computed in the field of the cavity, of the mean
// over mirrors where it is known.
double psd_error(NoiseTrace const& route, CouplingClass const& c, std::size_t bin) {
  double mirrors = 0;
  if (!route.draws_sigma.empty())
    mirrors = 2 * route.asd[bin] * route.draws_sigma[bin];
  else if (c.kind == ClassKind::halo && c.coupling.mean > 0)
    mirrors = route.psd(bin) * c.coupling.std_error / c.coupling.mean;
  return std::hypot(route.psd_sigma(bin), mirrors);
}

// Sum of the PSDs of the resolved routes of some kinds; errors of routes are independent. NaN where rays are among the
// kinds and none of their routes is resolved.
WithError curve_of(NoiseBudget const& budget, CouplingTable const& table, std::vector<ClassKind> const& kinds,
                   std::size_t bin) {
  double psd = 0, variance = 0;
  bool traced = std::ranges::find(kinds, ClassKind::scattered) == kinds.end();
  for (std::size_t i = 0; i < table.classes.size(); ++i) {
    NoiseTrace const& route = budget.routes[i];
    if (!route.resolved || std::ranges::find(kinds, table.classes[i].kind) == kinds.end()) continue;
    psd += route.psd(bin);
    double const error = psd_error(route, table.classes[i], bin);
    variance += error * error;
    traced = traced || table.classes[i].kind == ClassKind::scattered;
  }
  if (!traced) return {not_a_number, not_a_number};
  double const asd = std::sqrt(psd);
  return {asd, asd > 0 ? std::sqrt(variance) / (2 * asd) : 0};
}

SeamPoint point_of(NoiseBudget const& budget, CouplingTable const& table, double crossover, std::size_t bin) {
  using enum ClassKind;
  auto const curve = [&](std::vector<ClassKind> const& kinds) { return curve_of(budget, table, kinds, bin); };
  return {crossover,
          curve({scattered}),
          curve({halo}),
          curve({scattered, halo}),
          curve({edge, wave, speckle}),
          curve({scattered, ghost, edge, wave, speckle, halo})};
}

// 10 Hz where the band holds it, otherwise its lower end.
std::size_t bin_of_check(FrequencyGrid const& grid) {
  std::size_t const bin = grid.bin_of(10);
  return bin < grid.size() ? bin : 0;
}

// Of the largest crossover angle that a grid carries. Heights of the mirrors are random numbers by frequency, so that
// one window gives all angles the same heights.
double window_of(World const& world, double own) {
  WaveSettings settings = world.wave;
  settings.points = 0;
  settings.window = 0;
  settings.crossover = steps[2] * own;
  return planned_arm(world, settings).cavity.grid.window;
}

// Field and rays by the present table `wave`.
void plan_anew(Model& model) {
  model.arm = planned_arm(model.world, model.world.wave);
  for (ArmProblem const& p : model.arm->problems)
    if (p.severity == Severity::error) throw InputError(p.what, p.remedy);
  begin_rays_at_crossover(model.world);
}

}  // namespace

WithError Seam::change(WithError SeamPoint::*curve) const {
  WithError largest{0, 0};
  auto const middle = std::ranges::find(points, crossover, &SeamPoint::crossover);
  if (middle == points.end() || points.size() < 2) return {not_a_number, not_a_number};
  for (SeamPoint const& p : points) {
    if (p.crossover == crossover) continue;
    WithError const one = p.*curve, two = (*middle).*curve;
    WithError const change{one.value / two.value - 1, std::hypot(one.sigma, two.sigma) / two.value};
    if (std::isnan(change.value)) return change;
    if (std::fabs(change.value) >= std::fabs(largest.value)) largest = change;
  }
  return largest;
}

Seam check_seam(Model& model, TraceOptions const& options) {
  if (!model.detector)
    throw InputError("without an interferometer there is no noise to compare",
                     "add 'ports' and 'interferometer' to the scene");
  InterruptGuard const guard;
  WaveSettings const stated = model.world.wave;
  double const own = crossover_angle(model.world, stated);
  Seam seam;
  seam.crossover = own;
  seam.map_draws = stated.map_draws;
  std::size_t const bin = bin_of_check(model.noise.grid);
  seam.frequency = model.noise.grid.centre(bin);
  double const window = window_of(model.world, own);
  for (double const step : steps) {
    model.world.wave = stated;
    model.world.wave.crossover = step * own;
    model.world.wave.window = window;
    model.world.wave.points = 0;  // the grid of the scene need not carry it
    try {
      plan_anew(model);
      TracedModel const traced = trace_model(model, options, "");
      seam.points.push_back(point_of(model.project(traced.result.coupling), traced.result.coupling, step * own, bin));
    } catch (InputError const& e) {
      if (step == 1 && !guard.stop()) throw;
      seam.warnings.push_back(fmt::format("crossover angle {:.4g} urad: {}", 1e6 * step * own, e.reason()));
    }
    if (guard.stop()) {
      seam.complete = false;
      seam.warnings.push_back(fmt::format("interrupted after {} of {} angles", seam.points.size(), std::size(steps)));
      break;
    }
  }
  model.world.wave = stated;
  plan_anew(model);
  return seam;
}

constexpr char one_draw[] =
    "One draw of the mirrors: the error of edges leaves out how they differ between mirrors ('map_draws: 8' states "
    "it).\n";

std::string seam_text(Seam const& seam) {
  Columns table{{"crossover/urad", "rays", "halo", "rays and halo", "edges", "all"}, {}, {}};
  auto const cell = [](WithError const& x) { return std::isnan(x.value) ? "not resolved" : with_error(x); };
  for (SeamPoint const& p : seam.points)
    table.rows.push_back({fmt::format("{:.4g}", 1e6 * p.crossover), cell(p.rays), cell(p.halo), cell(p.baffles),
                          cell(p.edges), cell(p.total)});
  auto const percent = [](WithError const& change) {
    if (std::isnan(change.value)) return std::string("not known");
    return fmt::format("{:+.2g} % ± {:.2g} %", 100 * change.value, 100 * change.sigma);
  };
  return fmt::format(
      "strain noise at {:.4g} Hz by crossover angle, 1/sqrt(Hz); errors: one standard error, of histories and of the "
      "mean "
      "over mirrors\n\n{}{}\n"
      "seam: largest change of rays and halo {}, of all stray light {}\n",
      seam.frequency, aligned(table), seam.map_draws > 1 ? "" : one_draw, percent(seam.change(&SeamPoint::baffles)),
      percent(seam.change(&SeamPoint::total)));
}

std::string seam_json(Seam const& seam) {
  auto const number = [](WithError const& x) { return nlohmann::ordered_json{{"value", x.value}, {"sigma", x.sigma}}; };
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (SeamPoint const& p : seam.points)
    points.push_back({{"crossover_rad", p.crossover},
                      {"rays", number(p.rays)},
                      {"halo", number(p.halo)},
                      {"rays_and_halo", number(p.baffles)},
                      {"edges", number(p.edges)},
                      {"total", number(p.total)}});
  return nlohmann::ordered_json{{"frequency_hz", seam.frequency},
                                {"complete", seam.complete},
                                {"points", points},
                                {"change_of_rays_and_halo", number(seam.change(&SeamPoint::baffles))},
                                {"change_of_total", number(seam.change(&SeamPoint::total))}}
      .dump();
}

}  // namespace straytrace::session
