// SPDX-License-Identifier: BSD-3-Clause
// straytrace paths: the ranked table of routes of a run, by port or by receiver.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "results/receivers/receivers.hpp"
#include "results/route_table/route_choice.hpp"
#include "session/light/first_order.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct PathsOptions : FirstOrderOptions {
  bool first_order = false, census = false;
  PathsChoice choice;
  std::string band;  // of shares and ranks: "10 Hz..100 Hz"; empty: all frequencies
  bool any() const { return choice.any() || !band.empty(); }
};

void print_receivers(PathsOptions const& options, RunContent const& content, std::size_t show) {
  ReceiverTable const table = receiver_table(content);
  if (options.by == "source" && !options.json())
    std::cout << (options.csv ? source_csv(table) : source_text(table));
  else if (options.json())
    std::cout << receiver_json(table, content);
  else if (options.csv)
    std::cout << (options.census ? census_csv(table, content) : receiver_csv(table, content));
  else
    std::cout << (options.census ? census_text(table, show) : receiver_text(table, show)) << '\n';
}

void print_ports(PathsOptions const& options, RunContent const& content, PathTable const& table, std::size_t show) {
  PathsChoice const& choice = options.choice;
  ChosenPaths const chosen = choose_paths(choice, table, content.trace->coupling, content.noise);
  std::string const said = choice_text(choice, chosen);
  if (options.json()) {
    std::string const json = path_json(chosen.shown, content);
    std::cout << (options.any() ? with_choice(json, choice, chosen) : json) << '\n';
  } else if (options.csv) {
    for (std::size_t at = 0; at < said.size(); at = said.find('\n', at) + 1)
      std::cout << "# " << said.substr(at, said.find('\n', at) + 1 - at);
    std::cout << path_csv(chosen.shown, content);
  } else if (!options.any()) {
    std::cout << path_text(table, show) << '\n';
  } else {
    std::cout << said << (said.empty() ? "" : "\n") << path_text(chosen.shown, show, chosen.all) << '\n';
  }
}

void print_port_census(PathsOptions const& options, RunContent const& content, PathTable const& table,
                       std::size_t show) {
  if (options.json())
    std::cout << port_census_json(table, content);
  else
    std::cout << (options.csv ? port_census_csv(table, content) : port_census_text(table, show) + "\n");
}

// Of a run; `grid` is that of its noise.
TableSettings table_settings(std::string const& band_text, FrequencyGrid const& grid) {
  TableSettings settings;
  if (band_text.empty()) return settings;
  FrequencyBand const band = option_band(band_text, "--band");
  if (double const low = grid.edges.front(), high = grid.edges.back(); band.low >= high || band.high <= low)
    throw InputError(
        fmt::format("--band: the noise of the run covers {:g} to {:g} Hz, nothing of '{}'", low, high, band_text),
        fmt::format("choose a band within it, for example --band \"{:g} Hz..{:g} Hz\"", low, high));
  settings.low = band.low;
  settings.high = band.high;
  std::erase_if(settings.frequencies, [&](double f) { return f < band.low || f > band.high; });
  if (settings.frequencies.empty()) settings.frequencies = {std::sqrt(band.low * band.high)};
  return settings;
}

void refuse_options_of_first_order(PathsOptions const& options) {
  if (options.first_order) return;
  if (options.histories)
    throw InputError("--histories: the histories of a run are fixed", "remove it, or add --first-order");
  if (!options.overrides.empty())
    throw InputError("the parameters of a run are fixed", "remove -p, or add --first-order");
}

int paths(PathsOptions const& options) {
  refuse_two_formats(options.csv, options);
  refuse_options_of_first_order(options);
  if ((options.any() && (options.first_order || options.by == "receiver" || options.by == "source")) ||
      (options.census && options.choice.any()))
    throw InputError("--where, --without, --sort and --band apply to routes to ports, --band also to their census",
                     "remove --by, --census and --first-order, or these");
  if (options.first_order) return print_first_order(options);
  OpenRun const run(options.input);
  RunFile const& file = run.file;
  ProjectionModel const& model = run.model;
  RunContent const content = file.content();
  std::size_t const show = options.show ? options.show : model.paths_shown;
  bool const without_ports = file.trace.coupling.ports.empty() && options.by.empty();
  if (options.by == "receiver" || options.by == "source" || without_ports) {
    if (options.any())
      throw InputError("this run has no ports, but --where, --without, --sort and --band apply to routes to ports",
                       "remove them");
    print_receivers(options, content, show);
    return done;
  }
  NoiseBudget const* const budget = file.noise ? &*file.noise : nullptr;
  if (!options.band.empty() && !budget)
    throw InputError("--band: this run has no noise", "remove it, or compute the noise: straytrace noise");
  TableSettings const settings = budget ? table_settings(options.band, budget->grid) : TableSettings{};
  PathTable const table = path_table(file.trace.coupling, budget, budget ? &model.motion : nullptr, settings);
  options.census ? print_port_census(options, content, table, show) : print_ports(options, content, table, show);
  return done;
}

}  // namespace

void add_paths(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<PathsOptions>();
  PathsOptions& o = *options;
  auto* const command =
      app.add_subcommand("paths", "Rank the routes of light that rejoins the mode or reaches receivers.");
  command->add_option("run", o.input, "run file (HDF5); with --first-order also a scene")->required();
  command->add_option("--by", o.by, "port or receiver; source: surfaces that illuminate each receiver")
      ->check(CLI::IsMember({"port", "receiver", "source"}));
  command->add_option("--where", o.choice.where, "only routes that satisfy this: 'via(\"baffle*\") and scatters == 2'");
  command->add_option("--band", o.band, "band of shares and ranks: \"10 Hz..100 Hz\"; default: all frequencies");
  command->add_option("--sort", o.choice.sort, "sort by this column of --where, largest first: opl, 'h(30 Hz)'");
  command->add_option("--without", o.choice.without, "sum the noise without routes that pass this object, * for any")
      ->allow_extra_args(false);
  command->add_option("--show", o.show, "rows")->check(whole_between(1, 1e6, "20"));
  command->add_flag("--census", o.census,
                    "objects met by the light that rejoins the mode, by noise; with --by receiver, or without ports, "
                    "by the light of each receiver, by watts");
  command->add_flag("--first-order", o.first_order,
                    "illuminated objects, critical objects, and both; of a scene or a run");
  command
      ->add_option_function<double>(
          "--histories", [options](double n) { options->histories = std::uint64_t(n); },
          "histories of --first-order, forward and backward from each end; default 131072")
      ->check(number_between(1.0, 1e12, "1e6"));
  add_overrides(*command, o.overrides, "with --first-order: set a parameter, for example -p rim=48cm");
  command->add_flag("--csv", o.csv, "all rows, all columns, all digits");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace paths out/run.h5 --show 20\n"
      "  straytrace paths out/run.h5 --where 'via(\"baffle*\") and h(30 Hz) > 1e-25' --sort opl\n"
      "  straytrace paths out/run.h5 --without ETM\n"
      "  straytrace paths out/run.h5 --by receiver\n"
      "  straytrace paths examples/virgo_arm.yaml --first-order\n"
      "  straytrace paths out/run.h5 --census --band \"10 Hz..100 Hz\"\n"
      "  straytrace paths out/run.h5 --by receiver --census --csv > census.csv");
  command->callback([options, &exit_code] { exit_code = paths(*options); });
}

}  // namespace straytrace::cli
