// SPDX-License-Identifier: BSD-3-Clause
// straytrace ifo: the network of an interferometer: powers, scans, error signals, responses.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <vector>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/data_options.hpp"
#include "cli/ifo/ifo_sheets.hpp"
#include "cli/options.hpp"
#include "results/curves/curve_file.hpp"
#include "results/text/picture.hpp"
#include "results/text/table.hpp"
#include "session/build_info.hpp"
#include "session/light/optical_network.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {

// What the page of a network shows (straytrace.plots.ifo_page). Inside the module.

// Suppression and gain of the loops, and the noise of the strain, over a band; of a model with strain.
std::vector<Sheet> page_curves(NetworkModel const&, FrequencyBand);

// Components, spaces with their powers, and all tables that need no further words; `loops`, `curves`: empty without
// strain.
nlohmann::ordered_json page_json(OpticalNetwork const&, std::vector<double> const& at, std::vector<Sheet> const& loops,
                                 std::vector<Sheet> const& curves);

namespace {

using Json = nlohmann::ordered_json;

constexpr int points_of_page = 101;

void add_drawing(Network const& n, Json& json) {
  constexpr std::array<char const*, 8> kinds = {"mirror",   "splitter",  "laser", "dump",
                                                "isolator", "modulator", "lens",  "aperture"};
  SteadyField const field(n);
  for (Network::Component const& c : n.components()) {
    json["components"].push_back({{"name", c.name}, {"kind", kinds[std::size_t(c.kind)]}});
    if (c.kind == Network::Component::Kind::splitter)
      json["components"].back()["incidence"] = std::get<MirrorParameters>(c.stated).incidence;
  }
  auto const end = [&](std::uint32_t port) {
    Network::Component const& c = n.at(n.owner_of(port));
    return Json{c.name, port - c.first_port};
  };
  json["spaces"] = Json::array();
  for (Network::Space const& s : n.spaces())
    json["spaces"].push_back({{"from", end(s.from)},
                              {"to", end(s.to)},
                              {"from_port", n.port_name(s.from)},
                              {"to_port", n.port_name(s.to)},
                              {"length", s.length},
                              {"forward", field.power_out(s.from)},
                              {"backward", field.power_in(s.from)}});
}

}  // namespace

std::vector<Sheet> page_curves(NetworkModel const& model, FrequencyBand band) {
  std::vector<double> hz;
  for (int i = 0; i < points_of_page; ++i)
    hz.push_back(band.low * std::pow(band.high / band.low, double(i) / (points_of_page - 1)));
  std::vector<Sheet> sheets;
  if (auto const curves = loop_curves(model, hz); !curves.empty()) sheets.push_back(suppression_sheet(hz, curves));
  sheets.push_back(strain_noise_sheet(strain_noise(model, hz)));
  return sheets;
}

Json page_json(OpticalNetwork const& network, std::vector<double> const& at, std::vector<Sheet> const& loops,
               std::vector<Sheet> const& curves) {
  Json json{{"title", network.title}, {"version", build_info::version}};
  add_drawing(network.model.network, json);
  std::vector<Sheet> sheets = point_sheets(operating_point(network.model));
  sheets.push_back(errors_sheet(error_signals(network.model)));
  for (double const hz : at) sheets.push_back(sensing_sheet(sensing_matrix(network.model, hz)));
  sheets.insert(sheets.end(), loops.begin(), loops.end());
  json["sheets"] = page_of(sheets);
  json["curves"] = json_of(curves);
  for (Sheet const& s : curves) json["headings"][s.name] = s.heading;
  return json;
}

namespace {

constexpr char const *whole_band = "1 Hz, 10 kHz", *usual_frequency = "10 Hz";
constexpr std::size_t points_of_curve = 201, points_of_map = 41, most_points = 1000000;

struct IfoOptions : SceneOptions {
  std::vector<std::string> show = {"point"};
  std::string band, at, plot, referred, page;  // band, at: empty for the default
  std::size_t points = 0;                      // 0: as many as fit what is shown
  bool csv = false;
};

// What follows each word of --show.
struct Request {
  char const* what;
  std::vector<char const*> words;
  bool optional = false;  // the words may be left out
};
std::array<Request, 11> const& requests() {
  static std::array<Request, 11> const all = {{{"point", {}},
                                               {"scan", {"PARAMETER", "FROM", "TO"}},
                                               {"errors", {}},
                                               {"slopes", {"READOUT"}},
                                               {"transfer", {"FROM", "TO"}},
                                               {"sensing", {}},
                                               {"noise", {"READOUT"}},
                                               {"loops", {"CURVE"}, true},
                                               {"stray", {"ENTRANCE", "READOUT"}, true},
                                               {"modes", {}},
                                               {"network", {}}}};
  return all;
}

Request const& request_of(IfoOptions const& options) {
  std::vector<std::string> names;
  for (Request const& r : requests()) {
    names.emplace_back(r.what);
    if (r.what != options.show.front()) continue;
    std::size_t const given = options.show.size() - 1;
    bool const twice = names.back() == "scan" && given == 2 * r.words.size();
    if (given == r.words.size() || twice || (r.optional && given < r.words.size())) return r;
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
                     fmt::format("stay between {:g} and {:g} {}", p.low, p.high,
                                 p.dimension == dim::angle ? "rad" : example_unit(p.dimension)));
  return value;
}

// Tilts and curvatures act on modes alone, and tilts make odd ones.
void refuse_missing_modes(NetworkModel const& model, std::string const& parameter) {
  bool const tilt = parameter.ends_with(".tilt_x") || parameter.ends_with(".tilt_y"),
             curvature = parameter.ends_with(".curvature") || parameter.ends_with(".curvature_y");
  if ((tilt || curvature) && !model.network.modes())
    throw InputError(fmt::format("plane waves do not depend on '{}'", parameter),
                     "add 'modes: {order: 2}' to the network");
  if (tilt && model.network.modes()->even)
    throw InputError(fmt::format("'{}' makes odd modes, which 'parity: even' leaves out", parameter),
                     "write 'parity: all' in 'modes' of the network");
}

ScanAxis axis_of(NetworkModel const& model, std::span<std::string const> words, std::size_t points) {
  auto const parameter = find_parameter(model, words[0]);
  if (!parameter) throw unknown("parameter", words[0], parameter_names(model));
  refuse_missing_modes(model, words[0]);
  return {*parameter, value_of_parameter(*parameter, words[1]), value_of_parameter(*parameter, words[2]), points};
}

NetworkScan scanned(NetworkModel const& model, IfoOptions const& options) {
  if (model.readouts.empty())
    throw InputError("the network has no read-outs to scan",
                     "add for example 'readouts: {out: {power: ETM.back.out}}'");
  std::span<std::string const> const words(options.show);
  bool const map = words.size() == 7;
  std::size_t const points = options.points ? options.points : map ? points_of_map : points_of_curve;
  if (map && points * points > most_points)
    throw InputError(fmt::format("a map of {0} by {0} points is too large", points), "write --points 1000 or less");
  std::vector<ScanAxis> axes = {axis_of(model, words.subspan(1, 3), points)};
  if (map) axes.push_back(axis_of(model, words.subspan(4, 3), points));
  if (map && axes[0].parameter.name == axes[1].parameter.name)
    throw InputError(fmt::format("both axes of the scan are '{}'", words[1]), "name two parameters");
  return scan_network(model, std::move(axes));
}

FrequencyBand band_of(IfoOptions const& options) {
  return option_band(options.band.empty() ? whole_band : options.band, "--band", curve_band);
}
std::vector<double> places_in_band(IfoOptions const& options) {
  return parse_frequencies(options.at.empty() ? usual_frequency : options.at, "--at");
}

std::vector<double> frequencies(IfoOptions const& options) {
  FrequencyBand const band = band_of(options);
  std::vector<double> hz;
  std::size_t const points = options.points ? options.points : points_of_curve;
  for (std::size_t i = 0; i < points; ++i)
    hz.push_back(band.low * std::pow(band.high / band.low, double(i) / double(points - 1)));
  return hz;
}

NamedWay stray_way(NetworkModel const& model, std::string const& name) {
  if (auto const way = find_way(model, name)) return *way;
  if (name == "all")
    throw InputError("a curve is that of one entrance of stray light, not of 'all'",
                     "name an entrance or a beam; --show stray all lists them");
  std::vector<std::string> known;
  for (NamedWay const& w : model.entrances) known.push_back(w.name);
  for (NamedWay const& w : ways_of_all_beams(model)) known.push_back(w.name);
  throw unknown("entrance or beam", name, known);
}

// A read-out or a mirror; nothing: h.
std::optional<NamedReadout> effect_of(NetworkModel const& model, std::string const& name) {
  if (name == "h" && model.strain) return {};
  auto effect = find_effect(model, name);
  if (!effect) throw unknown("read-out or mirror", name, effect_names(model));
  return effect;
}

// From a stray field, "stray:arm".
Sheet stray_transferred(NetworkModel const& model, IfoOptions const& options, std::string const& entrance) {
  NamedWay const way = stray_way(model, entrance);
  std::string const& to = options.show[2];
  Sheet sheet = stray_curve(stray_transfer(model, way, effect_of(model, to), frequencies(options)), to);
  sheet.name = "transfer";
  return sheet;
}

Sheet transferred(NetworkModel const& model, IfoOptions const& options) {
  std::string const stray = "stray:";
  if (options.show[1].starts_with(stray))
    return stray_transferred(model, options, options.show[1].substr(stray.size()));
  auto const cause = find_cause(model, options.show[1]);
  if (!cause) throw unknown("cause", options.show[1], cause_names(model));
  auto const effect = effect_of(model, options.show[2]);
  std::vector<double> const hz = frequencies(options);
  char const* const unit = effect ? unit_of(effect->readout) : "1";
  return transfer_sheet(*cause, options.show[2], unit, hz, transfer_function(model, *cause, effect, hz));
}

NamedReadout const& readout_of(NetworkModel const& model, std::string const& name) {
  if (NamedReadout const* const readout = model.readout(name)) return *readout;
  std::vector<std::string> names;
  for (NamedReadout const& r : model.readouts) names.push_back(r.name);
  throw unknown("read-out", name, names);
}

Sheet slopes_of_readout(NetworkModel const& model, IfoOptions const& options) {
  NamedReadout const& readout = readout_of(model, options.show[1]);
  if (!readout.is_power() && !readout.is_demodulated())
    throw InputError(fmt::format("'{}' is a homodyne detector, and slopes are those of a power", readout.name),
                     "name a read-out of kind 'power' or 'demodulate', or write --show transfer FROM TO");
  return slopes_sheet(readout, parameter_slopes(model, readout.readout));
}

Sheet noise_of_readout(NetworkModel const& model, IfoOptions const& options) {
  NamedReadout const& readout = readout_of(model, options.show[1]);
  NamedFreedom const* const freedom = options.referred.empty() ? nullptr : model.freedom(options.referred);
  if (!freedom && !options.referred.empty()) {
    std::vector<std::string> names;
    for (NamedFreedom const& f : model.freedoms) names.push_back(f.name);
    throw unknown("degree of freedom", options.referred, names);
  }
  return noise_sheet(readout, freedom, noise_of(model, readout, freedom, frequencies(options)));
}

// Over the band.
Sheet curve_of_loops(NetworkModel const& model, IfoOptions const& options) {
  std::vector<double> const hz = frequencies(options);
  std::string const& curve = options.show[1];
  if (curve == "noise") return strain_noise_sheet(strain_noise(model, hz));
  if (curve != "suppression")
    throw InputError(fmt::format("--show loops has no curve '{}'", curve), "write suppression, or noise of the strain");
  std::vector<LoopCurve> const curves = loop_curves(model, hz);
  if (curves.empty())
    throw InputError("no loop is closed", "add 'loops: {PRCL: {sensor: ..., open_loop: ...}}' to the interferometer");
  return suppression_sheet(hz, curves);
}

std::vector<Sheet> loops_of(NetworkModel const& model, IfoOptions const& options) {
  if (!model.strain)
    throw InputError("the loops and the noise of h need a strain",
                     "add 'strain: {readout: AS, freedom: DARM, arm_length: 3 km}', or start from a preset");
  if (options.show.size() == 2) return {curve_of_loops(model, options)};
  FrequencyBand const band = band_of(options);
  std::vector<Sheet> all;
  for (double const hz : places_in_band(options)) {
    std::vector<Sheet> const sheets = loop_sheets(loop_table(model, hz, {band.low, band.high}));
    all.insert(all.end(), sheets.begin(), sheets.end());
  }
  return all;
}

// Named entrances, one, or every beam, at some frequencies; or one over the band into one read-out.
std::vector<Sheet> stray_sheets(NetworkModel const& model, IfoOptions const& options) {
  std::vector<std::string> const& words = options.show;
  bool const all = words.size() > 1 && words[1] == "all";
  if (words.size() == 3) {
    if (all)
      throw InputError("--show stray all READOUT is too much for one curve", "name one entrance instead of 'all'");
    std::vector<std::string> known;
    for (NamedReadout const& r : model.readouts) known.push_back(r.name);
    if (model.strain) known.emplace_back("h");
    if (std::ranges::find(known, words[2]) == known.end()) throw unknown("read-out", words[2], known);
    return {stray_curve(stray_rows(model, {stray_way(model, words[1])}, frequencies(options)), words[2])};
  }
  std::vector<NamedWay> const ways = all                ? ways_of_all_beams(model)
                                     : words.size() > 1 ? std::vector{stray_way(model, words[1])}
                                                        : model.entrances;
  if (ways.empty())
    throw InputError("the network names no entrances of stray light",
                     "write --show stray all, or --show stray BEAM with a beam of the network: ITM.front.in");
  std::vector<Sheet> sheets;
  for (double const hz : places_in_band(options)) sheets.push_back(stray_sheet(model, stray_rows(model, ways, {hz})));
  return sheets;
}

std::vector<Sheet> modes_of(NetworkModel const& model) {
  if (!model.network.modes())
    throw InputError("the network is solved in plane waves: it has no modes",
                     "add 'modes: {order: 2}' to the network, and the curvatures of its mirrors");
  return mode_sheets(mode_table(model));
}

std::vector<Sheet> sheets_of(NetworkModel const& model, IfoOptions const& options) {
  std::string const& what = options.show.front();
  if (what == "loops") return loops_of(model, options);
  if (what == "scan") return {scan_sheet(model, scanned(model, options))};
  if (what == "errors") return {errors_sheet(error_signals(model))};
  if (what == "slopes") return {slopes_of_readout(model, options)};
  if (what == "transfer") return {transferred(model, options)};
  if (what == "noise") return {noise_of_readout(model, options)};
  if (what == "stray") return stray_sheets(model, options);
  if (what == "modes") return modes_of(model);
  if (what == "point") return point_sheets(operating_point(model));
  std::vector<Sheet> all;
  for (double const hz : places_in_band(options)) all.push_back(sensing_sheet(sensing_matrix(model, hz)));
  return all;
}

// Options that have no effect on what is shown.
void refuse_idle_options(IfoOptions const& options, std::string const& what) {
  bool const page = !options.page.empty(), one_way = what == "stray" && options.show.size() == 3,
             curve = what == "loops" && options.show.size() == 2;
  bool const over_band = what == "transfer" || what == "noise" || one_way || curve;
  auto const refuse = [&](bool given, bool of_use, char const* option, char const* shows) {
    if (given && !of_use)
      throw InputError(fmt::format("{} has no effect on --show {}", option, fmt::join(options.show, " ")),
                       fmt::format("remove it; it is for --show {}", shows));
  };
  refuse(!options.band.empty(), over_band || what == "loops" || page, "--band",
         "transfer, noise, stray ENTRANCE READOUT and loops");
  refuse(!options.at.empty(), what == "sensing" || (what == "loops" && !curve) || (what == "stray" && !one_way) || page,
         "--at", "sensing, loops and stray");
  refuse(options.points > 0, over_band || what == "scan", "--points",
         "scan, transfer, noise, stray ENTRANCE READOUT and loops CURVE");
  refuse(!options.referred.empty(), what == "noise", "--referred-to", "noise READOUT");
}

void check(IfoOptions const& options) {
  refuse_two_formats(options.csv, options);
  std::string const what = request_of(options).what;
  refuse_idle_options(options, what);
  bool const curve = what == "scan" || what == "transfer" || what == "noise" || what == "errors" ||
                     (what == "stray" && options.show.size() == 3) || (what == "loops" && options.show.size() == 2);
  if (!options.plot.empty() && !curve)
    throw InputError("--plot draws a scan, a response, a noise or error signals",
                     "remove it, or write --show scan PARAMETER FROM TO, or --show stray ENTRANCE READOUT");
  if (!options.plot.empty()) check_ending(options.plot, {".png"}, "--plot");
  if (!options.page.empty()) check_ending(options.page, {".html"}, "--html");
  if (what == "network" && (options.csv || options.json()))
    throw InputError("--show network prints a scene", "remove --csv and --format json");
}

void write_page(OpticalNetwork const& network, IfoOptions const& options) {
  std::vector<Sheet> loops, curves;
  if (network.model.strain) {
    loops = loops_of(network.model, options);
    curves = page_curves(network.model, band_of(options));
  }
  std::string message;
  std::string const page =
      picture_of(json_text(page_json(network, places_in_band(options), loops, curves)), "ifo_page", message, ".html");
  if (page.empty()) throw InputError(message, "or remove --html");
  write_file(options.page, page);
}

void draw(std::vector<Sheet> const& sheets, IfoOptions const& options) {
  std::string message;
  nlohmann::ordered_json json = json_of(sheets);
  json["show"] = options.show;
  std::string const picture = picture_of(json_text(json), "ifo", message);
  if (picture.empty()) throw InputError(message, "or remove --plot");
  write_file(options.plot, picture);
}

// Light that higher modes would hold is in no table. A sentence and its remedy; empty: all fits.
std::string missing_modes(NetworkModel const& model) {
  if (!model.network.modes()) return "";
  OperatingPoint const point = operating_point(model);
  if (!(point.missing > Truncation::most_change * point.emitted)) return "";
  return fmt::format(
      "the modes up to order {} do not take {:.2g} of the light\n  raise 'order', or match the beams: --show modes "
      "says "
      "where they do not match",
      model.network.modes()->order, point.missing / point.emitted);
}

// Of the scene and of the solution, as problems_as_json.
nlohmann::ordered_json warnings_of(OpticalNetwork const& network, std::vector<std::string> const& more) {
  auto all = nlohmann::ordered_json::array();
  std::vector<std::string> lists{network.warnings_json};
  for (std::string const& text : more) lists.push_back(warning_as_json(text));
  for (std::string const& list : lists)
    if (!list.empty())
      for (auto& problem : read_ordered_json(list)) all.push_back(std::move(problem));
  return all;
}

int ifo(IfoOptions const& options) {
  check(options);
  OpticalNetwork const network = read_optical_network(options);
  std::vector<std::string> warnings;
  for (std::string const& text : {missing_modes(network.model)})
    if (!text.empty()) warnings.push_back(text);
  for (std::string const& text : warnings) print_warning(text, options);
  if (options.show.front() == "network") {
    std::cout << network_text(network.model);
    return done;
  }
  std::vector<Sheet> const sheets = sheets_of(network.model, options);
  if (!options.plot.empty()) draw(sheets, options);
  if (!options.page.empty()) write_page(network, options);
  if (options.json()) {
    nlohmann::ordered_json answer = json_of(sheets);
    answer["warnings"] = warnings_of(network, warnings);
    std::cout << json_text(answer) << '\n';
  } else
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
      ->add_option("--show", o.show,
                   "point (default), scan PARAMETER FROM TO (once or twice), errors, slopes READOUT, transfer FROM TO "
                   "(also transfer stray:ENTRANCE TO), "
                   "sensing, noise READOUT, loops (also loops suppression, loops noise), stray (also stray all, stray "
                   "ENTRANCE, stray ENTRANCE READOUT), "
                   "modes, or network: the scene of the network")
      ->expected(1, 7)
      ->allow_extra_args(false);
  command
      ->add_option("--points", o.points,
                   "of a scan (of each axis where there are two) or a curve; default 201, of two axes 41 each")
      ->check(whole_between(2, 100000, "201"));
  command->add_option("--band", o.band, "of a response, a noise or the margins of loops; default \"1 Hz..10 kHz\"");
  command->add_option("--at", o.at, "frequencies of the sensing matrix, the loops and stray light; default \"10 Hz\"");
  command->add_option("--referred-to", o.referred, "noise as the displacement of this degree of freedom");
  command->add_flag("--csv", o.csv, "all digits, SI");
  mark_output(*command,
              *command->add_option("--plot", o.plot, "picture of a scan, a response, a noise or error signals (PNG)"));
  command->footer(
      "Examples:\n"
      "  straytrace ifo examples/ifo_cavity.yaml\n"
      "  straytrace ifo examples/ifo_cavity.yaml --show scan LENGTH -5nm 5nm --plot pdh.png");
  mark_output(*command, *command->add_option("--html", o.page, "page with a drawing of the network and its tables"));
  command->callback([options, &exit_code] { exit_code = ifo(*options); });
}

}  // namespace straytrace::cli
