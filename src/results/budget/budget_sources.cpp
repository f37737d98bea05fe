// SPDX-License-Identifier: BSD-3-Clause
#include "results/budget/budget_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/errors.hpp"
#include "base/files/text_file.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "results/curves/band.hpp"
#include "results/pygwinc/pygwinc_trace.hpp"
#include "results/results.hpp"
#include "spectra/curve.hpp"

namespace straytrace::results {
namespace {

namespace fs = std::filesystem;

Sampled sampled(std::vector<double> const& hz, BudgetTrace const& trace) {
  Sampled s{hz, {}, {}};
  for (double const p : trace.psd) s.asd.push_back(std::sqrt(p));
  return s;
}

NoiseSource source_of(std::vector<double> const& hz, BudgetTrace const& trace, bool stray) {
  bool const light = stray || trace.name.starts_with("StrayLight");
  BudgetEntry entry{
      trace.name, trace.label, light ? BudgetEntry::Kind::stray_light : BudgetEntry::Kind::technical, {}, {}, "", {}};
  NoiseSource s{std::move(entry), sampled(hz, trace), {}, {}, {}, {}};
  for (BudgetTrace const& part : trace.parts) s.parts.push_back(source_of(hz, part, light));
  return s;
}

// The folders above a file and its name; a run file in a folder of its own is named by the folder.
std::vector<std::string> places(std::string const& file) {
  std::error_code ignored;
  fs::path const whole = fs::weakly_canonical(fs::absolute(file), ignored);
  std::vector<std::string> all;
  for (fs::path const& part : whole.parent_path()) all.push_back(part.string());
  if (whole.filename() != "run.h5" && whole.filename() != "budget.hdf5") all.push_back(whole.stem().string());
  return all;
}

std::string last_of(std::vector<std::string> const& places, std::size_t count) {
  std::size_t const first = places.size() - std::min(count, places.size());
  return fmt::format("{}", fmt::join(places.begin() + std::ptrdiff_t(first), places.end(), "-"));
}

// As few folders as distinguish all files.
std::vector<std::string> tags(std::vector<std::string> const& files) {
  for (std::size_t count = 1; count < 64; ++count) {
    std::vector<std::string> all;
    for (std::string const& file : files) all.push_back(last_of(places(file), count));
    if (std::set<std::string>(all.begin(), all.end()).size() == all.size()) return all;
  }
  return files;
}

// Sources that share a text get the tag of their file through `add`.
template <class Text, class Add>
void distinguish(std::vector<NoiseSource>& sources, Text const& text, Add const& add) {
  std::set<std::string> seen;
  for (NoiseSource const& first : sources) {
    std::string const shared = text(first);
    if (!seen.insert(shared).second) continue;
    std::vector<NoiseSource*> same;
    std::vector<std::string> files;
    for (NoiseSource& s : sources)
      if (text(s) == shared) same.push_back(&s), files.push_back(s.file);
    if (same.size() < 2) continue;
    std::vector<std::string> const tag = tags(files);
    for (std::size_t i = 0; i < same.size(); ++i) add(*same[i], tag[i]);
  }
}

// Equal but for rounding, and not zero everywhere.
bool same_curve(Sampled const& a, Sampled const& b) {
  constexpr double rounding = 1e-9;
  auto const near = [](double x, double y) {
    return std::isnan(x) || std::isnan(y) ? std::isnan(x) == std::isnan(y)
                                          : std::fabs(x - y) <= rounding * std::fabs(x);
  };
  return a.hz.size() == b.hz.size() && std::any_of(a.asd.begin(), a.asd.end(), [](double x) { return x > 0; }) &&
         std::equal(a.hz.begin(), a.hz.end(), b.hz.begin(), near) &&
         std::equal(a.asd.begin(), a.asd.end(), b.asd.begin(), near);
}

// Light of one scene, for any seed, motion or ports: the model hash depends on none of them.
bool same_scene(NoiseSource const& a, NoiseSource const& b) {
  return std::any_of(a.models.begin(), a.models.end(), [&](std::string const& model) {
    return std::find(b.models.begin(), b.models.end(), model) != b.models.end();
  });
}

bool is_fundamental(std::string const& name) {
  auto const all = fundamental_noises();
  return std::any_of(all.begin(), all.end(), [&](FundamentalNoise const& n) { return n.name == name; });
}

}  // namespace

bool holds_fundamental(NoiseSource const& s) { return is_fundamental(s.entry.name); }

std::vector<double> Sampled::on(std::vector<double> const& at, std::vector<double> const& values) const {
  constexpr double rounding = 1e-9;
  std::vector<double> out;
  for (double const f : at) {
    bool const inside = f >= low * (1 - rounding) && f <= high * (1 + rounding);
    double const held = inside && !hz.empty() ? std::clamp(f, hz.front(), hz.back()) : f;
    bool const of_bins = inside && bins.size() > 0 && !values.empty();
    out.push_back(of_bins ? band_at(values, bins, held) : values.empty() ? not_a_number : log_log_at(hz, values, held));
  }
  return out;
}

BudgetEntry NoiseSource::on(std::vector<double> const& at) const {
  BudgetEntry e = entry;
  e.asd = curve.on(at, curve.asd);
  if (!curve.sigma.empty()) e.sigma = curve.on(at, curve.sigma);
  for (BudgetBandColumn const& c : budget_band_columns)
    if (!(bands.*c.curve).empty()) e.bands.*c.curve = curve.on(at, bands.*c.curve);
  for (NoiseSource const& part : parts) e.parts.push_back(part.on(at));
  for (double const f : at) {
    std::size_t const bin = curve.bins.bin_of(f);
    e.at_most.push_back(bin < bound_bins.size() && bound_bins[bin]);
  }
  return e;
}

Sampled two_columns(std::string const& file, std::string const& what, std::span<std::string_view const> names) {
  Curve const curve = read_named_curve(
      file, names, fmt::format("{} consists of two columns: frequency in Hz and amplitude density", what));
  return {curve.hz, curve.value, {}};
}

Sampled total_of_budget_file(std::string const& file) {
  BudgetFile const budget = read_budget_file(file);
  return sampled(budget.hz, budget.total);
}

InputKind kind_of_input(std::string const& file) {
  std::string const bytes = read_file(file), end = fs::path(file).extension().string();
  if (bytes.starts_with("straytrace-run")) return InputKind::run;
  if (is_hdf5(bytes)) return is_budget_file(bytes, file) ? InputKind::budget : InputKind::run;
  if (end == ".h5" || end == ".hdf5" || bytes.find('\0') != bytes.npos)
    throw InputError(fmt::format("'{}' is damaged or not an HDF5 file: its first bytes are wrong", file),
                     "copy it again or recreate it; detectors are YAML files");
  return InputKind::detector;
}

namespace {

void add_borders_of_lines(std::vector<double>& borders, NoiseTrace const& curve, FrequencyGrid const& grid) {
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (BinLine const line = line_at(curve, grid, grid.centre(i)); !std::isnan(line.rms.value))
      borders.insert(borders.end(), {line.low, line.high});
}

}  // namespace

NoiseSource stray_light(std::string const& file) {
  RunFile const run = read_run(file);
  if (!run.noise)
    throw InputError(fmt::format("'{}' contains no noise, only couplings", file),
                     "give a run with ports, made with straytrace run or straytrace noise -o");
  NoiseBudget const& b = *run.noise;
  std::vector<double> hz;
  for (std::size_t i = 0; i < b.grid.size(); ++i) hz.push_back(b.grid.centre(i));
  fs::path const path(file);
  RunAbout about{file,
                 "StrayLight",
                 (path.parent_path().filename() / path.filename()).string(),
                 run.about.title,
                 run.about.model_hash,
                 run.about.provenance.created,
                 data_hash(file),
                 run.trace.coupling.seed,
                 run.trace.total.histories};
  std::string const title = about.title.empty() ? about.file : about.title;
  BudgetEntry entry{about.entry, title, BudgetEntry::Kind::stray_light, {}, {}, "", {}};
  entry.incomplete = !b.unresolved.empty();
  std::vector<bool> bound;
  for (std::size_t i = 0; i < b.grid.size(); ++i) bound.push_back(at_most(b.total, i));
  bool const upper = std::count(bound.begin(), bound.end(), true) > 0;
  if (entry.incomplete)
    entry.note = fmt::format("{}, {} route{} not resolved",
                             upper ? "no bound: it contains upper bounds (kind edge)" : "a lower bound",
                             b.unresolved.size(), b.unresolved.size() == 1 ? " is" : "s are");
  else if (upper)
    entry.note = "an upper bound where routes of kind edge contribute";
  std::vector<std::string> models{about.model_hash};
  double const low = b.grid.edges.front(), high = b.grid.edges.back();
  NoiseSource s{std::move(entry), {hz, b.total.asd, b.total.sigma, low, high, b.grid}, {}, file, std::move(about),
                std::move(models)};
  s.bands = {b.bands.input_low, b.bands.input_high, b.bands.speckle_05, b.bands.speckle_50, b.bands.speckle_95};
  s.bound_bins = std::move(bound);
  s.entry.inputs_stated = !b.bands.sources.empty();
  for (std::string const& warning : b.warnings) s.warnings.push_back(fmt::format("'{}': {}", file, warning));
  add_borders_of_lines(s.borders, b.total, b.grid);
  for (NoiseTrace const& route : b.routes)
    if (route.resolved) add_borders_of_lines(s.borders, route, b.grid);
  for (NoiseTrace const& route : b.routes)
    if (route.resolved)
      s.parts.push_back({{route.name, route.name, BudgetEntry::Kind::stray_light, {}, {}, "", {}},
                         {hz, route.asd, route.sigma, low, high, b.grid},
                         {},
                         {},
                         {},
                         {},
                         {route.input_low, route.input_high, {}, {}, {}},
                         {},
                         std::vector<bool>(b.grid.size(), route.upper_bound)});
  return s;
}

// One without parts is an entry itself.
std::vector<NoiseSource> noises_of_budget(std::string const& name) {
  BudgetFile const file = read_budget_file(name);
  std::vector<NoiseSource> all;
  for (BudgetTrace const& part : file.total.parts) all.push_back(source_of(file.hz, part, false));
  if (file.total.parts.empty()) all.push_back(source_of(file.hz, file.total, false));
  for (NoiseSource& s : all) {
    s.file = name;
    if (s.entry.kind == BudgetEntry::Kind::stray_light) s.models = file.models;
  }
  return all;
}

std::vector<InputError> repeats(std::vector<NoiseSource> const& all, std::vector<std::string> const& fundamental,
                                std::string const& detector) {
  std::vector<InputError> said;
  std::set<std::pair<std::string, std::string>> pairs;
  auto const say = [&](std::string const& a, std::string const& b, std::string const& name, char const* remedy) {
    if (pairs.insert({a, b}).second)
      said.emplace_back(
          fmt::format("'{}' and '{}' contain the same noise, '{}': the sum would count it twice", a, b, name), remedy);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    NoiseSource const& s = all[i];
    if (std::find(fundamental.begin(), fundamental.end(), s.entry.name) != fundamental.end())
      say(detector, s.file, s.entry.name, "omit the detector, or give the file with --compare");
    for (std::size_t k = 0; k < i; ++k) {
      bool const equal_name = all[k].entry.name == s.entry.name && is_fundamental(s.entry.name);
      bool const equal_run = !s.run.content.empty() && all[k].run.content == s.run.content;
      if (all[k].file != s.file && (equal_name || equal_run || same_curve(all[k].curve, s.curve)))
        say(all[k].file, s.file, s.entry.name, "name each input once; give other budgets with --compare");
      else if (all[k].file != s.file && same_scene(all[k], s) && pairs.insert({all[k].file, s.file}).second)
        said.emplace_back(
            fmt::format("'{}' and '{}' contain the stray light of one scene (model {}): the sum would count it twice",
                        all[k].file, s.file, s.models.front().substr(0, 12)),
            "pick one, or give the other with --compare");
    }
  }
  return said;
}

void name_apart(std::vector<NoiseSource>& sources) {
  distinguish(
      sources, [](NoiseSource const& s) { return s.entry.words; },
      [](NoiseSource& s, std::string const& tag) { s.entry.words += fmt::format(" ({})", tag); });
  distinguish(
      sources, [](NoiseSource const& s) { return s.entry.name; },
      [](NoiseSource& s, std::string const& tag) { s.entry.name += "-" + tag; });
  for (NoiseSource& s : sources) {
    if (s.run.entry.empty()) continue;
    s.run.entry = s.entry.name;
    s.entry.words = "stray light: " + s.entry.words;
  }
}

}  // namespace straytrace::results
