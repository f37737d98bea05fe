// SPDX-License-Identifier: BSD-3-Clause
#include "results/pygwinc/pygwinc_ifo.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/table.hpp"
#include "io/hdf5/read_write.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "results/pygwinc/pygwinc_tree.hpp"
#include "results/results.hpp"

namespace straytrace::results {
namespace {

constexpr std::string_view preset_folder = "detectors/";
constexpr double probe_hz = 100;

CoatedMirror read_mirror(IfoTree& t, std::string const& name, bool coated) {
  std::string const at = "Optics." + name + ".";
  CoatedMirror m;
  m.transmission = t.number(at + "Transmittance");
  m.curvature = t.number("Optics.Curvature." + name);
  std::vector<std::string> const layers = t.elements(at + "CoatLayerOpticalThickness");
  for (std::string const& layer : layers) m.layers.push_back(t.number(layer));
  m.low_layer = t.number(at + "CoatingThicknessLown", coated && layers.empty());
  m.cap = t.number(at + "CoatingThicknessCap", 0.5);
  return m;
}

// One of the two: the later entry, in a file that extends a preset or on the command line, replaces the other.
void read_power(IfoTree& t, Detector& d) {
  char const *const power = "Laser.Power", *const arm = "Laser.ArmPower";
  auto const first = t.source_of(power), second = t.source_of(arm);
  if (first == second)
    t.problem(power, first ? "both Laser.Power and Laser.ArmPower are given" : "the power of the light is missing",
              "give Laser.Power, of the light that arrives at the power-recycling mirror, or Laser.ArmPower, in W");
  else
    t.drop(first > second ? arm : power);
  d.input_power = t.number(power, false);
  d.arm_power = t.number(arm, false);
}

void read_light(IfoTree& t, Detector& d) {
  d.arm_length = t.number("Infrastructure.Length");
  d.wavelength = t.number("Laser.Wavelength");
  read_power(t, d);
  d.power_recycling = t.number("Optics.PRM.Transmittance", 1.0);
  d.signal_recycling = t.number("Optics.SRM.Transmittance", 1.0);
  d.signal_length = t.number("Optics.SRM.CavityLength", 0.0);
  d.signal_detuning = t.number("Optics.SRM.Tunephase", 0.0);
  d.mirror_loss = t.number("Optics.Loss");
  d.splitter_loss = t.number("Optics.BSLoss", 0.0);
  d.signal_loss = 1 - t.number("Optics.coupling", 1.0) + t.number("TCS.SRCloss", 0.0);
  d.detection_efficiency = t.number("Optics.PhotoDetectorEfficiency", 1.0);
  d.readout_angle = t.number("Optics.Quadrature.dc", pi / 2);
  d.mirror_radius = t.number("Materials.MassRadius");
  d.mirror_thickness = t.number("Materials.MassThickness");
}

Detector read_detector(IfoTree& t) {
  Detector d;
  read_light(t, d);
  bool const coated = t.has("Materials.Coating");
  d.input = read_mirror(t, "ITM", coated);
  d.end = read_mirror(t, "ETM", coated);
  if (t.has("Suspension.Stage")) {
    d.suspension = read_suspension(t, d.arm_length);
    d.mirror_mass = d.suspension->stages.back().mass;
  } else {
    t.problem("Suspension.Stage", "'Suspension.Stage' is missing",
              "give at least one stage with the Mass of the mirror");
  }
  if (t.has("Materials.Substrate")) d.substrate = read_substrate(t);
  if (coated) d.coating = Detector::Coating{read_coating(t, "lown"), read_coating(t, "highn")};
  d.gas = read_gas(t);
  d.tube_temperature = t.number("Infrastructure.Temp", !d.gas.empty());
  if (t.has("Seismic")) d.ground = read_ground(t);
  if (t.has("Atmospheric")) {
    std::string const at = "Atmospheric.";
    d.air = Air{t.number(at + "AirPressure"), t.number(at + "AirDensity"), t.number(at + "AdiabaticIndex"),
                t.number(at + "SoundSpeed")};
  }
  if (t.has("Squeezer")) d.squeezer = read_squeezer(t);
  return d;
}

// Checks of several numbers together; only where each alone is valid.
void check_together(IfoTree& t, Detector const& d) {
  double const g = (1 - d.arm_length / d.input.curvature) * (1 - d.arm_length / d.end.curvature);
  if (std::isnan(g) || std::isnan(d.wavelength)) return;
  if (!(g > 1e-9 && g < 1 - 1e-9)) {
    t.problem("Optics.Curvature.ITM", fmt::format("the arm cavity is not stable: g1 g2 = {:.4g}", g),
              "choose curvatures and length with 0 < (1 - L/R1)(1 - L/R2) < 1");
    return;
  }
  Detector::Spots const w = d.spots();
  if (double const widest = std::max(w.input, w.end); d.mirror_radius <= widest)
    t.problem(
        "Materials.MassRadius",
        fmt::format("the mirrors, 'Materials.MassRadius' {:g} m, are smaller than the beam on them", d.mirror_radius),
        fmt::format("the radius of the beam is {:.3g} m at the {} mirrors (1/e^2 in power): write more, or choose "
                    "other curvatures",
                    widest, w.input > w.end ? "input" : "end"));
}

void check_squeezer(IfoTree& t, Squeezer const& q) {
  if (q.anti_decibels < q.decibels)
    t.problem("Squeezer.AntiAmplitudedB",
              fmt::format("'Squeezer.AntiAmplitudedB' is {:g}, less than the squeezing of {:g} dB", q.anti_decibels,
                          q.decibels),
              "write at least as many dB as Squeezer.AmplitudedB, or remove it");
}

void check_waves(IfoTree& t, Ground const& g) {
  if (g.rayleigh_speed >= g.s_speed || g.s_speed >= g.p_speed)
    t.problem("Seismic.RayleighWaveSpeed",
              fmt::format("the waves in the ground have speeds of {:g} (Rayleigh), {:g} (s) and {:g} m/s (p)",
                          g.rayleigh_speed, g.s_speed, g.p_speed),
              "Rayleigh waves are slower than s waves, and these slower than p waves");
}

void check_readout(IfoTree& t, Detector const& d) {
  if (!DualRecycled(dual_recycled(d)).sees_darm(probe_hz))
    t.problem(
        "Optics.Quadrature.dc",
        fmt::format("at 'Optics.Quadrature.dc' {:g} rad the read-out has no response to the arms", d.readout_angle),
        "write 1.5707963 (pi/2), where the signal of a tuned interferometer is");
}

std::vector<CurveFile> read_curves(IfoTree& t, std::filesystem::path const& folder) {
  std::vector<CurveFile> all;
  for (std::string const& place : t.elements("Curves")) {
    std::string const name = t.word(place + ".name"), file = t.word(place + ".file"),
                      kind = t.word(place + ".kind", "strain");
    if (name.empty() || file.empty())
      t.problem(place + (name.empty() ? ".file" : ".name"), "a curve needs a name and a file",
                "write '- {name: dark, file: dark.txt}'");
    if (std::any_of(all.begin(), all.end(), [&](CurveFile const& c) { return !name.empty() && c.name == name; }))
      t.problem(place + ".name", fmt::format("a second curve is named '{}'", name), "give each curve its own name");
    if (kind != "strain" && kind != "displacement")
      t.problem(place + ".kind", fmt::format("'{}' is not a kind of curve", kind), "write strain or displacement");
    all.push_back({name, (folder / file).string(), kind == "displacement"});
  }
  return all;
}

std::string named_preset(std::string const& name) {
  return std::string(embedded_file(std::string(preset_folder) + name + ".yaml"));
}

// Presets may extend others. Number of the first source that is not a preset.
std::size_t add_with_base(IfoTree& t, std::string const& source, std::string const& text, int depth) {
  IfoTree alone;
  alone.add(source, text);
  std::string const base = alone.word("extends");
  std::size_t before = 0;
  if (!base.empty()) {
    std::string const preset = named_preset(base);
    if (preset.empty() || depth > 4) {
      std::vector<std::string> const known = ifo_presets();
      alone.problem("extends", fmt::format("preset '{}' does not exist", base),
                    did_you_mean(base, known, fmt::format("write one of: {}", fmt::join(known, ", "))));
      alone.throw_if_problems();
    }
    before = add_with_base(t, base, preset, depth + 1) + 1;
  }
  t.add(source, text);
  return before;
}

}  // namespace

std::vector<std::string> ifo_presets() {
  std::vector<std::string> names;
  for (EmbeddedFile const& file : embedded_files())
    if (file.name.starts_with(preset_folder))
      names.emplace_back(file.name.substr(preset_folder.size(), file.name.size() - preset_folder.size() - 5));
  return names;
}

IfoFile read_ifo(std::string const& name, std::vector<std::string> const& overrides) {
  IfoTree t;
  std::string text = named_preset(name);
  bool const preset = !text.empty();
  std::filesystem::path const path(name);
  if (!preset) text = read_text(name);
  std::size_t own = add_with_base(t, preset ? name : path.filename().string(), text, 0);
  bool const extends = !preset && own > 0;
  for (std::string const& o : overrides) {
    std::size_t const equals = o.find('=');
    if (equals == o.npos || equals == 0)
      throw InputError(fmt::format("'{}' sets nothing", o), "write -p Laser.Power=25");
    t.set(o.substr(0, equals), o.substr(equals + 1));
  }
  t.throw_if_problems();
  IfoFile ifo;
  ifo.detector = read_detector(t);
  ifo.detector.name = preset ? name : path.stem().string();
  ifo.compare = t.word("compare");
  ifo.curves = read_curves(t, path.parent_path());
  check_together(t, ifo.detector);
  if (ifo.detector.squeezer) check_squeezer(t, *ifo.detector.squeezer);
  if (ifo.detector.ground) check_waves(t, *ifo.detector.ground);
  t.word("extends");
  if (auto const said = t.source_of("title"); said && *said >= own) ifo.title = t.word("title");
  if (extends || !overrides.empty()) t.report_unread(extends ? own : own + 1);
  t.throw_if_problems();
  check_readout(t, ifo.detector);
  t.throw_if_problems();
  ifo.yaml = t.yaml();
  return ifo;
}

namespace {

using hdf5::Reader;

[[noreturn]] void reject(std::string const& file, std::string const& path, std::string const& how) {
  throw InputError(fmt::format("'{}' is not a noise budget of pygwinc: '{}' {}", file, path, how),
                   "write it with gwinc --save FILE.hdf5, or give a two-column text file");
}

Reader opened(std::string const& bytes, std::string const& file) {
  try {
    return Reader(bytes);
  } catch (InputError const& e) {
    throw InputError(fmt::format("'{}': {}", file, e.reason()), "copy or make it again");
  }
}

// Of the file; empty where it has none.
std::string about(Reader const& in, std::string const& name) {
  return in.has_attribute("/", name) ? hdf5::text_in(in.object("/").attributes.at(name)).value_or("") : "";
}

struct Loader {
  std::string const& file;
  Reader const& in;
  std::size_t points;

  std::vector<double> psd(std::string const& path) const {
    if (!in.has(path)) reject(file, path, "is missing");
    std::vector<double> values = in.array<double>(path);
    if (values.size() != points)
      reject(file, path, fmt::format("has {} values for {} frequencies", values.size(), points));
    return values;
  }
  BudgetTrace version_2(std::string const& group, std::string const& name) const {
    BudgetTrace trace{name, name, psd(group + "/PSD"), {}};
    std::string const below = group + "/budget";
    if (in.has(below))
      for (std::string const& part : in.members(below)) trace.parts.push_back(version_2(below + "/" + part, part));
    return trace;
  }
  BudgetTrace version_1(std::string const& group, std::string const& name) const {
    BudgetTrace trace{name, name, psd(group + "/Total"), {}};
    for (std::string const& part : in.members(group)) {
      std::string const path = group + "/" + part;
      if (part == "Total") continue;
      if (in.is_group(path))
        trace.parts.push_back(version_1(path, part));
      else
        trace.parts.push_back({part, part, psd(path), {}});
    }
    return trace;
  }
};

BudgetFile read_opened(std::string const& file, Reader const& in) {
  if (!in.has("/Freq")) reject(file, "/Freq", "is missing");
  BudgetFile budget;
  budget.hz = in.array<double>("/Freq");
  for (std::size_t i = 0; i < budget.hz.size(); ++i)
    if (!(budget.hz[i] > (i > 0 ? budget.hz[i - 1] : 0))) reject(file, "/Freq", "does not increase from above 0");
  budget.ifo = about(in, "ifo");
  std::istringstream models(about(in, "models"));
  for (std::string model; models >> model;) budget.models.push_back(model);
  Loader const load{file, in, budget.hz.size()};
  if (in.has("/traces")) {
    budget.total = load.version_1("/traces", "Total");
    return budget;
  }
  std::vector<std::string> tops;
  for (std::string const& name : in.members("/"))
    if (in.is_group("/" + name)) tops.push_back(name);
  if (tops.size() != 1)
    reject(file, "/", fmt::format("holds {} groups, and the total must be the only one", tops.size()));
  budget.total = load.version_2("/" + tops.front(), tops.front());
  return budget;
}

}  // namespace

bool is_hdf5(std::string const& bytes) { return bytes.starts_with("\x89HDF"); }

bool is_budget_file(std::string const& bytes, std::string const& name) {
  return is_hdf5(bytes) && !opened(bytes, name).has_attribute("/", "file_type");
}

BudgetFile read_budget_file(std::string const& file) {
  std::string const bytes = read_file(file);
  if (!is_hdf5(bytes)) reject(file, "/", "is not HDF5");
  return read_opened(file, opened(bytes, file));
}

namespace {

std::string style(BudgetTrace const& trace) {
  YAML::Emitter out;
  out << YAML::Flow << YAML::BeginMap << YAML::Key << "label" << YAML::Value << YAML::DoubleQuoted << trace.label
      << YAML::EndMap;
  return out.c_str();
}

void write_trace(hdf5::Writer& out, std::string const& group, BudgetTrace const& trace) {
  out.group(group, trace.label);
  out.attribute(group, "style", style(trace));
  out.array(group + "/PSD", trace.psd, "1/Hz");
  if (trace.parts.empty()) return;
  out.group(group + "/budget", "the traces that add up to it");
  std::set<std::string> taken;
  for (BudgetTrace const& part : trace.parts) {
    std::string name = part.name;
    std::replace(name.begin(), name.end(), '/', ':');  // a slash would begin another group
    while (!taken.insert(name).second) name += "'";
    write_trace(out, group + "/budget/" + name, part);
  }
}

}  // namespace

std::string budget_file_bytes(BudgetFile const& budget, std::vector<std::pair<std::string, std::string>> const& about) {
  hdf5::Writer out;
  out.attribute("/", "SCHEMA", std::string("GWINC noise budget"));
  out.attribute("/", "SCHEMA_VERSION", std::vector<std::uint64_t>{2});
  out.attribute("/", "date", utc_now());
  if (!budget.ifo.empty()) out.attribute("/", "ifo", budget.ifo);
  if (!budget.models.empty()) out.attribute("/", "models", fmt::format("{}", fmt::join(budget.models, " ")));
  out.attribute("/", "plot_style", std::string("{ylabel: 'Strain [1/sqrt(Hz)]'}"));
  for (auto const& [name, value] : about) out.attribute("/", name, value);
  out.array("/Freq", budget.hz, "Hz");
  write_trace(out, "/" + budget.total.name, budget.total);
  return out.bytes();
}

}  // namespace straytrace::results
