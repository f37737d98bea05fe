// SPDX-License-Identifier: BSD-3-Clause
// straytrace wave: the field of a cavity at small angles, where its light goes, and what edges of baffles couple back.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/wave/wave_output.hpp"
#include "results/curves/curve_file.hpp"
#include "results/results.hpp"
#include "results/text/picture.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/model.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct WaveOptions : TraceOptions {
  std::size_t show = 12;
  int order = 2;
  bool grid_check = false, by_frequency = false, seam = false;
  std::optional<std::string> detuning;
  std::string csv, out, plot;
  bool fields = false;
};

int print_seam(Model& model, WaveOptions const& options) {
  apply(options, model);
  Seam const seam = check_seam(model, options);
  for (std::string const& warning : seam.warnings) print_warning(warning, options);
  std::cout << (options.json() ? seam_json(seam) + '\n' : seam_text(seam));
  return seam.complete ? done : checkpointed;
}

// Histories are not overwritten by a file without any.
void refuse_loss_of_histories(WaveOptions const& options, Model const& model) {
  auto const earlier = earlier_run(options.out, model.hash(), model.seed, options.force);
  if (earlier && earlier->trace.total.histories > 0)
    throw InputError(fmt::format("'{}' contains {:.3g} histories, which would be lost", options.out,
                                 double(earlier->trace.total.histories)),
                     "choose another file with -o, or overwrite it with --force");
}

// Includes and data files.
void refuse_files_of_scene(std::string const& output, Scene const& scene, std::string const& input) {
  std::filesystem::path const folder = std::filesystem::path(input).parent_path();
  for (auto const& [name, text] : scene.files()) refuse_overwriting(output, (folder / name).string());
}

// All that is wrong with the options, before any work. Nothing without --detuning.
std::optional<DrivePlan> checked(WaveOptions const& options, Model const& model) {
  std::vector<InputError> errors;
  auto const collect = [&](auto const& step) {
    try {
      step();
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  };
  for (std::string const& output : {options.csv, options.plot})
    collect([&] { refuse_files_of_scene(output, model.scene, options.input); });
  if (!options.out.empty()) collect([&] { refuse_loss_of_histories(options, model); });
  std::optional<DrivePlan> driven;
  if (options.detuning) {
    driven.emplace();
    if (!options.plot.empty()) collect([&] { check_ending(options.plot, {".png"}, "--plot"); });
    double const round_trip = model.ring ? model.ring->length() : 2 * model.arm.value().cavity.length;
    collect([&] { driven->detunings = parse_detunings(*options.detuning, round_trip, model.world.wavelength); });
    collect([&] { driven->coatings = mirror_coatings(model); });
  } else if (!options.csv.empty() && model.world.wave.photodiodes.empty()) {
    errors.emplace_back("--csv is for photodiodes, which the scene has none of, or for a scan of detuning",
                        "add 'photodiodes' to the table 'wave', or for example --detuning -0.5..0.5:1001");
  }
  throw_all(errors);
  return driven;
}

void write_driven(DrivenScan const& driven, World const& world, WaveOptions const& options) {
  std::string message, picture;
  if (!options.plot.empty()) picture = picture_of(json_text(driven_json(driven, world)), "detuning", message);
  if (!options.plot.empty() && picture.empty()) throw InputError(message, "or remove --plot");
  if (!options.csv.empty()) write_file(options.csv, driven_csv(driven, world));
  if (!options.plot.empty()) write_file(options.plot, picture);
}

// A run without histories, which `run` and `trace` resume without solving the cavity again; and the picture of the
// field where the scan of detuning has not taken its place.
template <class Waves>
void write_field(WaveOptions const& options, Model& model, Waves const& waves) {
  keep_waves(model, waves);
  TraceResult const nothing = nothing_traced(model, options.threads, options);
  RunContent const content = content_of(model, nothing, nullptr);
  if (!options.out.empty()) {
    write_run(options.out, content);
    if (!options.quiet) std::cerr << fmt::format("run file: {}\n", options.out);
  }
  std::string message;
  if (!options.detuning && !options.plot.empty() && !draw_wave_picture(content, options.plot, message))
    throw InputError(message, "or remove --plot");
}

// Prints what is requested of a solved cavity, after the files of its scan.
int print(std::string const& text, nlohmann::ordered_json json, std::optional<DrivenScan> const& driven,
          World const& world, WaveOptions const& options) {
  if (driven) {
    for (std::string const& warning : driven->warnings) print_warning(warning, options);
    write_driven(*driven, world, options);
  }
  if (options.json()) {
    if (driven) json["driven"] = driven_json(*driven, world);
    std::cout << json_text(json) << '\n';
  } else {
    std::cout << text << (driven ? driven_text(*driven, world, options.show) : "");
  }
  return done;
}

int ring(Model& model, WaveOptions const& options, Computing const& on, ArmOptions const& what) {
  if (options.seam || options.by_frequency || options.fields || (!options.plot.empty() && !options.detuning))
    throw InputError(
        "--seam, --by-frequency, --fields, and --plot without --detuning work for two-mirror cavities only",
        "leave them out");
  std::optional<DrivePlan> const wanted = checked(options, model);
  RingWaves const waves = solve_ring_waves(model, on, options, what);
  for (std::string const& warning : waves.ring.warnings) print_warning(warning, options);
  if (!options.out.empty()) write_field(options, model, waves);
  std::optional<DrivenScan> driven;
  if (wanted) driven = drive_waves(model, waves, *wanted, options, options.order);
  return print(ring_text(waves, model.world), ring_json(waves, model.world), driven, model.world, options);
}

int wave(WaveOptions const& options) {
  if (!options.plot.empty()) check_ending(options.plot, {".png", ".pdf", ".svg"}, "--plot");
  Model model = read_model(options.input, options.overrides);
  print_warnings(model.scene, options);
  if (!model.world.wave.present)
    throw InputError(fmt::format("{} has no table 'wave'", options.input),
                     "add for example 'wave: {beam: arm, baffles: \"baffles*\"}'");
  ArmOptions what;
  what.highest_order = options.order;
  what.grid_check = options.grid_check;
  what.by_frequency = options.by_frequency;
  what.fields = options.fields;
  Computing const on = computing(options);
  if (model.world.wave.ring) return ring(model, options, on, what);
  if (options.seam) return print_seam(model, options);
  std::optional<DrivePlan> const wanted = checked(options, model);
  ArmWaves const waves = solve_waves(model, on, options, what);
  for (std::string const& warning : waves.arm.warnings) print_warning(warning, options);
  if (!options.out.empty() || (!options.plot.empty() && !wanted)) write_field(options, model, waves);
  if (!options.csv.empty() && !wanted) write_file(options.csv, photodiodes_csv(waves, model.world));
  std::optional<DrivenScan> driven;
  if (wanted) driven = drive_waves(model, waves, *wanted, on, options, options.order);
  return print(wave_text(waves, model.world, options.show), wave_json(waves, model.world), driven, model.world,
               options);
}

}  // namespace

void add_wave(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<WaveOptions>();
  WaveOptions& o = *options;
  auto* const command = app.add_subcommand("wave",
                                           "Compute the field of a cavity at small angles: its losses, its modes, and "
                                           "what the inner edges of its baffles couple back.");
  add_scene_options(*command, o);
  command->add_option("--show", o.show, "rows of inner edges and of photodiodes")->check(whole_between(1, 1e6, "20"));
  command->add_option("--order", o.order, "highest order of the modes listed")->check(whole_between(0, 8, "2"));
  command->add_flag(
      "--grid-check", o.grid_check,
      "solve again on a grid of 1.4 times the points and print the changes, for some three times the time");
  auto* const seam = command->add_flag(
      "--seam", o.seam,
      "trace the scene at 0.7, 1 and 1.4 times its crossover angle, on which the noise must not depend");
  add_history_options(*command, o);
  for (char const* const of_traces : {"--histories", "--seed"}) command->get_option(of_traces)->needs(seam);
  command->add_flag("--by-frequency", o.by_frequency,
                    "split the loss by the spatial frequency of the heights of the mirrors; solves once per octave");
  command->add_option("--detuning", o.detuning,
                      "also drive the cavity by the input beam at these detunings from resonance, in free spectral "
                      "ranges or with a unit of frequency: -0.5..0.5:1001, -200Hz..200Hz:401 or 0");
  mark_output(*command,
              *command->add_option("--csv", o.csv,
                                   "file for the table of photodiodes, or with --detuning of detunings, all digits"));
  command->add_option("--threads", o.threads, "0: all cores")->check(whole_between(0, 4096, "8"));
  command->add_option("--backend", o.backend,
                      "cpu; cuda: fields on a GPU, which agree to rounding; with --seam, histories");
  auto* const out = command->add_option(
      "-o,--out", o.out, "run file to write (HDF5), without histories: run and trace resume it with this field");
  command->add_flag("--fields", o.fields, "keep the complex fields on both mirrors in the run file")->needs(out);
  mark_output(*command,
              *command->add_option("--plot", o.plot,
                                   "picture of the field on mirrors and a baffle (png, pdf or svg), or of the scan "
                                   "of detuning (png)"));
  add_force_option(*command, o.force);
  for (char const* const of_field : {"--show", "--order", "--grid-check", "--by-frequency", "--detuning", "--csv",
                                     "--out", "--fields", "--plot", "--force"})
    seam->excludes(command->get_option(of_field));
  command->footer(
      "Examples:\n"
      "  straytrace wave examples/et_hf_wave.yaml\n"
      "  straytrace wave examples/et_hf_wave.yaml -o field.h5 --plot field.png\n"
      "  straytrace wave examples/et_hf_wave.yaml --grid-check\n"
      "  straytrace wave examples/et_hf_wave.yaml --seam --histories 1e6\n"
      "  straytrace wave examples/et_hf_wave.yaml --detuning -0.5..0.5:1001 --plot detuning.png\n"
      "  straytrace wave examples/et_hf_wave.yaml --by-frequency --format json");
  command->callback([options, &exit_code] { exit_code = wave(*options); });
}

}  // namespace straytrace::cli
