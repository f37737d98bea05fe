// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/cavity_waves.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <iterator>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/samples.hpp"
#include "base/text/json_text.hpp"
#include "noise/project/static_phase.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "scene/model_tree.hpp"
#include "session/build_info.hpp"
#include "session/interrupt.hpp"
#include "session/open_run.hpp"
#include "trace/deterministic/halo_source.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/ring/ring_cavity.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {
namespace {

constexpr int kept_orders = 2;  // of the modes in a run file

// Hash of all that decides the numbers of the field: surfaces, materials and modes; what wave_inputs() lists; the
// program.
std::string key_of(Model const& model) {
  std::vector<std::string> parts{build_info::version, build_info::commit, model.world.fingerprint()};
  std::ranges::move(wave_inputs(model), std::back_inserter(parts));
  return model_hash(parts);
}

// W; 0: not stated.
double power_of(World const& world) {
  return world.wave.beam < world.beam_powers.size() ? world.beam_powers[world.wave.beam] : 0;
}

// The value of the last of these keys that the scene has.
Node cause_of(Node table, std::vector<std::string> const& keys) {
  for (std::string const& key : keys) {
    if (table.kind() != Node::Kind::table || !table.has(key)) break;
    table = table[key];
  }
  return table;
}

void tell(Node const& table, WaveSettings const& settings, ArmProblem const& p) {
  Node const at = cause_of(table, p.keys);
  if (!p.in_file) {
    p.severity == Severity::error ? at.problem(p.what, p.remedy) : at.warning(p.what, p.remedy);
    return;
  }
  for (WaveSettings::Mirror const& m : settings.mirrors)
    if (m.name == p.keys.at(1)) at.file_problem(m.file, p.in_file->line, p.in_file->column, p.what, p.remedy);
}

// Progress on stderr; an interrupt ends the computation.
class WaveProgress {
 public:
  explicit WaveProgress(PrintOptions const& print) : line_(print.quiet) {}
  void operator()(std::string const& what) {
    if (guard_.stop())
      throw InputError("interrupted while the field of the cavity was computed; nothing was traced", "run it again");
    std::chrono::duration<double> const passed = std::chrono::steady_clock::now() - begin_;
    line_.at(passed.count(), [&] { return "wave: " + what; });
  }

 private:
  InterruptGuard const guard_;
  ProgressLine line_;
  std::chrono::steady_clock::time_point const begin_ = std::chrono::steady_clock::now();
};

char const* origin(bool stated) { return stated ? "" : " (automatic)"; }

}  // namespace

void plan_waves(Model& model) {
  WaveSettings const& wave = model.world.wave;
  if (!wave.present || !model.scene.root().healthy()) return;
  if (wave.ring)
    model.ring = planned_ring(model.world, wave);
  else
    model.arm = planned_arm(model.world, wave);
  for (ArmProblem const& p : model.ring ? model.ring->problems : model.arm->problems)
    if (!p.of_noise || !model.motion.inputs.empty()) tell(model.scene.table("wave"), wave, p);
}

namespace {

std::string ring_line(RingCavity const& ring, WaveSettings const& wave, double wavelength) {
  Grid const& grid = ring.trip.grid;
  return fmt::format(
      "wave {}: crossover angle {:.4g} urad{}; the light meets {} mirrors and inner edges per round trip\n"
      "  grid of {} x {} points{} over {:.4g} m{}, which carries {:.4g} urad; the field needs {:.2g} GB of memory\n",
      wave.beam_name, 1e6 * ring.crossover, origin(wave.crossover.has_value()), ring.stops.size(), grid.points,
      grid.points, origin(wave.points > 0), grid.window, origin(wave.window > 0), 1e6 * grid.largest_angle(wavelength),
      1e-9 * needed_memory(ring));
}

// Keys that the plans of both kinds of cavities have.
nlohmann::ordered_json plan_json(WaveSettings const& wave, double crossover, Grid const& grid, double memory) {
  return {{"beam", wave.beam_name},
          {"crossover_rad", crossover},
          {"crossover_automatic", !wave.crossover.has_value()},
          {"points", grid.points},
          {"points_automatic", wave.points == 0},
          {"window_m", grid.window},
          {"window_automatic", !(wave.window > 0)},
          {"memory_bytes", memory}};
}

}  // namespace

std::string wave_line(Model const& model) {
  if (model.ring) return ring_line(*model.ring, model.world.wave, model.world.wavelength);
  if (!model.arm) return {};
  ArmCavity const& arm = *model.arm;
  WaveSettings const& wave = model.world.wave;
  Grid const& grid = arm.cavity.grid;
  return fmt::format(
      "wave {}: crossover angle {:.4g} urad{}; {} of {} inner edges within it, seen from both mirrors\n"
      "  grid of {} x {} points{} over {:.4g} m{}, which carries {:.4g} urad; the field needs {:.2g} GB of memory\n",
      wave.beam_name, 1e6 * arm.crossover, origin(wave.crossover.has_value()),
      std::ranges::count_if(arm.rims, &ArmRim::in_band), arm.rims.size(), grid.points, grid.points,
      origin(wave.points > 0), grid.window, origin(wave.window > 0), 1e6 * grid.largest_angle(arm.cavity.wavelength),
      1e-9 * needed_memory(arm));
}

nlohmann::ordered_json wave_json(Model const& model) {
  WaveSettings const& wave = model.world.wave;
  if (model.ring) {
    RingCavity const& ring = *model.ring;
    nlohmann::ordered_json all = plan_json(wave, ring.crossover, ring.trip.grid, needed_memory(ring));
    all["stops"] = ring.stops.size();
    return all;
  }
  if (!model.arm) return {};
  ArmCavity const& arm = *model.arm;
  nlohmann::ordered_json all = plan_json(wave, arm.crossover, arm.cavity.grid, needed_memory(arm));
  all["inner_edges"] = arm.rims.size();
  all["inner_edges_within"] = std::ranges::count_if(arm.rims, &ArmRim::in_band);
  return all;
}

Computing computing(TraceOptions const& options) {
  if (options.backend != "cpu" && options.backend != "cuda")
    throw InputError(fmt::format("fields cannot be computed on '{}'", options.backend), "write cpu or cuda");
  return {int(options.threads), options.backend == "cuda" ? cuda_waves() : nullptr};
}

namespace {

ArmWaves solve(Model const& model, ArmCavity arm, Computing const& on, PrintOptions const& print, ArmOptions options) {
  WaveProgress progress(print);
  options.threads = on.threads;
  options.device = on.device;
  options.progress = std::ref(progress);
  return solve_arm(model.world, model.world.wave, std::move(arm), options);
}

}  // namespace

ArmWaves solve_waves(Model const& model, Computing const& on, PrintOptions const& print, ArmOptions options) {
  return solve(model, model.arm.value(), on, print, std::move(options));
}

RingWaves solve_ring_waves(Model const& model, Computing const& on, PrintOptions const& print, ArmOptions options) {
  WaveProgress progress(print);
  options.threads = on.threads;
  options.device = on.device;
  options.progress = std::ref(progress);
  return solve_ring(model.world, model.world.wave, model.ring.value(), options);
}

namespace {

// Of the interferometer, for an arm. For a ring: none of the input mirror, and other mirrors are perfect.
double usual_transmission(Model const& model, std::size_t mirror) {
  if (model.ring) return mirror == 0 ? not_a_number : 0;
  DetectorNumbers const numbers = model.detector ? model.detector->numbers() : DetectorNumbers{};
  return mirror == 0 ? numbers.input_transmission : numbers.end_transmission;
}

}  // namespace

std::vector<MirrorCoating> mirror_coatings(Model const& model) {
  Node const table = model.scene.table("wave");
  std::vector<MirrorCoating> coatings;
  for (WaveSettings::Mirror const& mirror : model.world.wave.mirrors) {
    MirrorCoating const coating{mirror.transmission.value_or(usual_transmission(model, coatings.size())), mirror.loss};
    coatings.push_back(coating);
    std::string const& name = model.world.name_of(mirror.surface);
    if (!std::isfinite(coating.transmission))
      cause_of(table, {"mirrors", name})
          .problem(fmt::format("a driven cavity needs the transmission of '{}'", name),
                   fmt::format("add for example 'mirrors: {{{}: {{transmission: 1.4 %}}}}' to 'wave'{}", name,
                               model.ring ? "" : ", or an 'interferometer'"));
    else if (coating.reflectivity() < 0.01)
      cause_of(table, {"mirrors", name, "loss"})
          .problem(fmt::format("'{}', which transmits {:g} and loses {:g}, holds no light", name, coating.transmission,
                               mirror.loss),
                   "lower 'loss', or state a smaller 'transmission'");
  }
  model.scene.throw_if_problems();
  return coatings;
}

DrivenScan drive_waves(Model const& model, ArmWaves const& waves, DrivePlan const& plan, Computing const& on,
                       PrintOptions const& print, int highest_order) {
  WaveProgress progress(print);
  return drive_arm(model.world.wave, waves, plan.coatings, plan.detunings,
                   {on.threads, on.device, highest_order, std::ref(progress)});
}

DrivenScan drive_waves(Model const& model, RingWaves const& waves, DrivePlan const& plan, PrintOptions const& print,
                       int highest_order) {
  WaveProgress progress(print);
  return drive_ring(model.world, model.world.wave, waves, plan.coatings, plan.detunings,
                    {0, {}, highest_order, std::ref(progress)});
}

void keep_waves(Model& model, ArmWaves const& waves) {
  model.waves = std::make_shared<WaveRecord const>(record_of(model.world, waves, key_of(model), power_of(model.world)));
}

void keep_waves(Model& model, RingWaves const& waves) {
  model.ring_waves = std::make_shared<RingRecord const>(record_of(model.world, waves, power_of(model.world)));
}

ArmWaves solved_or_known(Model& model, unsigned threads, PrintOptions const& print) {
  // Histories start in this field, with the same bits on any device.
  bool const known = model.waves && model.waves->key == key_of(model) && model.waves->device == "cpu";
  if (!known) {
    ArmOptions kept;
    kept.highest_order = kept_orders;
    ArmCavity arm = model.arm.value();
    arm.diodes.clear();  // their mean over mirrors costs as much as the field
    ArmWaves waves = solve(model, std::move(arm), int(threads), print, kept);
    keep_waves(model, waves);
    return waves;
  }
  auto record = std::make_shared<WaveRecord>(*model.waves);
  record->power = power_of(model.world);
  model.waves = record;
  return waves_of(model.world, model.world.wave, model.arm.value(), *record);
}

std::vector<std::string> wave_inputs(Model const& model) {
  ArmCavity const& arm = model.arm.value();
  std::vector<std::string> parts{
      resolved_text(model.scene.table("wave"), {}),
      fmt::format("{} {} {}", arm.crossover, arm.cavity.grid.points, arm.cavity.grid.window)};
  for (WaveSettings::Mirror const& m : model.world.wave.mirrors) parts.push_back(m.bytes);
  return parts;
}

bool starts_in_field(Model const& model) { return model.arm && !model.arm->rims.empty(); }

void light_halo(Model& model, bool as_traced, unsigned threads, PrintOptions const& print) {
  if (!starts_in_field(model)) return;
  WaveRecord const& field = waves_to_show(model, as_traced, threads, print);
  model.world.light_halo(halo_source(model.world, *model.arm, field.irradiance));
}

WaveRecord const& waves_to_show(Model& model, bool as_traced, unsigned threads, PrintOptions const& print) {
  if (!model.arm)
    throw InputError(model.ring ? "the field of a cavity of three mirrors or more has no light on baffles"
                                : "the scene has no table 'wave', which gives the light at small angles",
                     model.ring ? "show the field of a cavity of two mirrors"
                                : "add for example 'wave: {beam: arm, baffles: \"baffle*\"}'");
  if (model.arm->rims.empty())
    throw InputError("the table 'wave' names no baffles that the light at small angles could fall on",
                     "add for example 'baffles: \"baffle*\"' to it");
  bool const known = as_traced && model.waves && model.waves->rims.size() == model.arm->rims.size();
  if (!known) solved_or_known(model, threads, print);
  return *model.waves;
}

bool counts_rims(Scene const& scene) { return scene.root().flag("rims", false); }

void check_rims(Scene const& scene, World const& world, Interferometer const& detector) {
  if (!counts_rims(scene)) return;
  constexpr double probe = 100;  // Hz
  for (CouplingClass const& c : moving_rim_classes(world).classes) {
    if (detector.strain_per_passing_amplitude(c.port, probe)) continue;
    InputError const error = without_passing_amplitude(world.ports()[c.port.value]);
    scene.root()["rims"].problem(error.reason(), error.remedy());
    return;
  }
}

namespace {

constexpr double seam_steps[] = {1 / 1.4142135623730951, 1, 1.4142135623730951};

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
  settings.crossover = seam_steps[2] * own;
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
  for (double const step : seam_steps) {
    try {
      seam.points.push_back(traced_at(model, stated, step * own, grid, bin, options));
    } catch (InputError const& e) {
      if (step == 1 && !guard.stop()) throw;
      seam.warnings.push_back(fmt::format("crossover angle {:.4g} urad: {}", 1e6 * step * own, e.reason()));
    }
    if (guard.stop()) {
      seam.complete = false;
      seam.warnings.push_back(
          fmt::format("interrupted after {} of {} angles", seam.points.size(), std::size(seam_steps)));
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
  double const other = seam_steps[0] * seam.crossover;
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
  return json_text(nlohmann::ordered_json{{"frequency_hz", seam.frequency},
                                          {"complete", seam.complete},
                                          {"points", points},
                                          {"change_of_rays_and_halo", number(seam.change(&SeamPoint::baffles))},
                                          {"change_of_total", number(seam.change(&SeamPoint::total))}});
}

}  // namespace straytrace::session
