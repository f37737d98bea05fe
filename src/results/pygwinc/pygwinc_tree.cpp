// SPDX-License-Identifier: BSD-3-Clause
#include "results/pygwinc/pygwinc_tree.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/input/document.hpp"
#include "base/input/table.hpp"
#include "base/math/constants.hpp"
#include "noise/fundamental/fundamental.hpp"

namespace straytrace::results {
namespace {

bool is_nan(std::string const& text) { return text == ".nan" || text == ".NaN" || text == ".NAN"; }

bool below(std::string const& path, std::string const& table) {
  return path.size() > table.size() && path.starts_with(table) && path[table.size()] == '.';
}

Place place_of(YAML::Mark const& mark, std::size_t source) {
  return {std::uint32_t(source), std::uint32_t(mark.line + 1), std::uint32_t(mark.column + 1)};
}

constexpr std::size_t most_nodes = 10'000, deepest_table = 32;

bool is_digits(std::string_view text) { return !text.empty() && text.find_first_not_of("0123456789") == text.npos; }

Problem decimal_comma(Place const& place, std::string const& text) {
  std::string meant = text;
  std::replace(meant.begin(), meant.end(), ',', '.');
  return {place, fmt::format("'{}' has a decimal comma", shortened(text)), fmt::format("write {}", shortened(meant))};
}

bool has_decimal_comma(std::string text) {
  std::size_t const comma = text.find(',');
  if (comma == text.npos) return false;
  text[comma] = '.';
  return is_number(text);
}

// Nested plain YAML, from a map of dotted paths in order: numbers of a list follow each other.
void write_yaml(YAML::Emitter& out, std::map<std::string, IfoTree::Value> const& values, std::string const& table) {
  std::vector<std::string> keys;
  for (auto const& [path, value] : values) {
    if (!table.empty() && !below(path, table)) continue;
    std::string const rest = table.empty() ? path : path.substr(table.size() + 1);
    std::string const key = rest.substr(0, rest.find('.'));
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  }
  bool const list = !keys.empty() && std::all_of(keys.begin(), keys.end(), is_digits);
  if (list)
    std::sort(keys.begin(), keys.end(), [](auto const& a, auto const& b) { return std::stoi(a) < std::stoi(b); });
  if (list)
    out << YAML::BeginSeq;
  else
    out << YAML::BeginMap;
  for (std::string const& key : keys) {
    std::string const path = table.empty() ? key : table + "." + key;
    if (!list) out << YAML::Key << key << YAML::Value;
    if (auto const found = values.find(path); found != values.end())
      out << found->second.text;
    else
      write_yaml(out, values, path);
  }
  if (list)
    out << YAML::EndSeq;
  else
    out << YAML::EndMap;
}

}  // namespace

void IfoTree::collect(YAML::Node const& node, std::string const& path, std::size_t depth) {
  std::size_t const number = sources_.size() - 1;
  if (++nodes_ > most_nodes || depth > deepest_table) {
    problems_.push_back(
        {place_of(node.Mark(), number),
         fmt::format("more than {} values, or tables nested more than {} deep", most_nodes, deepest_table),
         "write values out where an alias (*name) repeats too many of them"});
    throw_if_problems();
  }
  if (node.IsMap()) {
    collect_table(node, path, depth);
  } else if (node.IsSequence()) {
    std::erase_if(values_, [&](auto const& v) { return below(v.first, path) && v.second.place.file != number; });
    for (std::size_t i = 0; i < node.size(); ++i) collect(node[i], fmt::format("{}.{}", path, i), depth + 1);
  } else if (node.IsScalar()) {
    values_[path] = {node.Scalar(), place_of(node.Mark(), number)};
  } else {
    empty_[path] = place_of(node.Mark(), number);
  }
}

void IfoTree::collect_table(YAML::Node const& table, std::string const& path, std::size_t depth) {
  std::size_t const number = sources_.size() - 1;
  std::set<std::string> keys;
  YAML::Node before(YAML::NodeType::Null);
  for (auto const& item : table) {
    Place const place = place_of(item.first.Mark(), number);
    if (!item.first.IsScalar()) {
      problems_.push_back({place, "a key must be plain text", "write 'key: value'"});
      continue;
    }
    std::string const key = item.first.Scalar(), inner = path.empty() ? key : path + "." + key;
    if (item.second.IsNull() && before.IsScalar() && is_digits(key.substr(0, 1)) && is_number(before.Scalar())) {
      problems_.push_back(decimal_comma(place_of(before.Mark(), number), before.Scalar() + "," + key));
      continue;  // "{Power: 2,5}" is a table with the keys 'Power' and '5'
    }
    if (!keys.insert(key).second)
      problems_.push_back({place, fmt::format("'{}' is given twice", inner), "keep one of them"});
    collect(item.second, inner, depth + 1);
    before.reset(item.second);
  }
}

void IfoTree::add(std::string const& source, std::string const& yaml) {
  sources_.push_back(source);
  nodes_ = 0;
  std::size_t const number = sources_.size() - 1;
  try {
    YAML::Node const root = YAML::Load(yaml);
    if (!root.IsMap()) {
      problems_.push_back({{std::uint32_t(number), 1, 1},
                           "this is not a description of an interferometer",
                           "write keys as in pygwinc's ifo.yaml, or 'extends: aligo' and the differences"});
      return;
    }
    if (root["straytrace"]) {
      problems_.push_back({{std::uint32_t(number), 1, 1},
                           "this is a scene, not a detector",
                           "name a preset or a file like pygwinc's ifo.yaml; of a scene, name its run: out/run.h5"});
      return;
    }
    collect(root, "", 0);
  } catch (YAML::Exception const& e) {
    problems_.push_back({place_of(e.mark, number), fmt::format("this is not YAML: {}", e.msg),
                         "write 'key: value', tables by indentation"});
  }
}

void IfoTree::set(std::string const& path, std::string const& text) {
  if (sources_.empty() || sources_.back() != "command line") sources_.push_back("command line");
  values_[path] = {text, {std::uint32_t(sources_.size() - 1), 0, 0}};
}

IfoTree::Value const* IfoTree::find(std::string const& path) {
  asked_.insert(path);
  auto const found = values_.find(path);
  return found == values_.end() ? nullptr : &found->second;
}

std::optional<std::size_t> IfoTree::source_of(std::string const& path) const {
  auto const found = values_.find(path);
  if (found == values_.end() || is_nan(found->second.text)) return std::nullopt;
  return found->second.place.file;
}

void IfoTree::drop(std::string const& path) { values_.erase(path); }

bool IfoTree::has(std::string const& path) const {
  auto const next = values_.lower_bound(path);
  return next != values_.end() &&
         (next->first == path || std::any_of(next, values_.end(), [&](auto const& v) { return below(v.first, path); }));
}

double IfoTree::number(std::string const& path, bool needed) {
  Value const* value = find(path);
  if (value && is_nan(value->text)) value = nullptr;
  if (!value) {
    if (needed) problem(path, fmt::format("'{}' is missing", path), "give a number in SI units");
    return not_a_number;
  }
  if (has_decimal_comma(value->text)) {
    Problem const comma = decimal_comma(value->place, value->text);
    problem(path, comma.what, comma.suggestion);
    return not_a_number;
  }
  if (!is_number(value->text)) {
    problem(path, fmt::format("'{}' is a number, got \"{}\"", path, value->text),
            "write it in SI units, without a unit, for example 1.064e-6");
    return not_a_number;
  }
  double const x = leading_number(value->text)->value;
  if (std::string const wanted = out_of_range(path, x); !wanted.empty()) {
    problem(path, fmt::format("'{}' is {:g}, out of range", path, x), fmt::format("write a number {}", wanted));
    return not_a_number;
  }
  return x;
}

double IfoTree::number(std::string const& path, double fallback) {
  double const x = number(path, false);
  return std::isnan(x) ? fallback : x;
}

std::string IfoTree::word(std::string const& path, std::string const& fallback) {
  Value const* const value = find(path);
  return value ? value->text : fallback;
}

std::vector<std::string> IfoTree::elements(std::string const& list) const {
  std::vector<std::string> all;
  while (has(fmt::format("{}.{}", list, all.size()))) all.push_back(fmt::format("{}.{}", list, all.size()));
  return all;
}

void IfoTree::problem(std::string const& path, std::string what, std::string suggestion) {
  auto const found = values_.find(path);
  Place const place = found == values_.end() ? Place{std::uint32_t(sources_.size() - 1), 0, 0} : found->second.place;
  auto const said = [&](Problem const& p) {
    return p.what == what && p.place.file == place.file && p.place.line == place.line && p.place.column == place.column;
  };
  if (std::any_of(problems_.begin(), problems_.end(), said)) return;  // read more than once
  problems_.push_back({place, std::move(what), std::move(suggestion)});
}

void IfoTree::report_unread(std::size_t from_source) {
  std::vector<std::string> known(asked_.begin(), asked_.end());
  auto const table = [&](std::string const& path) {
    auto const next = asked_.lower_bound(path + ".");
    return next != asked_.end() && below(*next, path) ? *next : "";
  };
  auto const unknown = [&](std::string const& path) {
    return Problem{{},
                   fmt::format("unknown key '{}'", path),
                   did_you_mean(path, known, "see the keys in docs/reference/budget.md")};
  };
  for (auto const& [path, value] : values_) {
    if (value.place.file < from_source || asked_.contains(path)) continue;
    std::string const inside = table(path);
    Problem const p = inside.empty() ? unknown(path)
                                     : Problem{{},
                                               fmt::format("'{}' is a table, not a value", path),
                                               fmt::format("give a key of it, for example {}", inside)};
    problem(path, p.what, p.suggestion);
  }
  for (auto const& [path, place] : empty_) {
    if (place.file < from_source) continue;
    Problem p = unknown(path);
    if (asked_.contains(path) || !table(path).empty())
      p = {{}, fmt::format("'{}' has no value", path), "write a value, or remove the key"};
    p.place = place;
    problems_.push_back(p);
  }
}

void IfoTree::throw_if_problems() {
  if (problems_.empty()) return;
  std::stable_sort(problems_.begin(), problems_.end(), [](Problem const& a, Problem const& b) {
    return std::tie(a.place.file, a.place.line, a.place.column) < std::tie(b.place.file, b.place.line, b.place.column);
  });
  std::string text;
  for (Problem const& p : problems_) text += placed_message(p, sources_.at(p.place.file)) + '\n';
  text += fmt::format("{} error{}. Nothing was run.", problems_.size(), problems_.size() == 1 ? "" : "s");
  throw InputError(problems_, text, sources_);
}

std::string IfoTree::yaml() const {
  YAML::Emitter out;
  write_yaml(out, values_, "");
  return out.c_str();
}

// Sections of the file.

namespace {

WireMaterial read_wire(IfoTree& t, std::string const& name) {
  std::string const at = "Suspension." + name + ".";
  WireMaterial m;
  m.density = t.number(at + "Rho");
  m.heat_capacity = t.number(at + "C");
  m.conductivity = t.number(at + "K");
  m.expansion = t.number(at + "Alpha");
  m.modulus_slope = t.number(at + "dlnEdT");
  m.loss = t.number(at + "Phi");
  m.young = t.number(at + "Y");
  m.surface_depth = t.number(at + "Dissdepth", 0.0);
  return m;
}

// The fibre of the last stage, unless the stage states wires of its own.
void read_fibre(IfoTree& t, SuspensionStage& s) {
  std::string const kind = t.word("Suspension.FiberType", "Round");
  if (kind == "Ribbon") {
    if (std::isnan(s.wire_radius)) s.wire_radius = t.number("Suspension.Ribbon.Width");
    s.ribbon_thickness = t.number("Suspension.Ribbon.Thickness");
    return;
  }
  if (std::isnan(s.wire_radius)) s.wire_radius = t.number("Suspension.Fiber.Radius");
  if (kind == "Tapered") {
    s.end_radius = t.number("Suspension.Fiber.EndRadius");
    s.end_length = t.number("Suspension.Fiber.EndLength");
  } else if (kind != "Round") {
    t.problem("Suspension.FiberType", fmt::format("'{}' is not a kind of fibre", kind),
              "write Round, Ribbon or Tapered");
  }
}

}  // namespace

SuspensionChain read_suspension(IfoTree& t, double arm_length) {
  SuspensionChain chain;
  std::vector<std::string> const places = t.elements("Suspension.Stage");  // from the test mass to the top
  double const given = t.number("Suspension.Temp", false);
  double above = given;
  for (std::size_t i = places.size(); i-- > 0;) {
    std::string const at = places[i] + ".";
    bool const last = i == 0;
    SuspensionStage s;
    s.mass = t.number(at + "Mass");
    s.length = t.number(at + "Length");
    s.wires = t.number(at + "NWires");
    s.wire_radius = t.number(at + "WireRadius", !last);
    s.dilution = t.number(at + "Dilution", false);
    s.vertical_spring = t.number(at + "K", false);
    s.blade = t.number(at + "Blade", false);
    s.temperature = t.number(at + "Temp", given);
    if (std::isnan(s.temperature)) s.temperature = t.number("Suspension.Temp");
    s.upper_temperature = std::isnan(above) ? s.temperature : above;
    above = s.temperature;
    std::string const wire = t.word(at + "WireMaterial", last ? "Silica" : "C70Steel");
    s.upper = read_wire(t, t.word(at + "WireMaterialUpper", wire));
    s.lower = read_wire(t, t.word(at + "WireMaterialLower", wire));
    std::string const blade = t.word(at + "BladeMaterial", "MaragingSteel");
    if (std::isfinite(s.vertical_spring)) s.blades = read_wire(t, blade);
    if (last) read_fibre(t, s);
    chain.stages.push_back(s);
  }
  constexpr double earth_radius = 6.3781e6;  // m: mirrors hang towards its centre
  chain.vertical_coupling = t.number("Suspension.VHCoupling.theta", arm_length / earth_radius);
  return chain;
}

SubstrateMaterial read_substrate(IfoTree& t) {
  std::string const at = "Materials.Substrate.";
  SubstrateMaterial m;
  m.temperature = t.number(at + "Temp");
  m.young = t.number(at + "MirrorY");
  m.poisson = t.number(at + "MirrorSigma");
  m.density = t.number(at + "MassDensity");
  m.expansion = t.number(at + "MassAlpha");
  m.heat_capacity = t.number(at + "MassCM");
  m.conductivity = t.number(at + "MassKappa");
  m.index = t.number(at + "RefractiveIndex");
  m.loss = t.number(at + "c2");
  m.loss_exponent = t.number(at + "MechanicalLossExponent");
  m.surface_loss = t.number(at + "Alphas");
  m.index_slope = t.number(at + "dndT", false);
  return m;
}

CoatingMaterial read_coating(IfoTree& t, std::string const& end) {  // "lown", "highn"
  std::string const at = "Materials.Coating.";
  CoatingMaterial m;
  m.young = t.number(at + "Y" + end);
  m.poisson = t.number(at + "Sigma" + end);
  m.index = t.number(at + "Index" + end);
  m.heat_capacity = t.number(at + "CV" + end);
  m.conductivity = t.number(at + "ThermalDiffusivity" + end);
  m.expansion = t.number(at + "Alpha" + end);
  m.index_slope = t.number(at + "Beta" + end);
  m.loss = t.number(at + "Phi" + end);
  m.loss_slope = t.number(at + "Phi" + end + "_slope", 0.0);
  for (char const* what : {"PET", "lossB", "lossS"})  // experimental options of pygwinc
    if (std::string const path = at + what + end; t.has(path))
      t.problem(path, fmt::format("'{}' is not taken into account", path),
                "remove it: losses are equal in bulk and shear, without photo-elastic effect");
  return m;
}

std::vector<GasSpecies> read_gas(IfoTree& t) {
  std::vector<GasSpecies> all;
  auto const species = [&](std::string const& name, std::string const& at, char const* tube, char const* chamber) {
    GasSpecies g{name, t.number(at + tube), 0, t.number(at + "mass"), t.number(at + "polarizability")};
    g.chamber_pressure = t.number(at + chamber, g.tube_pressure);
    all.push_back(g);
  };
  std::string const at = "Infrastructure.ResidualGas.";
  if (t.has(at + "pressure")) species("gas", at, "pressure", "pressure");  // older files: one gas
  for (char const* name : {"H2", "N2", "H2O", "O2"})
    if (t.has(at + name)) species(name, at + name + ".", "BeamtubePressure", "ChamberPressure");
  return all;
}

Ground read_ground(IfoTree& t) {
  std::string const at = "Seismic.";
  Ground g;
  g.platform = t.word(at + "PlatformMotion", "BSC");
  if (std::isnan(platform_asd(g.platform, 1)))
    t.problem(at + "PlatformMotion", fmt::format("'{}' is not a motion of a platform", g.platform),
              fmt::format("write one of: {}", fmt::join(platform_names(), ", ")));
  if (!t.has(at + "LowFrequencyLevel")) return g;
  g.level = t.number(at + "LowFrequencyLevel");
  g.knee = t.number(at + "KneeFrequency");
  g.abruptness = t.number(at + "Gamma");
  g.density = t.number(at + "Rho");
  g.height = t.number(at + "TestMassHeight");
  g.rayleigh_speed = t.number(at + "RayleighWaveSpeed");
  g.p_speed = t.number(at + "pWaveSpeed", 2.4 * g.rayleigh_speed);  // files before 2021 lack it
  g.s_speed = t.number(at + "sWaveSpeed", 1.2 * g.rayleigh_speed);
  g.p_level = t.number(at + "pWaveLevel", false);
  g.s_level = t.number(at + "sWaveLevel", false);
  g.subtraction = t.number(at + "Omicron", 1.0);
  g.steeper = t.word(at + "Site") == "LLO";
  return g;
}

std::optional<Squeezer> read_squeezer(IfoTree& t) {
  std::string const type = t.word("Squeezer.Type", "Freq Independent");
  if (type != "None" && type != "Freq Independent" && type != "Freq Dependent")
    t.problem("Squeezer.Type", fmt::format("'{}' is not a kind of squeezing", type),
              "write None, Freq Independent or Freq Dependent");
  Squeezer q;
  q.decibels = t.number("Squeezer.AmplitudedB", 0.0);
  if (type == "None" || q.decibels == 0) return std::nullopt;
  q.anti_decibels = t.number("Squeezer.AntiAmplitudedB", false);
  q.angle = t.number("Squeezer.SQZAngle", 0.0);
  q.loss = t.number("Squeezer.InjectionLoss", 0.0);
  q.phase_noise = t.number("Squeezer.LOAngleRMS", 0.0);
  if (type != "Freq Dependent") return q;
  std::vector<std::string> places = t.elements("Squeezer.FilterCavity");
  if (places.empty()) places.push_back("Squeezer.FilterCavity");
  for (std::string const& place : places) {
    std::string const at = place + ".";
    q.cavities.push_back({t.number(at + "L"), t.number(at + "fdetune"), t.number(at + "Ti"), t.number(at + "Te"),
                          t.number(at + "Lrt"), t.number(at + "Rot", 0.0)});
  }
  return q;
}

namespace {

struct Range {
  double low, high;
  bool with_low, with_high;
  bool holds(double x) const { return (with_low ? x >= low : x > low) && (with_high ? x <= high : x < high); }
  std::string words() const {
    std::string const first = fmt::format("{} {:g}", with_low ? "from" : "above", low);
    if (high == infinity) return first;
    return fmt::format("{} {} {:g}", first, !with_high ? "and below" : with_low ? "to" : "and up to", high);
  }
};

constexpr Range positive{0, infinity, false, false}, not_negative{0, infinity, true, false};
constexpr Range transmission{0, 1, false, false}, share{0, 1, true, false}, yield{0, 1, false, true};
constexpr Range kelvin{0, 1e4, false, true}, poisson{-1, 0.5, false, false}, index{1, 10, true, true};

struct Rule {
  std::string_view end;  // of the path, from a dot on
  Range range;
};

// The first that fits.
constexpr Rule rules[] = {
    {"Laser.Wavelength", {0, 1e-4, false, true}},
    {"Laser.Power", positive},
    {"Laser.ArmPower", positive},
    {"ETM.Transmittance", share},
    {"ITM.Transmittance", transmission},
    {"Transmittance", yield},  // recycling mirrors: 1 is no mirror
    {"CavityLength", not_negative},
    {"Optics.Loss", {0, 0.1, true, true}},
    {"BSLoss", share},
    {"SRCloss", share},
    {"coupling", yield},
    {"PhotoDetectorEfficiency", yield},
    {"AmplitudedB", {0, 60, true, true}},
    {"AntiAmplitudedB", {0, 100, true, true}},
    {"InjectionLoss", {0, 1, true, true}},
    {"LOAngleRMS", {0, pi / 2, true, true}},
    {"L", positive},
    {"Ti", transmission},
    {"Te", share},
    {"Lrt", share},
    {"MassRadius", positive},
    {"MassThickness", positive},
    {"Temp", kelvin},
    {"Mass", positive},
    {"mass", positive},
    {"polarizability", not_negative},
    {"pressure", not_negative},
    {"BeamtubePressure", not_negative},
    {"ChamberPressure", not_negative},
    {"Length", positive},
    {"NWires", {1, 100, true, true}},
    {"WireRadius", positive},
    {"Dilution", positive},
    {"Blade", positive},
    {"K", positive},
    {"Rho", positive},
    {"C", positive},
    {"Y", positive},
    {"Phi", share},
    {"Dissdepth", not_negative},
    {"Radius", positive},
    {"EndRadius", positive},
    {"EndLength", positive},
    {"Width", positive},
    {"Thickness", positive},
    {"MirrorY", positive},
    {"MirrorSigma", poisson},
    {"MassDensity", positive},
    {"MassCM", positive},
    {"MassKappa", positive},
    {"RefractiveIndex", index},
    {"c2", not_negative},
    {"Alphas", not_negative},
    {"Yhighn", positive},
    {"Ylown", positive},
    {"Sigmahighn", poisson},
    {"Sigmalown", poisson},
    {"Indexhighn", index},
    {"Indexlown", index},
    {"CVhighn", positive},
    {"CVlown", positive},
    {"ThermalDiffusivityhighn", positive},
    {"ThermalDiffusivitylown", positive},
    {"Phihighn", share},
    {"Philown", share},
    {"CoatingThicknessLown", {0, 0.5, false, false}},
    {"CoatingThicknessCap", not_negative},
    {"LowFrequencyLevel", not_negative},
    {"KneeFrequency", positive},
    {"Gamma", not_negative},
    {"RayleighWaveSpeed", positive},
    {"pWaveSpeed", positive},
    {"sWaveSpeed", positive},
    {"pWaveLevel", not_negative},
    {"sWaveLevel", not_negative},
    {"Omicron", positive},
    {"AirPressure", positive},
    {"AirDensity", positive},
    {"AdiabaticIndex", positive},
    {"SoundSpeed", positive},
};

bool fits(std::string_view path, std::string_view end) {
  return path == end || (path.size() > end.size() && path.ends_with(end) && path[path.size() - end.size() - 1] == '.');
}

}  // namespace

std::string out_of_range(std::string_view path, double value) {
  if (path.find(".CoatLayerOpticalThickness.") != path.npos) return positive.holds(value) ? "" : positive.words();
  for (Rule const& rule : rules)
    if (fits(path, rule.end)) return rule.range.holds(value) ? "" : rule.range.words();
  return "";
}

}  // namespace straytrace::results
