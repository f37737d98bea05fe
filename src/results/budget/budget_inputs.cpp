// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "base/errors.hpp"
#include "base/input/table.hpp"
#include "noise/fundamental/design.hpp"
#include "noise/fundamental/fundamental.hpp"
#include "results/budget/budget_sources.hpp"
#include "results/budget/budget_view.hpp"
#include "results/pygwinc/pygwinc_ifo.hpp"
#include "results/pygwinc/pygwinc_trace.hpp"
#include "results/results.hpp"
#include "spectra/curve.hpp"

namespace straytrace::results {
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
