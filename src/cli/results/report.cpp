// SPDX-License-Identifier: BSD-3-Clause
// straytrace report: a run as one HTML file, or several side by side. straytrace view: a scene, or a run, in three
// dimensions.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "base/files/read_write.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "io/observatory_data.hpp"
#include "report/exports.hpp"
#include "report/scene_drawing.hpp"
#include "results/curves/curve_file.hpp"
#include "results/text/picture.hpp"
#include "session/compare/run_diff.hpp"
#include "session/interrupt.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/live/live_run.hpp"
#include "session/open_run.hpp"
#include "session/records/route_predictions.hpp"
#include "session/report_page.hpp"
#include "session/session.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/welch.hpp"
#include "trace/importance/importance.hpp"

namespace straytrace::cli {
namespace {

// Steers a world the first time it is requested.
class Steered {
 public:
  explicit Steered(Model& model) : model_(model) {}
  SteeredWorld const& world() {
    if (!world_) world_ = steer(model_.world);
    return *world_;
  }
  TracedAgain traced() {
    return [this]() -> SteeredWorld const& { return world(); };
  }

 private:
  Model& model_;
  std::optional<SteeredWorld> world_;
};

Model model_as_traced(RunFile const& file, PrintOptions const& print) {
  Model model = model_of(file);
  model.world.block_size = file.trace.coupling.block_size;
  model.waves = file.about.waves;
  light_halo(model, true, 0, print);
  return model;
}

// A run whose histories can be traced again.
struct Opened {
  RunFile file;
  Model model;
  Steered steered;
  RunContent content;
  PathTable table;
  Opened(std::string const& name, PrintOptions const& print)
      : file(read_run_file(name)), model(model_as_traced(file, print)), steered(model) {
    content = file.content();
    table = table_for(file.trace.coupling, content.noise, model);
  }
};

std::string beside(std::string const& input, std::string const& name) {
  return (std::filesystem::path(input).parent_path() / name).string();
}

// Curves and tables as CSV into a folder.
void write_curves(std::string const& name, RunContent const& content, PathTable const& table) {
  NamedTexts const names = curve_files(content, table);
  OutputFolder const folder(name);
  NamedTexts files;
  for (auto const& [file, text] : names) files.emplace_back(folder.path(file), text);
  write_files(files);
}

// report.pdf and similar: only the picture.
bool is_picture(std::string const& file) {
  return file.ends_with(".pdf") || file.ends_with(".png") || file.ends_with(".svg");
}

struct ReportOptions : PrintOptions {
  DataOptions data;
  std::vector<std::string> measured;
  ReportWanted wanted;
  std::vector<std::string> inputs;
  std::string out, csv;
  CLI::App const* command = nullptr;
};

// FILE of columns frequency and ASD; FILE::CHANNEL, frames and HDF5 are records of strain.
MeasuredStrain measured_strain(DataOptions const& o, std::string const& argument, FrequencyBand band) {
  bool const record =
      argument.find("::") != argument.npos || is_observatory_data(argument) || head_of_file(argument, 4) == "\x89HDF";
  if (!record) {
    MeasuredStrain m = parse_measured(read_text(argument), argument, band.low, band.high);
    m.name = std::filesystem::path(argument).filename().string();
    return m;
  }
  TimeSeries const s = averaged_records(o, {{argument, o.unit}}, o.gps.empty() ? GpsSpan{} : parse_gps(o.gps), true)[0];
  if (!(parse_unit(s.unit)->dimension == dim::plain))
    throw InputError(fmt::format("--measured {}: it is in {}, not strain", argument, s.unit),
                     "name a channel of h(t), or give the factor: --unit \"2.5e-4 1\" for metres of DARM over 4 km");
  WelchSettings const settings = welch_of(o, s);
  WelchSpectrum const spectrum = welch(s.samples, s.rate, settings);
  MeasuredStrain m = measured_from(spectrum, settings, band.low, band.high);
  m.name = s.name;
  m.source = fmt::format("{}; {}; {}", argument, source_note(s), welch_note(settings, s.rate, spectrum));
  if (!o.segments.empty()) m.source += "; " + active_note(o, s);
  return m;
}

// JSON for page and picture; empty without any.
std::string measured_curves(ReportOptions const& o, RunContent const& run) {
  if (o.measured.empty()) return {};
  if (!run.noise) throw InputError("--measured: this run has no noise to compare with", "run straytrace noise first");
  FrequencyBand const band{run.noise->grid.edges.front(), run.noise->grid.edges.back()};
  std::vector<MeasuredStrain> all;
  std::vector<InputError> errors;
  for (std::string const& argument : o.measured) try {
      all.push_back(measured_strain(o.data, argument, band));
      if (all.back().hz.empty())
        throw InputError(fmt::format("--measured {}: it has no frequency in {:g} to {:g} Hz, the band of the run",
                                     argument, band.low, band.high),
                         "give another file, or a longer --segment");
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  throw_all(errors);
  return measured_json(all);
}

// Options for records of strain.
constexpr char const* of_records[] = {"--unit",    "--gps",    "--segments", "--segment",
                                      "--overlap", "--window", "--average",  "--detrend"};

int report_several(ReportOptions const& options) {
  std::vector<std::string> of_one{"--paths", "--show", "--pictures", "--csv", "--measured"};
  for (char const* name : of_records) of_one.emplace_back(name);
  std::erase_if(of_one, [&](std::string const& name) { return options.command->count(name) == 0; });
  if (!of_one.empty())
    throw InputError(fmt::format("the report of several runs does not have {}", fmt::join(of_one, ", ")),
                     fmt::format("remove {}, or give one run", of_one.size() > 1 ? "them" : "it"));
  if (!options.out.empty()) check_ending(options.out, {".html"}, "-o");
  std::string const out = options.out.empty() ? beside(options.inputs.front(), "comparison.html") : options.out;
  write_file(out, comparison_page(read_compared(options.inputs), run_labels(options.inputs), options.wanted.title));
  if (!options.quiet) std::cerr << fmt::format("report: {}\n", out);
  return done;
}

// Such options without a record.
void refuse_idle(ReportOptions const& options) {
  if (!options.measured.empty()) return;
  std::vector<std::string> idle(std::begin(of_records), std::end(of_records));
  std::erase_if(idle, [&](std::string const& name) { return options.command->count(name) == 0; });
  if (!idle.empty())
    throw InputError(fmt::format("{}: there is no measured strain", fmt::join(idle, ", ")),
                     "name a record with --measured FILE::CHANNEL");
}

int report(ReportOptions const& options) {
  if (options.inputs.size() > 1) return report_several(options);
  ReportWanted wanted = options.wanted;
  std::string const& input = options.inputs.front();
  std::vector<InputError> errors;
  collect(errors, [&] { refuse_scene(input); });
  collect(errors, [&] {
    if (!options.out.empty()) check_ending(options.out, {".html", ".pdf", ".png", ".svg"}, "-o");
  });
  collect(errors, [&] { refuse_idle(options); });
  throw_all(errors);
  std::string message;
  if (is_picture(options.out)) {
    if (!options.measured.empty()) {
      RunFile const file = read_run_file(input);
      wanted.measured = measured_curves(options, file.content());
    }
    if (!draw_picture(input, options.out, message, 0, 0, wanted.measured))
      throw InputError(message, "or write a page: -o report.html");
    if (!options.quiet) std::cerr << fmt::format("picture: {}\n", options.out);
    return done;
  }
  Opened run(input, options);
  if (wanted.pictures.empty()) wanted.pictures = read_pictures(run.model.scene.table("report"));
  if (!options.csv.empty()) write_curves(options.csv, run.content, run.table);
  wanted.measured = measured_curves(options, run.content);
  Picture const svg = wanted.has("budget") ? budget_svg(input, wanted.measured, message) : Picture{};
  if (!message.empty() && !options.quiet)
    std::cerr << "warning: without scripts the report has no picture: " << message << '\n';
  std::string const out = options.out.empty() ? beside(input, "report.html") : options.out;
  write_file(out, report_page(run.content, run.table, run.model, run.steered.traced(), wanted, svg));
  if (!options.quiet) std::cerr << fmt::format("report: {}\n", out);
  return done;
}

struct ViewOptions : SceneOptions {
  ViewWanted wanted;
  std::string out, vtk, glb;
  LiveOptions live;
};

// A page, unless only other files are requested.
void write_view(ViewOptions const& options, Model const& model, TracedAgain const& traced, RunContent const* run,
                PathTable const* table) {
  ViewWanted const& wanted = options.wanted;
  auto const tell = [&](char const* what, std::string const& file) {
    if (!options.quiet) std::cerr << fmt::format("{}: {}\n", what, file);
  };
  if (!options.vtk.empty() || !options.glb.empty()) {
    SceneDrawing const scene = scene_drawing(model.world, ~std::size_t{0});  // every triangle
    std::vector<DrawnPath> paths;
    if (run)
      paths = paths_of_rows(run->trace->coupling, *table, model.world, traced, ghosts_for_page(model, ghosts_shown),
                            wanted.rows, wanted.paths);
    if (!options.vtk.empty()) {
      OutputFolder const parts((std::filesystem::path(options.vtk) / "parts").string());
      NamedTexts files;
      for (auto& [name, text] : vtk_files(model.world, scene, paths, table))
        files.emplace_back((std::filesystem::path(options.vtk) / name).string(), std::move(text));
      write_files(files);
      tell("VTK", (std::filesystem::path(options.vtk) / "straytrace.vtm").string());
    }
    if (!options.glb.empty()) {
      write_file(options.glb, glb_bytes(scene, paths, table));
      tell("GLB", options.glb);
    }
    if (options.out.empty()) return;
  }
  std::string const out = options.out.empty() ? "view.html" : options.out;
  write_file(out, view_page(model, traced, run, table, wanted));
  tell("view", out);
}

// Whether a run holds light at small angles that falls on baffles.
bool has_halo(Model const& model) { return model.waves && model.arm && !model.arm->rims.empty(); }

// The picture of the scene as it was last saved, until a signal comes. With -o also as a file.
int follow(ViewOptions const& options) {
  if (names_run(options.input) || !options.vtk.empty() || !options.glb.empty())
    throw InputError("--live follows a scene file, and writes a page alone",
                     "give a scene file, without --vtk and --glb");
  if (!std::filesystem::exists(options.input)) read_model(options.input, options.overrides);  // throws
  InterruptGuard const guard;
  LiveView live(options.wanted.title.empty() ? options.input : options.wanted.title, options.live.port);
  LiveAddress const shown(live.address(), options.live.open);
  SceneFiles files(options.input);
  do try {
      Model model = read_model(options.input, options.overrides);
      files.follow(model.scene.files());
      if (options.wanted.halo) waves_to_show(model, false, 0, options);
      std::string page = view_page(model, Steered(model).traced(), nullptr, nullptr, options.wanted);
      if (!options.out.empty()) write_file(options.out, page);
      live.show(std::move(page), model.warnings);
    } catch (InputError const& e) {
      files.follow(e.files);
      live.show_problems(e.what());
    } catch (NumericalError const& e) {
      live.show_problems(fmt::format("error: {}", e.what()));
    }
  while (files.wait_for_change(guard));
  return done;
}

int view(ViewOptions const& options) {
  if (!options.out.empty()) check_ending(options.out, {".html"}, "-o");
  if (!options.glb.empty()) check_ending(options.glb, {".glb"}, "--glb");
  if (options.live.live) return follow(options);
  if (!names_run(options.input)) {
    Model model = read_model(options.input, options.overrides);
    print_warnings(model, options);
    if (options.wanted.halo) waves_to_show(model, false, 0, options);
    write_view(options, model, Steered(model).traced(), nullptr, nullptr);
  } else {
    if (!options.overrides.empty())
      throw InputError("the parameters of a run are fixed", "remove -p, or view the scene file");
    Opened run(options.input, options);
    ViewOptions shown = options;
    shown.wanted.halo = options.wanted.halo || has_halo(run.model);
    if (shown.wanted.halo) waves_to_show(run.model, true, 0, options);
    write_view(shown, run.model, run.steered.traced(), &run.content, &run.table);
  }
  return done;
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<ReportOptions>();
  ReportOptions& o = *options;
  auto* const command =
      app.add_subcommand("report", "Write an HTML report of a run, or of several side by side; it works offline.");
  o.command = command;
  command->add_option("run", o.inputs, "run file (HDF5); of several, each is compared with the first")->required();
  mark_output(
      *command,
      *command->add_option(
          "-o,--out", o.out,
          "HTML file; default: report.html next to the run, of several comparison.html next to the first; .pdf, "
          ".png, .svg: only the picture of the run"));
  command->add_option("--paths", o.wanted.rows, "number of rows of the path table whose paths are drawn; default 50")
      ->check(whole_between(0, 1e5, "20"));
  command->add_option("--show", o.wanted.paths, "number of paths drawn per row; default 12")
      ->check(whole_between(1, 512, "30"));
  command
      ->add_option("--pictures", o.wanted.pictures,
                   "list of budget, scene, maps, wave, ghosts, materials, convergence; default: that of 'report' in "
                   "the scene, or all")
      ->delimiter(',')
      ->check(CLI::IsMember(report_pictures()));
  command->add_option("--title", o.wanted.title, "replaces the title of the scene");
  command->add_option("--csv", o.csv, "also write budget.csv, routes.csv and paths.csv to this folder");
  command
      ->add_option(
          "--measured", o.measured,
          "measured strain over the noise: FILE of frequency and ASD, or a record FILE::CHANNEL; may be repeated")
      ->allow_extra_args(false);
  o.data.average = "median";
  add_span_options(*command, o.data);
  add_welch_options(*command, o.data);
  command->add_flag("--quiet", o.quiet, "no messages");
  command->footer(
      "Examples:\n"
      "  straytrace report out/run.h5\n"
      "  straytrace report out/run.h5 --measured examples/data/shaken.csv::H --segment \"1 s\"\n"
      "  straytrace report out/run.h5 -o arm.html --title \"Arm, first look\" --pictures budget,scene\n"
      "  straytrace report out/run.h5 -o arm.pdf\n"
      "  straytrace report before/run.h5 after/run.h5 -o compared.html");
  command->callback([options, &exit_code] { exit_code = report(*options); });
}

void add_view(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<ViewOptions>();
  ViewOptions& o = *options;
  auto* const command = app.add_subcommand(
      "view", "Show a scene in three dimensions with beams, ghosts and sample rays, and the paths of a run.");
  command->add_option("scene", o.input, "scene file (YAML), or run file (HDF5)")->required();
  add_param_option(*command, o);
  mark_output(*command,
              *command->add_option("-o,--out", o.out, "HTML file; default: view.html, or none with --vtk or --glb"));
  command->add_option("--vtk", o.vtk, "folder for straytrace.vtm, for ParaView: parts, paths, names");
  mark_output(*command, *command->add_option("--glb", o.glb, "binary glTF file, for slides: parts and paths"));
  command->add_option("--rays", o.wanted.rays, "number of sample histories; default 200")
      ->check(whole_between(0, 1e5, "500"));
  command
      ->add_option("--show", o.wanted.rows,
                   "number of rows of the path table whose paths are drawn, for a run; default 12")
      ->check(whole_between(0, 1e4, "30"));
  command->add_flag("--halo", o.wanted.halo,
                    "solve the field of the table 'wave' and show its light on baffles; a run file holds it already");
  command->add_option("--title", o.wanted.title, "replaces the title of the scene");
  command->add_flag("--quiet", o.quiet, "no messages");
  add_live_options(*command, o.live,
                   "follow the scene in a browser: serves a page on this machine that shows it anew when it is saved");
  command->footer(
      "Examples:\n"
      "  straytrace view examples/bench.yaml -o bench.html\n"
      "  straytrace view examples/bench.yaml --live\n"
      "  straytrace view out/run.h5 --show 12 -o paths.html\n"
      "  straytrace view out/run.h5 --vtk paraview/ --glb scene.glb");
  command->callback([options, &exit_code] { exit_code = view(*options); });
}

}  // namespace straytrace::cli
