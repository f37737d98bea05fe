// SPDX-License-Identifier: BSD-3-Clause
// straytrace paths: the ranked table of routes of a run, by port or by receiver.
#include <CLI/CLI.hpp>

#include <cmath>
#include <iostream>
#include <memory>

#include "app/common_options.hpp"
#include "app/data_options.hpp"
#include "app/first_order.hpp"
#include "app/open_run.hpp"
#include "app/paths_choice.hpp"
#include "app/session.hpp"
#include "report/receivers.hpp"

namespace straytrace {
namespace {

void print_receivers(Options const& options, RunContent const& content, std::size_t show) {
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

void print_ports(Options const& options, PathsChoice const& choice, RunContent const& content, PathTable const& table,
                 std::size_t show) {
  ChosenPaths const chosen = choose_paths(choice, table, content.trace->coupling, content.noise);
  std::string const said = choice_text(choice, chosen);
  if (options.json()) {
    std::string const json = path_json(chosen.shown, content);
    std::cout << (choice.any() ? with_choice(json, choice, chosen) : json) << '\n';
  } else if (options.csv) {
    for (std::size_t at = 0; at < said.size(); at = said.find('\n', at) + 1)
      std::cout << "# " << said.substr(at, said.find('\n', at) + 1 - at);
    std::cout << path_csv(chosen.shown, content);
  } else if (!choice.any()) {
    std::cout << path_text(table, show) << '\n';
  } else {
    std::cout << said << (said.empty() ? "" : "\n") << path_text(chosen.shown, show, chosen.all) << '\n';
  }
}

int paths(Options const& options, PathsChoice const& choice) {
  refuse_two_formats(options);
  if (choice.any() && (options.first_order || options.census || options.by == "receiver" || options.by == "source"))
    throw InputError(
        "error: --where, --without, --sort and --band are about routes to ports\n  leave out --by, --census and "
        "--first-order, or leave these out");
  if (options.first_order) return print_first_order(options);
  OpenRun const run(options.input);
  RunFile const& file = run.file;
  Model const& model = run.model;
  RunContent const content = file.content();
  std::size_t const show = options.show ? options.show : model.paths_shown;
  bool const without_ports = file.trace.coupling.ports.empty() && options.by.empty();
  if (options.census || options.by == "receiver" || options.by == "source" || without_ports) {
    if (choice.any())
      throw InputError(
          "error: this run has no ports, and --where, --without, --sort and --band are about routes to ports\n  leave "
          "them out");
    print_receivers(options, content, show);
    return done;
  }
  NoiseBudget const* const budget = file.noise ? &*file.noise : nullptr;
  TableSettings settings;
  if (!choice.band.empty()) {
    FrequencyBand const band = option_band(choice.band, "--band");
    settings.low = band.low;
    settings.high = band.high;
    std::erase_if(settings.frequencies, [&](double f) { return f < band.low || f > band.high; });
    if (settings.frequencies.empty()) settings.frequencies = {std::sqrt(band.low * band.high)};
  }
  print_ports(options, choice, content,
              path_table(file.trace.coupling, budget, budget ? &model.motion : nullptr, settings), show);
  return done;
}

}  // namespace

void add_paths(CLI::App& app, Options& options, int& exit_code) {
  auto* const command =
      app.add_subcommand("paths", "ranked table of the routes by which light rejoins the mode or reaches receivers");
  command->add_option("run", options.input, "run file (HDF5); with --first-order also a scene")->required();
  command->add_option("--by", options.by, "port or receiver; source: what lights which receiver")
      ->check(CLI::IsMember({"port", "receiver", "source"}));
  auto const choice = std::make_shared<PathsChoice>();
  command->add_option("--where", choice->where,
                      "only routes of which this is true: 'via(\"baffle*\") and scatters == 2'");
  command->add_option("--band", choice->band, "of shares and ranks: \"10 Hz..100 Hz\"; all frequencies unless given");
  command->add_option("--sort", choice->sort, "by this name of --where, largest first: opl, 'h(30 Hz)'");
  command
      ->add_option("--without", choice->without, "sums the noise again without routes that pass this object, * for any")
      ->allow_extra_args(false);
  command->add_option("--show", options.show, "rows")->check(whole_between(1, 1e6, "20"));
  command->add_flag("--census", options.census, "objects that the light of each receiver has met, by watts");
  command->add_flag("--first-order", options.first_order, "what is lit, what is seen, and both; of a scene or a run");
  command
      ->add_option_function<double>(
          "--histories", [&](double n) { options.histories = std::uint64_t(n); },
          "of --first-order, forward and backward from each end; 131072 unless given")
      ->check(CLI::Range(1.0, 1e12));
  command->add_option("-p,--param", options.overrides, "set a parameter of the scene, for example -p rim=48cm")
      ->allow_extra_args(false);
  command->add_flag("--csv", options.csv, "all rows, all columns, all digits");
  add_format_option(*command, options);
  command->footer(
      "Examples:\n"
      "  straytrace paths out/run.h5 --show 20\n"
      "  straytrace paths out/run.h5 --where 'via(\"baffle*\") and h(30 Hz) > 1e-25' --sort opl\n"
      "  straytrace paths out/run.h5 --without ETM\n"
      "  straytrace paths out/run.h5 --by receiver\n"
      "  straytrace paths examples/virgo_arm.yaml --first-order\n"
      "  straytrace paths out/run.h5 --census --csv > census.csv");
  command->callback([&, choice] { exit_code = paths(options, *choice); });
}

}  // namespace straytrace
