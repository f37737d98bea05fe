// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/seam.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "base/errors.hpp"
#include "base/math/samples.hpp"
#include "results/text/columns.hpp"
#include "session/diagnostics.hpp"
#include "session/interrupt.hpp"
#include "session/light/cavity_waves.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/arm_checks.hpp"

namespace straytrace::session {
namespace {

constexpr double steps[] = {1 / 1.4142135623730951, 1, 1.4142135623730951};

// Variance of a sum whose terms are independent samples of one quantity.
double variance_of_sum(std::vector<double> const& terms) {
  return terms.size() < 2 ? 0 : sample_variance(terms) * double(terms.size());
}

void add_scaled(std::vector<double>& sum, std::vector<double> const& terms, double factor) {
  sum.resize(std::max(sum.size(), terms.size()));
  for (std::size_t i = 0; i < terms.size(); ++i) sum[i] += factor * terms[i];
}

void add_route(SeamCurve& curve, NoiseTrace const& route, CouplingClass const& c, std::size_t bin,
               std::size_t heights) {
  if (c.kind == ClassKind::halo) return add_scaled(curve.halo, c.azimuth_parts, route.psd(bin) / c.coupling.mean);
  if (c.kind != ClassKind::wave) {
    curve.variance += std::pow(route.psd_sigma(bin), 2);
    return;
  }
  // Draws of one draw of the heights share its speckle: with several, each is a sample.
  std::size_t const count = route.draws.size(), samples = heights > 1 ? heights : count;
  std::vector<double> draws(samples);
  for (std::size_t i = 0; i < count; ++i)
    draws[i * samples / count] += route.draws[i][bin] * route.draws[i][bin] / double(count);
  if (curve.edges.empty() || curve.edges.size() == draws.size())
    add_scaled(curve.edges, draws, 1);
  else
    curve.variance += variance_of_sum(draws);
}

// Sum of the PSDs of the routes of some kinds, of unresolved ones the observed part with an error as large, as in
// NoiseBudget::total; errors of routes are independent. NaN where rays are among the kinds and none of their routes is
// resolved.
SeamCurve curve_of(NoiseBudget const& budget, CouplingTable const& table, std::vector<ClassKind> const& kinds,
                   std::size_t bin, std::size_t heights) {
  SeamCurve curve;
  double psd = 0;
  bool traced = std::ranges::find(kinds, ClassKind::scattered) == kinds.end();
  for (std::size_t i = 0; i < table.classes.size(); ++i) {
    NoiseTrace const& route = budget.routes[i];
    CouplingClass const& c = table.classes[i];
    double const part = route.psd(bin);
    if (!(part >= 0) || std::ranges::find(kinds, c.kind) == kinds.end()) continue;
    psd += part;
    if (route.resolved)
      add_route(curve, route, c, bin, heights);
    else
      curve.variance += part * part;
    traced = traced || (route.resolved && c.kind == ClassKind::scattered);
  }
  double const asd = std::sqrt(psd),
               sigma = std::sqrt(curve.variance + variance_of_sum(curve.halo) + variance_of_sum(curve.edges));
  curve.strain = traced ? WithError{asd, asd > 0 ? sigma / (2 * asd) : 0} : WithError{not_a_number, not_a_number};
  return curve;
}

// Of the ratio of two curves.
double error_of_ratio(SeamCurve const& one, SeamCurve const& two) {
  double const psd_one = std::pow(one.strain.value, 2), psd_two = std::pow(two.strain.value, 2);
  double variance = one.variance / std::pow(psd_one, 2) + two.variance / std::pow(psd_two, 2);
  for (auto const terms : {&SeamCurve::halo, &SeamCurve::edges}) {
    std::vector<double> change;
    add_scaled(change, one.*terms, 1 / psd_one);
    add_scaled(change, two.*terms, -1 / psd_two);
    variance += variance_of_sum(change);
  }
  return 0.5 * std::sqrt(variance) * one.strain.value / two.strain.value;
}

SeamPoint point_of(NoiseBudget const& budget, CouplingTable const& table, double crossover, std::size_t bin,
                   std::size_t heights) {
  using enum ClassKind;
  auto const curve = [&](std::vector<ClassKind> const& kinds) { return curve_of(budget, table, kinds, bin, heights); };
  return {crossover,
          curve({scattered}),
          curve({halo}),
          curve({scattered, halo}),
          curve({edge, wave, speckle}),
          curve({scattered, ghost, edge, wave, speckle, halo, rim})};
}

// 10 Hz where the band holds it, otherwise its lower end.
std::size_t bin_of_check(FrequencyGrid const& grid) {
  std::size_t const bin = grid.bin_of(10);
  return bin < grid.size() ? bin : 0;
}

// For the largest crossover angle. Heights of the mirrors are random numbers by frequency, so that one window gives all
// angles the same heights; one number of points keeps the error of the grid out of the comparison.
Grid common_grid(World const& world, double own) {
  WaveSettings settings = world.wave;
  settings.points = 0;
  settings.window = 0;
  settings.crossover = steps[2] * own;
  ArmCavity const arm = planned_arm(world, settings);
  Grid grid = arm.cavity.grid;
  if (std::ranges::any_of(arm.problems, [](ArmProblem const& p) { return p.severity == Severity::error; }))
    grid.points = 0;  // that angle is out of reach: each of the others has its own
  return grid;
}

// Field and rays by the present table `wave`.
void plan_anew(Model& model) {
  model.arm = planned_arm(model.world, model.world.wave);
  for (ArmProblem const& p : model.arm->problems)
    if (p.severity == Severity::error) throw InputError(p.what, p.remedy);
  begin_rays_at_crossover(model.world);
}

// Noise at a crossover angle on a grid. Leaves the model at that angle.
SeamPoint traced_at(Model& model, WaveSettings const& stated, double crossover, Grid const& grid, std::size_t bin,
                    TraceOptions const& options) {
  model.world.wave = stated;
  model.world.wave.crossover = crossover;
  model.world.wave.window = grid.window;
  model.world.wave.points = std::uint32_t(grid.points);
  plan_anew(model);
  TracedModel const traced = trace_model(model, options, "");
  return point_of(model.project(traced.result.coupling), traced.result.coupling, crossover, bin, stated.map_draws);
}

SeamCheck::Light light_of(Seam const& seam, SeamCurve SeamPoint::*curve) {
  WithError const change = seam.change(curve);
  SeamCurve const &here = seam.points[0].*curve, &there = seam.points[1].*curve;
  return {here.strain.value, here.strain.sigma, there.strain.value, there.strain.sigma, change.value, change.sigma};
}

}  // namespace

WithError Seam::change(SeamCurve SeamPoint::*curve) const {
  WithError largest{0, 0};
  auto const middle = std::ranges::find(points, crossover, &SeamPoint::crossover);
  if (middle == points.end() || points.size() < 2) return {not_a_number, not_a_number};
  for (SeamPoint const& p : points) {
    if (p.crossover == crossover) continue;
    SeamCurve const &one = p.*curve, &two = (*middle).*curve;
    WithError const change{one.strain.value / two.strain.value - 1, error_of_ratio(one, two)};
    if (std::isnan(change.value)) return change;
    if (std::fabs(change.value) >= std::fabs(largest.value)) largest = change;
  }
  return largest;
}

Seam check_seam(Model& model, TraceOptions const& options) {
  std::vector<InputError> errors;
  if (!model.detector)
    errors.emplace_back("without an interferometer there is no noise to compare",
                        "add 'ports' and 'interferometer' to the scene");
  if (model.motion.inputs.empty())
    errors.emplace_back("nothing moves, so there is no noise to compare",
                        "give a body 'motion', for example 'bodies: {baffles: {motion: {x: {peterson: typical}}}}'");
  throw_all(errors);
  InterruptGuard const guard;
  WaveSettings const stated = model.world.wave;
  double const own = crossover_angle(model.world, stated);
  Seam seam;
  seam.crossover = own;
  seam.one_draw = stated.map_draws == 1 && stated.random();
  std::size_t const bin = bin_of_check(model.noise.grid);
  seam.frequency = model.noise.grid.centre(bin);
  Grid const grid = common_grid(model.world, own);
  for (double const step : steps) {
    try {
      seam.points.push_back(traced_at(model, stated, step * own, grid, bin, options));
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

bool has_seam(Model const& model) { return starts_in_field(model) && model.detector && !model.motion.inputs.empty(); }

std::uint64_t histories_of_seam(std::uint64_t of_run) {
  constexpr std::uint64_t fewest = 1 << 14;
  return std::max(of_run / 4, std::min(of_run, fewest));
}

std::shared_ptr<SeamCheck const> check_seam(Model again, TraceResult const& run, TraceOptions const& options) {
  if (!has_seam(again)) return {};
  InterruptGuard const guard;
  WaveSettings const stated = again.world.wave;
  Grid const grid = again.arm->cavity.grid;
  std::size_t const bin = bin_of_check(again.noise.grid);
  Seam seam;
  seam.crossover = crossover_angle(again.world, stated);
  seam.points.push_back(point_of(again.project(run.coupling), run.coupling, seam.crossover, bin, stated.map_draws));
  again.seed = run.coupling.seed;
  again.histories = histories_of_seam(run.coupling.histories);
  again.world.block_size = block_size_of(again.histories);
  again.until = {};
  again.waves.reset();
  TraceOptions print = options;
  print.warnings = false;
  print.slice = print.slices = 1;
  double const other = steps[0] * seam.crossover;
  if (!options.quiet)
    std::cerr << fmt::format("comparing with a crossover angle of {:.4g} urad, {:.3g} histories\n", 1e6 * other,
                             double(again.histories));
  try {
    seam.points.push_back(traced_at(again, stated, other, grid, bin, print));
  } catch (InputError const& e) {
    if (!guard.stop())
      print_warning(fmt::format("the crossover angle could not be checked: {}\n  {}", e.reason(), e.remedy()), options);
    return {};
  }
  if (guard.stop()) return {};
  return std::make_shared<SeamCheck const>(SeamCheck{again.noise.grid.centre(bin), seam.crossover, other,
                                                     again.histories, light_of(seam, &SeamPoint::baffles),
                                                     light_of(seam, &SeamPoint::total)});
}

constexpr char one_draw[] =
    "One draw of the heights: the error of edges holds the roll of a mirror alone ('map_draws: 8' states that over "
    "mirrors).\n";

std::string seam_text(Seam const& seam) {
  Columns table{{"crossover/urad", "rays", "halo", "rays and halo", "edges", "all"}, {}, {}};
  auto const cell = [](SeamCurve const& c) {
    return std::isnan(c.strain.value) ? "not resolved" : with_error(c.strain);
  };
  for (SeamPoint const& p : seam.points)
    table.rows.push_back({fmt::format("{:.4g}", 1e6 * p.crossover), cell(p.rays), cell(p.halo), cell(p.baffles),
                          cell(p.edges), cell(p.total)});
  auto const percent = [](WithError const& change) {
    if (std::isnan(change.value)) return std::string("not known");
    return fmt::format("{:+.2g} % ± {:.2g} %", 100 * change.value, 100 * change.sigma);
  };
  return fmt::format(
      "strain noise at {:.4g} Hz by crossover angle, 1/sqrt(Hz); errors: one standard error, of histories and of the "
      "mean over mirrors\n\n{}{}\n"
      "seam: largest change of rays and halo {}, of all stray light {}\n",
      seam.frequency, aligned(table), seam.one_draw ? one_draw : "", percent(seam.change(&SeamPoint::baffles)),
      percent(seam.change(&SeamPoint::total)));
}

std::string seam_json(Seam const& seam) {
  auto const number = [](WithError const& x) { return nlohmann::ordered_json{{"value", x.value}, {"sigma", x.sigma}}; };
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (SeamPoint const& p : seam.points)
    points.push_back({{"crossover_rad", p.crossover},
                      {"rays", number(p.rays.strain)},
                      {"halo", number(p.halo.strain)},
                      {"rays_and_halo", number(p.baffles.strain)},
                      {"edges", number(p.edges.strain)},
                      {"total", number(p.total.strain)}});
  return nlohmann::ordered_json{{"frequency_hz", seam.frequency},
                                {"complete", seam.complete},
                                {"points", points},
                                {"change_of_rays_and_halo", number(seam.change(&SeamPoint::baffles))},
                                {"change_of_total", number(seam.change(&SeamPoint::total))}}
      .dump();
}

}  // namespace straytrace::session
