// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/table.hpp"
#include "noise/fundamental/budget.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "results/budget/budget_view.hpp"
#include "results/curves/band.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"
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

// `upper`: some bins are upper bounds.
std::string note_of_bounds(std::size_t unresolved, bool upper) {
  if (unresolved > 0)
    return fmt::format("{}, {} route{} not resolved",
                       upper ? "no bound: it contains upper bounds (kind edge)" : "a lower bound", unresolved,
                       unresolved == 1 ? " is" : "s are");
  return upper ? "an upper bound where routes of kind edge contribute" : "";
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
  entry.note = note_of_bounds(b.unresolved.size(), upper);
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

namespace {

// Points on either side of the borders of bins that hold a line, so that interpolation does not spread it into other
// bins.
std::vector<double> with_borders_of_lines(std::vector<double> hz, std::vector<NoiseSource> const& sources) {
  constexpr double distance = 1e-5;  // of the frequency
  double const low = hz.front(), high = hz.back();
  for (NoiseSource const& s : sources)
    for (double const border : s.borders)
      for (double const f : {border * (1 - distance), border * (1 + distance)})
        if (f > low && f < high) hz.push_back(f);
  std::sort(hz.begin(), hz.end());
  hz.erase(std::unique(hz.begin(), hz.end()), hz.end());
  return hz;
}

// Frequencies of curves and picture.
std::vector<double> grid_of(std::vector<double> band, std::size_t points, std::vector<NoiseSource> const& sources) {
  Sampled const* const first = sources.empty() ? nullptr : &sources.front().curve;
  if (band.empty() && first && points == 0) return first->hz;
  if (band.empty() && first) band = {std::min(first->low, first->hz.front()), std::max(first->high, first->hz.back())};
  if (band.empty()) band = {5, 5000};
  if (points == 0) points = 300;
  std::vector<double> hz;
  for (std::size_t i = 0; i + 1 < points; ++i)
    hz.push_back(band[0] * std::pow(band[1] / band[0], double(i) / double(points - 1)));
  hz.push_back(band[1]);
  return hz;
}

DesignCurve reference_curve(std::string const& name, std::vector<double> const& at) {
  DesignCurve curve{name, {}};
  std::span<std::string const> const known = built_in_designs();
  if (std::find(known.begin(), known.end(), name) != known.end()) {
    for (double const f : at) curve.asd.push_back(design_asd(name, f));
    return curve;
  }
  if (!std::filesystem::exists(name)) {
    throw InputError(fmt::format("--compare: '{}' is neither a design curve nor a file", name),
                     did_you_mean(name, known, fmt::format("write one of: {}", fmt::join(known, ", "))));
  }
  curve.name = std::filesystem::path(name).filename().string();
  std::string const bytes = read_file(name);
  if (bytes.starts_with("straytrace-run") || (is_hdf5(bytes) && !is_budget_file(bytes, name))) {
    NoiseSource const run = stray_light(name);
    curve.name = run.run.file;
    curve.asd = run.curve.on(at, run.curve.asd);
    return curve;
  }
  Sampled const s = is_hdf5(bytes) ? total_of_budget_file(name) : two_columns(name, "a design curve", strain_columns);
  curve.asd = s.on(at, s.asd);
  return curve;
}

struct Gathered {
  std::optional<IfoFile> ifo;
  std::string detector;  // as it was named
  std::vector<NoiseSource> sources;
};

void add_input(std::string const& name, BudgetRequest const& r, Gathered& g) {
  std::vector<std::string> const presets = ifo_presets();
  bool const preset = std::find(presets.begin(), presets.end(), name) != presets.end();
  if (!preset && !std::filesystem::is_regular_file(name)) {
    throw InputError(fmt::format("'{}' is neither a detector nor a file", name),
                     did_you_mean(name, presets, fmt::format("detectors: {}", fmt::join(presets, ", "))));
  }
  if (InputKind const kind = preset ? InputKind::detector : kind_of_input(name); kind == InputKind::budget) {
    for (NoiseSource& s : noises_of_budget(name)) g.sources.push_back(std::move(s));
  } else if (kind == InputKind::run) {
    g.sources.push_back(stray_light(name));
  } else {
    if (!g.detector.empty())
      throw InputError(fmt::format("'{}' is a second detector", name), "name one detector, and any number of runs");
    g.detector = name;
    g.ifo = read_ifo(name, r.overrides);
  }
}

bool same_file(std::string const& a, std::string const& b) {
  std::error_code not_there;
  return std::filesystem::equivalent(a, b, not_there);
}

std::vector<std::string> brought_by(IfoFile const& ifo) {
  std::vector<std::string> names;
  for (FundamentalNoise const& noise : fundamental_noises())
    if (noise.known(ifo.detector)) names.emplace_back(noise.name);
  for (CurveFile const& c : ifo.curves) names.push_back(c.name);
  return names;
}

// All problems of all inputs at once.
Gathered read_inputs(BudgetRequest const& r) {
  Gathered g;
  std::vector<InputError> errors;
  for (std::size_t i = 0; i < r.inputs.size(); ++i) {
    auto const end = r.inputs.begin() + std::ptrdiff_t(i);
    if (std::any_of(r.inputs.begin(), end, [&](std::string const& o) { return same_file(o, r.inputs[i]); })) {
      errors.emplace_back(fmt::format("'{}' is given twice: the sum would count it twice", r.inputs[i]),
                          "name each input once");
      continue;
    }
    try {
      add_input(r.inputs[i], r, g);
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  }
  if (g.detector.empty() && !r.overrides.empty())
    errors.emplace_back("-p changes a detector, but none is named", "name one, for example: straytrace budget aligo");
  auto const twice = repeats(g.sources, g.ifo ? brought_by(*g.ifo) : std::vector<std::string>(), g.detector);
  errors.insert(errors.end(), twice.begin(), twice.end());
  throw_all(errors);
  name_apart(g.sources);
  return g;
}

void add_lines(BudgetOn& b, Detector const& d) {
  std::vector<double> limit;
  for (double const f : b.table.hz) {
    limit.push_back(quantum_limit(d.arm_length, d.mirror_mass, f));
    b.metres.push_back(1 / std::sqrt(d.strain_per_length_squared(f)));
  }
  // A filter cavity compensates ponderomotive rotation; with fixed mirrors its angle is wrong.
  if (!d.squeezer || d.squeezer->cavities.empty()) {
    std::vector<double> shot = shot_psd(d, b.table.hz);
    for (double& x : shot) x = std::sqrt(x);
    b.lines.push_back({"shot noise alone", std::move(shot)});
  }
  b.lines.push_back({"quantum limit", std::move(limit)});
  if (std::vector<double> line = thermal_requirement(b.table); !line.empty())
    b.lines.push_back({"LIGO requirement", std::move(line)});
}

// A curve named like a fundamental noise replaces it.
void add_curve(CurveFile const& c, Detector const& d, NoiseTable& table, std::vector<std::string>* left_out) {
  constexpr std::string_view metres[] = {"total_displacement"};
  using Names = std::span<std::string_view const>;
  Names const names = c.displacement ? Names(metres) : Names(strain_columns);
  Sampled const s = two_columns(c.file, fmt::format("the curve '{}'", c.name), names);
  BudgetEntry e{c.name,
                "from " + std::filesystem::path(c.file).filename().string(),
                BudgetEntry::Kind::technical,
                s.on(table.hz, s.asd),
                {},
                "",
                {}};
  for (std::size_t i = 0; c.displacement && i < table.hz.size(); ++i)
    e.asd[i] *= std::sqrt(d.strain_per_length_squared(table.hz[i]));
  auto const fundamental = fundamental_noises();
  if (std::any_of(fundamental.begin(), fundamental.end(), [&](FundamentalNoise const& n) { return n.name == c.name; }))
    e.kind = BudgetEntry::Kind::fundamental;
  auto const same =
      std::find_if(table.entries.begin(), table.entries.end(), [&](BudgetEntry const& o) { return o.name == c.name; });
  if (same == table.entries.end())
    table.entries.push_back(e);
  else
    *same = e;
  if (left_out) std::erase_if(*left_out, [&](std::string const& l) { return l.starts_with(c.name + " "); });
}

BudgetOn put_on(Gathered const& g, std::vector<std::string> const& compare, std::vector<double> const& hz,
                std::vector<std::string>* left_out) {
  BudgetOn b;
  b.table.hz = hz;
  if (g.ifo) {
    FundamentalEntries all = fundamental_entries(g.ifo->detector, hz);
    b.table.entries = std::move(all.entries);
    if (left_out) *left_out = all.left_out;
    for (CurveFile const& c : g.ifo->curves) add_curve(c, g.ifo->detector, b.table, left_out);
  }
  for (NoiseSource const& s : g.sources) b.table.entries.push_back(s.on(hz));
  for (std::string const& name : compare) b.curves.push_back(reference_curve(name, hz));
  if (g.ifo) add_lines(b, g.ifo->detector);
  return b;
}

}  // namespace

BudgetView gather_budget(BudgetRequest const& r) {
  BudgetView v;
  v.margin = r.margin;
  Gathered g = read_inputs(r);
  std::vector<double> const hz = with_borders_of_lines(grid_of(r.band, r.points, g.sources), g.sources);
  std::vector<std::string> compare = r.compare;
  if (compare.empty() && g.ifo && !g.ifo->compare.empty()) compare = {g.ifo->compare};
  std::vector<std::string> titles;
  for (std::string const& name : r.inputs) {
    v.inputs.push_back(std::filesystem::path(name).filename().string());
    bool const titled = g.ifo && name == g.detector && !g.ifo->title.empty();
    titles.push_back(titled ? g.ifo->title : v.inputs.back());
  }
  v.title = fmt::format("noise budget of {}", fmt::join(titles, ", "));
  for (NoiseSource const& s : g.sources) {
    if (!s.run.entry.empty()) v.runs.push_back(s.run);
    v.warnings.insert(v.warnings.end(), s.warnings.begin(), s.warnings.end());
    for (std::string const& model : s.models)
      if (std::find(v.models.begin(), v.models.end(), model) == v.models.end()) v.models.push_back(model);
  }
  v.grid = put_on(g, compare, hz, nullptr);
  v.at = put_on(g, compare, r.at, &v.left_out);
  v.detector = g.detector;
  v.ifo = std::move(g.ifo);
  if (v.ifo || std::any_of(g.sources.begin(), g.sources.end(), holds_fundamental)) return v;
  v.warnings.push_back("without a detector there are no fundamental noises; name one, for example 'aligo'");
  return v;
}

}  // namespace straytrace::results
