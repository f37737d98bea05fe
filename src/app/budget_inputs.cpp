// SPDX-License-Identifier: BSD-3-Clause
#include "app/budget_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "base/message.hpp"
#include "base/quantity.hpp"
#include "base/table.hpp"
#include "noise/design.hpp"
#include "noise/fundamental/closed_forms.hpp"
#include "noise/fundamental/quantum.hpp"
#include "report/pygwinc_ifo.hpp"
#include "report/pygwinc_trace.hpp"
#include "report/report.hpp"
#include "signal/text_table.hpp"

namespace straytrace {
namespace {

// A curve of strain ASD that is read off where it is needed.
struct Sampled {
  std::vector<double> hz, asd, sigma;
  std::vector<double> on(std::vector<double> const& at, std::vector<double> const& values) const {
    std::vector<double> out;
    for (double const f : at) out.push_back(values.empty() ? not_a_number : read_off(hz, values, f));
    return out;
  }
};

struct Source {  // an entry, with its parts, before it is put on frequencies
  BudgetEntry entry;
  Sampled curve;
  std::vector<Source> parts;
  BudgetEntry on(std::vector<double> const& at) const {
    BudgetEntry e = entry;
    e.asd = curve.on(at, curve.asd);
    if (!curve.sigma.empty()) e.sigma = curve.on(at, curve.sigma);
    for (Source const& part : parts) e.parts.push_back(part.on(at));
    return e;
  }
};

std::string trimmed(std::string text) {
  text.erase(0, std::min(text.find_first_not_of(" \t"), text.size()));
  text.erase(text.find_last_not_of(" \t") + 1);
  return text;
}

double parse_margin(std::string const& text) {
  if (text.empty()) return 0.1;
  std::size_t const slash = text.find('/');
  char* end = nullptr;
  std::string const top = text.substr(0, slash), bottom = slash == text.npos ? "1" : text.substr(slash + 1);
  double const a = std::strtod(top.c_str(), &end);
  bool good = !top.empty() && *end == '\0';
  double const b = std::strtod(bottom.c_str(), &end);
  good = good && !bottom.empty() && *end == '\0';
  if (!good || !(a / b > 0 && a / b < 1e6))
    throw InputError(fmt::format("error: --margin: '{}' is not a positive ratio\n  write --margin 1/10", text));
  return a / b;
}

std::vector<double> grid_of(BudgetRequest const& r) {
  double low = 5, high = 5000;
  if (!r.band.empty()) {
    std::vector<double> const ends = parse_frequencies(r.band, "--band");
    if (ends.size() != 2 || !(ends[0] < ends[1]))
      throw InputError(fmt::format("error: --band: '{}' is not a band\n  write --band \"5 Hz, 5 kHz\"", r.band));
    low = ends[0], high = ends[1];
  }
  std::vector<double> hz;
  for (std::size_t i = 0; i < r.points; ++i) hz.push_back(low * std::pow(high / low, double(i) / double(r.points - 1)));
  return hz;
}

Sampled two_columns(std::string const& file, std::string const& what) {
  Curve const curve = parse_curve(read_file(file));
  if (!curve.error.empty())
    throw InputError(fmt::format("error: '{}' is not {}: {}\n  give two columns: frequency in Hz and amplitude density",
                                 file, what, curve.error));
  return {curve.hz, curve.value, {}};
}

Sampled sampled(std::vector<double> const& hz, BudgetTrace const& trace) {
  Sampled s{hz, {}, {}};
  for (double const p : trace.psd) s.asd.push_back(std::sqrt(p));
  return s;
}

Source source_of(std::vector<double> const& hz, BudgetTrace const& trace, bool stray) {
  bool const light = stray || trace.name.starts_with("StrayLight");
  Source s{
      {trace.name, trace.label, light ? BudgetEntry::Kind::stray_light : BudgetEntry::Kind::technical, {}, {}, "", {}},
      sampled(hz, trace),
      {}};
  for (BudgetTrace const& part : trace.parts) s.parts.push_back(source_of(hz, part, light));
  return s;
}

// Stray light of a run: total, and the routes that are resolved.
Source stray_light(std::string const& file, std::string const& name) {
  RunFile const run = read_run(file);
  if (!run.noise)
    throw InputError(
        fmt::format("error: '{}' holds no noise, only couplings\n  give a run with ports, made with "
                    "straytrace run or straytrace noise -o",
                    file));
  NoiseBudget const& b = *run.noise;
  std::vector<double> hz;
  for (std::size_t i = 0; i < b.grid.size(); ++i) hz.push_back(b.grid.centre(i));
  Source s{{name, "stray light: " + run.about.title, BudgetEntry::Kind::stray_light, {}, {}, "", {}},
           {hz, b.total.asd, b.total.sigma},
           {}};
  if (!b.unresolved.empty())
    s.entry.note = fmt::format("a lower bound, {} route{} not resolved", b.unresolved.size(),
                               b.unresolved.size() == 1 ? " is" : "s are");
  for (NoiseTrace const& route : b.routes)
    if (route.resolved)
      s.parts.push_back(
          {{route.name, route.name, BudgetEntry::Kind::stray_light, {}, {}, "", {}}, {hz, route.asd, route.sigma}, {}});
  return s;
}

ReferenceCurve reference_curve(std::string const& name, std::vector<double> const& at) {
  ReferenceCurve curve{name, {}};
  std::span<std::string const> const known = built_in_designs();
  if (std::find(known.begin(), known.end(), name) != known.end()) {
    for (double const f : at) curve.asd.push_back(design_asd(name, f));
    return curve;
  }
  if (!std::filesystem::exists(name)) {
    std::string const near = nearest_word(name, known);
    throw InputError(fmt::format("error: --compare: '{}' is neither a design curve nor a file\n  {}", name,
                                 near.empty() ? fmt::format("write one of: {}", fmt::join(known, ", "))
                                              : fmt::format("did you mean '{}'?", near)));
  }
  curve.name = std::filesystem::path(name).filename().string();
  if (is_budget_file(read_file(name))) {
    BudgetFile const file = read_budget_file(name);
    Sampled const s = sampled(file.hz, file.total);
    curve.asd = s.on(at, s.asd);
  } else {
    Sampled const s = two_columns(name, "a design curve");
    curve.asd = s.on(at, s.asd);
  }
  return curve;
}

struct Gathered {
  std::optional<IfoFile> ifo;
  std::vector<Source> sources;
};

enum class InputKind { detector, run, budget };
InputKind kind_of(std::string const& file) {
  std::string const bytes = read_file(file);
  if (is_budget_file(bytes)) return InputKind::budget;
  return bytes.starts_with("straytrace-run") || bytes.starts_with("\x89HDF") ? InputKind::run : InputKind::detector;
}

// Every noise of a budget is an entry; one that has no parts is an entry itself.
void add_budget_file(std::string const& name, std::vector<Source>& to) {
  BudgetFile const file = read_budget_file(name);
  for (BudgetTrace const& part : file.total.parts) to.push_back(source_of(file.hz, part, false));
  if (file.total.parts.empty()) to.push_back(source_of(file.hz, file.total, false));
}

Gathered read_inputs(BudgetRequest const& r) {
  Gathered g;
  std::vector<std::string> const presets = ifo_presets();
  std::size_t runs = 0;
  for (std::string const& name : r.inputs) {
    bool const preset = std::find(presets.begin(), presets.end(), name) != presets.end();
    if (!preset && !std::filesystem::is_regular_file(name)) {
      std::string const near = nearest_word(name, presets);
      throw InputError(fmt::format("error: '{}' is neither a detector nor a file\n  {}", name,
                                   near.empty() ? fmt::format("detectors: {}", fmt::join(presets, ", "))
                                                : fmt::format("did you mean '{}'?", near)));
    }
    if (InputKind const kind = preset ? InputKind::detector : kind_of(name); kind == InputKind::budget) {
      add_budget_file(name, g.sources);
      continue;
    } else if (kind == InputKind::run) {
      g.sources.push_back(stray_light(name, ++runs == 1 ? "StrayLight" : fmt::format("StrayLight{}", runs)));
      continue;
    }
    if (g.ifo)
      throw InputError(
          fmt::format("error: '{}' is a second detector\n  name one detector, and any number of runs", name));
    g.ifo = read_ifo(name, r.overrides);
  }
  if (!g.ifo && !r.overrides.empty())
    throw InputError(
        "error: -p changes a detector, and none is named\n  name one, for example: straytrace budget aligo");
  return g;
}

void add_lines(BudgetOn& b, Detector const& d) {
  std::vector<double> shot = shot_psd(d, b.table.hz), limit;
  for (double& x : shot) x = std::sqrt(x);
  for (double const f : b.table.hz) {
    limit.push_back(closed_forms::quantum_limit(d.arm_length, d.mirror_mass, f));
    b.metres.push_back(1 / std::sqrt(d.strain_per_length_squared(f)));
  }
  b.lines = {{"shot noise alone", shot}, {"quantum limit", limit}};
  if (std::vector<double> line = thermal_requirement(b.table); !line.empty())
    b.lines.push_back({"LIGO requirement", std::move(line)});
}

BudgetOn put_on(Gathered const& g, std::vector<std::string> const& compare, std::vector<double> const& hz,
                std::vector<std::string>* left_out) {
  BudgetOn b;
  b.table.hz = hz;
  if (g.ifo) {
    FundamentalEntries all = fundamental_entries(g.ifo->detector, hz);
    b.table.entries = std::move(all.entries);
    if (left_out) *left_out = all.left_out;
    for (CurveFile const& c : g.ifo->curves) {
      Sampled const s = two_columns(c.file, fmt::format("the curve '{}'", c.name));
      BudgetEntry e{c.name,
                    "from " + std::filesystem::path(c.file).filename().string(),
                    BudgetEntry::Kind::technical,
                    s.on(hz, s.asd),
                    {},
                    "",
                    {}};
      for (std::size_t i = 0; c.displacement && i < hz.size(); ++i)
        e.asd[i] *= std::sqrt(g.ifo->detector.strain_per_length_squared(hz[i]));
      auto const same = std::find_if(b.table.entries.begin(), b.table.entries.end(),
                                     [&](BudgetEntry const& o) { return o.name == c.name; });
      if (same == b.table.entries.end()) {
        b.table.entries.push_back(e);
      } else {
        e.kind = BudgetEntry::Kind::fundamental;
        *same = e;
      }
      if (left_out) std::erase_if(*left_out, [&](std::string const& l) { return l.starts_with(c.name + " "); });
    }
  }
  for (Source const& s : g.sources) b.table.entries.push_back(s.on(hz));
  for (std::string const& name : compare) b.curves.push_back(reference_curve(name, hz));
  if (g.ifo) add_lines(b, g.ifo->detector);
  return b;
}

}  // namespace

std::vector<double> parse_frequencies(std::string const& list, char const* option) {
  std::vector<double> all;
  for (std::size_t begin = 0; begin <= list.size();) {
    std::size_t const comma = std::min(list.find(',', begin), list.size());
    std::string const item = trimmed(list.substr(begin, comma - begin));
    begin = comma + 1;
    char* end = nullptr;
    double const value = std::strtod(item.c_str(), &end);
    auto const unit = parse_unit(trimmed(end));
    if (end == item.c_str() || !unit || !(unit->dimension == dim::frequency) || !(value > 0) || !std::isfinite(value))
      throw InputError(
          fmt::format("error: {}: '{}' is not a frequency\n  write {} \"10 Hz, 1 kHz\"", option, item, option));
    all.push_back(to_si(value, *unit));
  }
  return all;
}

BudgetView gather_budget(BudgetRequest const& r) {
  BudgetView v;
  v.margin = parse_margin(r.margin);
  std::vector<double> at = parse_frequencies(r.at, "--at"), hz = grid_of(r);
  Gathered const g = read_inputs(r);
  if (r.band.empty() && !g.sources.empty()) hz = g.sources.front().curve.hz;
  std::vector<std::string> compare = r.compare;
  if (compare.empty() && g.ifo && !g.ifo->compare.empty()) compare = {g.ifo->compare};
  for (std::string const& name : r.inputs) v.inputs.push_back(std::filesystem::path(name).filename().string());
  v.title = fmt::format("noise budget of {}", fmt::join(v.inputs, ", "));
  v.grid = put_on(g, compare, hz, nullptr);
  v.at = put_on(g, compare, at, &v.left_out);
  if (g.ifo) v.ifo_yaml = g.ifo->yaml;
  if (g.ifo) return v;
  v.warnings.push_back("no detector is named, so there are no fundamental noises; name one, for example 'aligo'");
  return v;
}

}  // namespace straytrace
