// SPDX-License-Identifier: BSD-3-Clause
// straytrace paths: the ranked table of routes of a run, by port or by receiver.
#include <CLI/CLI.hpp>

#include <iostream>

#include "app/common_options.hpp"
#include "app/first_order.hpp"
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

int paths(Options const& options) {
  refuse_two_formats(options);
  if (options.first_order) return print_first_order(options);
  RunFile const file = read_run(options.input);
  Model const model = read_model(file.about.main_file, file.about.overrides, &file.about.files);
  RunContent const content = file.content();
  std::size_t const show = options.show ? options.show : model.paths_shown;
  bool const without_ports = file.trace.coupling.ports.empty() && options.by.empty();
  if (options.census || options.by == "receiver" || options.by == "source" || without_ports) {
    print_receivers(options, content, show);
    return done;
  }
  NoiseBudget const* const budget = file.noise ? &*file.noise : nullptr;
  PathTable const table = table_for(file.trace.coupling, budget, model);
  if (options.csv)
    std::cout << path_csv(table, content);
  else if (options.json())
    std::cout << path_json(table, content) << '\n';
  else
    std::cout << path_text(table, show) << '\n';
  return done;
}

}  // namespace

void add_paths(CLI::App& app, Options& options, int& exit_code) {
  auto* const command =
      app.add_subcommand("paths", "ranked table of the routes by which light rejoins the mode or reaches receivers");
  command->add_option("run", options.input, "run file (HDF5); with --first-order also a scene")->required();
  command->add_option("--by", options.by, "port or receiver; source: what lights which receiver")
      ->check(CLI::IsMember({"port", "receiver", "source"}));
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
      "  straytrace paths out/run.h5 --by receiver\n"
      "  straytrace paths examples/virgo_arm.yaml --first-order\n"
      "  straytrace paths out/run.h5 --census --csv > census.csv");
  command->callback([&] { exit_code = paths(options); });
}

}  // namespace straytrace
