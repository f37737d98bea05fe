// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/cavity_waves.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "results/results.hpp"
#include "scene/model_tree.hpp"
#include "session/build_info.hpp"
#include "session/interrupt.hpp"
#include "trace/deterministic/halo_source.hpp"
#include "wave/arm/arm_checks.hpp"
#include "wave/ring/ring_grid.hpp"
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

}  // namespace straytrace::session
