// SPDX-License-Identifier: BSD-3-Clause
// straytrace paths: the ranked table of routes of a run, by port or by receiver.
#include "cli/results/paths.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numeric>
#include <set>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/options.hpp"
#include "results/receivers/receivers.hpp"
#include "results/route_table/route_filter.hpp"
#include "results/text/table.hpp"
#include "session/light/first_order.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct PathsOptions : FirstOrderOptions {
  bool first_order = false, census = false;
  PathsChoice choice;
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

int paths(PathsOptions const& options) {
  PathsChoice const& choice = options.choice;
  refuse_two_formats(options.csv, options);
  if (choice.any() && (options.first_order || options.census || options.by == "receiver" || options.by == "source"))
    throw InputError("--where, --without, --sort and --band apply to routes to ports",
                     "remove --by, --census and --first-order, or these");
  if (options.first_order) return print_first_order(options);
  OpenRun const run(options.input);
  RunFile const& file = run.file;
  ProjectionModel const& model = run.model;
  RunContent const content = file.content();
  std::size_t const show = options.show ? options.show : model.paths_shown;
  bool const without_ports = file.trace.coupling.ports.empty() && options.by.empty();
  if (options.census || options.by == "receiver" || options.by == "source" || without_ports) {
    if (choice.any())
      throw InputError("this run has no ports, but --where, --without, --sort and --band apply to routes to ports",
                       "remove them");
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
  print_ports(options, content, path_table(file.trace.coupling, budget, budget ? &model.motion : nullptr, settings),
              show);
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
  command->add_option("--band", o.choice.band, "band of shares and ranks: \"10 Hz..100 Hz\"; default: all frequencies");
  command->add_option("--sort", o.choice.sort, "sort by this column of --where, largest first: opl, 'h(30 Hz)'");
  command->add_option("--without", o.choice.without, "sum the noise without routes that pass this object, * for any")
      ->allow_extra_args(false);
  command->add_option("--show", o.show, "rows")->check(whole_between(1, 1e6, "20"));
  command->add_flag("--census", o.census, "objects met by the light of each receiver, by watts");
  command->add_flag("--first-order", o.first_order,
                    "illuminated objects, critical objects, and both; of a scene or a run");
  command
      ->add_option_function<double>(
          "--histories", [options](double n) { options->histories = std::uint64_t(n); },
          "histories of --first-order, forward and backward from each end; default 131072")
      ->check(CLI::Range(1.0, 1e12));
  command->add_option("-p,--param", o.overrides, "set a parameter of the scene, for example -p rim=48cm")
      ->allow_extra_args(false);
  command->add_flag("--csv", o.csv, "all rows, all columns, all digits");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace paths out/run.h5 --show 20\n"
      "  straytrace paths out/run.h5 --where 'via(\"baffle*\") and h(30 Hz) > 1e-25' --sort opl\n"
      "  straytrace paths out/run.h5 --without ETM\n"
      "  straytrace paths out/run.h5 --by receiver\n"
      "  straytrace paths examples/virgo_arm.yaml --first-order\n"
      "  straytrace paths out/run.h5 --census --csv > census.csv");
  command->callback([options, &exit_code] { exit_code = paths(*options); });
}

namespace {

// Rows of routes that pass an object; a pattern without a match is a problem, since it would remove nothing.
std::vector<std::size_t> passing(std::vector<std::string> const& patterns, PathTable const& table,
                                 std::vector<InputError>& errors) {
  std::set<std::size_t> rows;
  std::set<std::string> names;
  for (std::string const& pattern : patterns) {
    bool found = false;
    for (std::size_t i = 0; i < table.rows.size(); ++i)
      for (std::string const& object : objects_of(table.rows[i].sequence)) {
        names.insert(object);
        if (!matches(pattern, object)) continue;
        rows.insert(i);
        found = true;
      }
    if (found) continue;
    std::vector<std::string> const all(names.begin(), names.end());
    std::string const near = nearest_word(pattern, all);
    errors.emplace_back(fmt::format("--without: no route passes '{}'", pattern),
                        near.empty() ? "objects of routes are " + fmt::format("{}", fmt::join(all, ", "))
                                     : "did you mean '" + near + "'?");
  }
  return {rows.begin(), rows.end()};
}

void collect(std::string const& option, std::string const& text, FilterAnswer const& answer,
             std::vector<InputError>& errors) {
  for (FilterProblem const& p : answer.problems) errors.push_back(error_in_filter(option, text, p));
}

nlohmann::ordered_json json_of(WithError const& x) {
  return std::isnan(x.value) ? nlohmann::ordered_json() : error_json(x);
}

std::string number_of(WithError const& x) { return std::isnan(x.value) ? "unresolved" : with_brackets(x); }

std::string without_text(PathsChoice const& choice, ChosenPaths const& chosen) {
  std::string text = fmt::format("Without {} ({} route{} left out):\n", fmt::join(choice.without, " and "),
                                 chosen.left_out, chosen.left_out == 1 ? "" : "s");
  for (StrainWithout const& s : chosen.strain) {
    text += fmt::format("  h({:g} Hz) ", s.hz);
    text += std::isnan(s.after.value) ? "not resolved: no remaining resolved route causes noise there"
                                      : fmt::format("{}, factor {}", number_of(s.after), number_of(s.factor));
    text += fmt::format("; before {} 1/sqrt(Hz)\n", number_of(s.before));
  }
  if (chosen.strain.empty())
    text += fmt::format("  sum of couplings {}, before {}\n", number_of(chosen.all.total_coupling),
                        number_of(chosen.coupling_before));
  bool const others =
      std::any_of(chosen.all.rows.begin(), chosen.all.rows.end(), [](PathRow const& row) { return row.vertices == 0; });
  if (others) text += "  Rows 'other' stay in the sums: some of their routes may pass there as well.\n";
  if (chosen.all.missing() > 0)
    text += fmt::format("  {}: the sums contain the observed part of unresolved routes, with an equal error\n",
                        bound_text(chosen.all.has_upper_bounds(), chosen.all.missing()));
  return text + "  The further path of their light is not traced: for that remove the object from the scene.\n";
}

}  // namespace

ChosenPaths choose_paths(PathsChoice const& choice, PathTable const& table, CouplingTable const& coupling,
                         NoiseBudget const* budget) {
  std::vector<InputError> errors;
  ChosenPaths chosen{table, {}, {}, 0, table.total_coupling, {}};
  std::vector<std::size_t> const out = passing(choice.without, table, errors);
  if (!out.empty()) {
    Without without = without_rows(table, out, coupling, budget);
    chosen.all = std::move(without.rest);
    chosen.strain = std::move(without.strain);
    chosen.left_out = out.size();
  }
  RouteColumns columns(chosen.all, budget);
  FilterAnswer answer = filtered(choice.where, columns);
  collect("--where", choice.where, answer, errors);
  chosen.notes = answer.notes;
  if (!choice.sort.empty()) {
    answer = sorted_by(choice.sort, answer.rows, columns);
    collect("--sort", choice.sort, answer, errors);
  }
  throw_all(errors);
  chosen.shown = part_of(chosen.all, answer.rows);
  return chosen;
}

std::string choice_text(PathsChoice const& choice, ChosenPaths const& chosen) {
  std::string text = choice.without.empty() ? "" : without_text(choice, chosen);
  if (!choice.where.empty())
    text += fmt::format("{} of {} routes: {}\n", chosen.shown.rows.size(), chosen.all.rows.size(), choice.where);
  if (!choice.sort.empty()) text += "Sorted by " + choice.sort + "\n";
  for (std::string const& note : chosen.notes) text += "note: " + note + "\n";
  return text;
}

std::string with_choice(std::string const& json, PathsChoice const& choice, ChosenPaths const& chosen) {
  auto j = nlohmann::ordered_json::parse(json);
  if (!choice.where.empty()) j["where"] = choice.where;
  if (!choice.sort.empty()) j["sort"] = choice.sort;
  j["notes"] = chosen.notes;
  if (!choice.without.empty()) {
    auto strain = nlohmann::ordered_json::array();
    for (StrainWithout const& s : chosen.strain)
      strain.push_back({{"frequency_Hz", s.hz},
                        {"before", json_of(s.before)},
                        {"after", json_of(s.after)},
                        {"factor", json_of(s.factor)}});
    j["without"] = {{"objects", choice.without}, {"routes", chosen.left_out}, {"strain", strain}};
  }
  return j.dump(2) + "\n";
}

}  // namespace straytrace::cli
