// SPDX-License-Identifier: BSD-3-Clause
// straytrace ifo: the network of an interferometer: powers, scans, error signals, responses.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "cli/commands.hpp"
#include "cli/ifo/ifo_sheets.hpp"
#include "cli/options.hpp"
#include "ifo/dual_recycled.hpp"
#include "results/curves/curve_file.hpp"
#include "results/text/picture.hpp"
#include "session/light/optical_network.hpp"

namespace straytrace::cli {
namespace {

struct IfoOptions : SceneOptions {
  std::vector<std::string> show = {"point"};
  std::string band = "1 Hz, 10 kHz", at = "10 Hz", plot;
  std::size_t points = 201;
  bool csv = false;
};

// What follows each word of --show.
struct Request {
  char const* what;
  std::vector<char const*> words;
};
std::array<Request, 7> const& requests() {
  static std::array<Request, 7> const all = {{{"point", {}},
                                              {"scan", {"PARAMETER", "FROM", "TO"}},
                                              {"errors", {}},
                                              {"transfer", {"FROM", "TO"}},
                                              {"sensing", {}},
                                              {"loops", {}},
                                              {"network", {}}}};
  return all;
}

Request const& request_of(IfoOptions const& options) {
  std::vector<std::string> names;
  for (Request const& r : requests()) {
    names.emplace_back(r.what);
    if (r.what != options.show.front()) continue;
    if (options.show.size() == r.words.size() + 1) return r;
    throw InputError(fmt::format("--show {} takes {} words, got {}", r.what, r.words.size(), options.show.size() - 1),
                     fmt::format("write --show {} {}", r.what, fmt::join(r.words, " ")));
  }
  throw InputError(fmt::format("--show cannot be '{}'", options.show.front()),
                   did_you_mean(options.show.front(), names, fmt::format("write one of: {}", fmt::join(names, ", "))));
}

InputError unknown(char const* what, std::string const& name, std::vector<std::string> const& known) {
  return InputError(fmt::format("the network has no {} '{}'", what, name),
                    did_you_mean(name, known, fmt::format("it is one of: {}", fmt::join(known, ", "))));
}

// "-1 nm" as a value of the parameter, in SI.
double value_of_parameter(NetworkParameter const& p, std::string const& text) {
  auto const number = leading_number(text);
  auto const unit = number ? parse_unit(number->rest) : std::nullopt;
  bool const plain = number && number->rest.empty();
  std::string const example = fmt::format("write for example {}", with_unit("0.1", p.dimension));
  if (!number || (plain ? !(p.dimension == dim::plain || number->value == 0) : !unit || unit->dimension != p.dimension))
    throw InputError(fmt::format("'{}' is not a value of '{}', which is {}", text, p.name, described(p.dimension)),
                     example);
  double const value = plain ? number->value : to_si(number->value, *unit);
  if (!(value >= p.low && value <= p.high))
    throw InputError(fmt::format("'{}' is outside the range of '{}'", text, p.name),
                     fmt::format("stay between {:g} and {:g} {}", p.low, p.high, example_unit(p.dimension)));
  return value;
}

NetworkScan scanned(NetworkModel const& model, IfoOptions const& options) {
  if (model.readouts.empty())
    throw InputError("the network has no read-outs to scan",
                     "add for example 'readouts: {out: {power: ETM.back.out}}'");
  auto const parameter = find_parameter(model, options.show[1]);
  if (!parameter) throw unknown("parameter", options.show[1], parameter_names(model));
  double const from = value_of_parameter(*parameter, options.show[2]),
               to = value_of_parameter(*parameter, options.show[3]);
  return scan_network(model, *parameter, from, to, options.points);
}

std::vector<double> frequencies(IfoOptions const& options) {
  std::vector<double> const ends = parse_band(options.band);
  std::vector<double> hz;
  for (std::size_t i = 0; i < options.points; ++i)
    hz.push_back(ends[0] * std::pow(ends[1] / ends[0], double(i) / double(options.points - 1)));
  return hz;
}

Sheet transferred(NetworkModel const& model, IfoOptions const& options) {
  auto const cause = find_cause(model, options.show[1]);
  if (!cause) throw unknown("cause", options.show[1], cause_names(model));
  auto const effect = find_effect(model, options.show[2]);
  if (!effect) throw unknown("read-out or mirror", options.show[2], effect_names(model));
  std::vector<double> const hz = frequencies(options);
  return transfer_sheet(*cause, *effect, hz, transfer_function(model, *cause, *effect, hz));
}

std::vector<Sheet> loops_of(Interferometer const* detector, IfoOptions const& options) {
  RecycledInterferometer const* const recycled = detector ? detector->recycled() : nullptr;
  if (!recycled)
    throw InputError("only a dual-recycled detector has loops", "write --show loops with a scene of such a preset");
  std::vector<double> const ends = parse_band(options.band);
  std::vector<Sheet> all;
  for (double const hz : parse_frequencies(options.at, "--at")) {
    std::vector<Sheet> const sheets = loop_sheets(recycled->loop_table(hz, {ends[0], ends[1]}));
    all.insert(all.end(), sheets.begin(), sheets.end());
  }
  return all;
}

std::vector<Sheet> sheets_of(OpticalNetwork const& network, IfoOptions const& options) {
  NetworkModel const& model = network.model;
  std::string const& what = options.show.front();
  if (what == "loops") return loops_of(network.detector.get(), options);
  if (what == "scan") return {scan_sheet(model, scanned(model, options))};
  if (what == "errors") return {errors_sheet(error_signals(model))};
  if (what == "transfer") return {transferred(model, options)};
  if (what == "point") return point_sheets(operating_point(model));
  std::vector<Sheet> all;
  for (double const hz : parse_frequencies(options.at, "--at")) all.push_back(sensing_sheet(sensing_matrix(model, hz)));
  return all;
}

void check(IfoOptions const& options) {
  refuse_two_formats(options.csv, options);
  std::string const what = request_of(options).what;
  bool const curve = what == "scan" || what == "transfer";
  if (!options.plot.empty() && !curve)
    throw InputError("--plot draws a scan or a response", "remove it, or write --show scan PARAMETER FROM TO");
  if (!options.plot.empty()) check_ending(options.plot, {".png"}, "--plot");
  if (what == "network" && (options.csv || options.json()))
    throw InputError("--show network prints a scene", "remove --csv and --format json");
}

void draw(std::vector<Sheet> const& sheets, IfoOptions const& options) {
  std::string message;
  nlohmann::ordered_json json = json_of(sheets);
  json["show"] = options.show;
  std::string const picture = picture_of(json.dump(), "ifo", message);
  if (picture.empty()) throw InputError(message, "or remove --plot");
  write_file(options.plot, picture);
}

int ifo(IfoOptions const& options) {
  check(options);
  OpticalNetwork const network = read_optical_network(options);
  if (options.show.front() == "network") {
    std::cout << network_text(network.model);
    return done;
  }
  std::vector<Sheet> const sheets = sheets_of(network, options);
  if (!options.plot.empty()) draw(sheets, options);
  if (options.json())
    std::cout << json_of(sheets).dump() << '\n';
  else
    std::cout << (options.csv ? csv_of(sheets) : text_of(sheets));
  return done;
}

}  // namespace

void add_ifo(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<IfoOptions>();
  IfoOptions& o = *options;
  auto* const command = app.add_subcommand(
      "ifo", "Solve the network of an interferometer: powers, resonators, error signals, responses.");
  add_scene_options(*command, o);
  command
      ->add_option(
          "--show", o.show,
          "point (default), scan PARAMETER FROM TO, errors, transfer FROM TO, sensing, loops, or network: the scene of "
          "the network")
      ->expected(1, 4)
      ->allow_extra_args(false);
  command->add_option("--points", o.points, "of a scan or a response; default 201")
      ->check(whole_between(2, 100000, "201"));
  command->add_option("--band", o.band, "of a response or the margins of loops; default \"1 Hz, 10 kHz\"");
  command->add_option("--at", o.at, "frequencies of the sensing matrix or the loops; default \"10 Hz\"");
  command->add_flag("--csv", o.csv, "all digits, SI");
  mark_output(*command, *command->add_option("--plot", o.plot, "picture of a scan or a response (PNG)"));
  command->footer(
      "Examples:\n"
      "  straytrace ifo examples/ifo_cavity.yaml\n"
      "  straytrace ifo examples/ifo_cavity.yaml --show scan LENGTH -5nm 5nm --plot pdh.png");
  command->callback([options, &exit_code] { exit_code = ifo(*options); });
}

}  // namespace straytrace::cli
