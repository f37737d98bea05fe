// SPDX-License-Identifier: BSD-3-Clause
#include "app/scan_points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "app/other_detector.hpp"
#include "app/tell.hpp"
#include "base/message.hpp"
#include "noise/design.hpp"
#include "noise/fundamental/budget.hpp"
#include "report/band.hpp"
#include "signal/text_table.hpp"

namespace straytrace {

namespace {

// A built-in curve by its name, or a file of this machine.
DesignCurve curve_named(std::string const& name, FrequencyGrid const& grid) {
  DesignCurve curve{name, {}};
  std::vector<std::string> const known(built_in_designs().begin(), built_in_designs().end());
  if (std::find(known.begin(), known.end(), name) != known.end()) {
    for (std::size_t i = 0; i < grid.size(); ++i) curve.asd.push_back(design_asd(name, grid.centre(i)));
    return curve;
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(name, ignored)) {
    std::string const near = nearest_word(name, known);
    throw InputError(fmt::format(
        "error: --against: '{}' is neither a design curve nor a file\n  {}", name,
        near.empty() ? fmt::format("known: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", near)));
  }
  Curve const table = parse_named_curve(read_file(name), strain_columns);
  if (!table.error.empty())
    throw InputError(
        fmt::format("error: --against: '{}' is not a design curve: {}\n  give two columns: frequency in Hz, "
                    "strain in 1/sqrt(Hz)",
                    name, table.error));
  for (std::size_t i = 0; i < grid.size(); ++i) curve.asd.push_back(read_off(table.hz, table.value, grid.centre(i)));
  return curve;
}

}  // namespace

void apply(Requirement const& requirement, Model& model) {
  if (requirement.margin) model.noise.margin = *requirement.margin;
  if (requirement.against.empty()) return;
  model.design = {curve_named(requirement.against, model.noise.grid)};
  if (!model.detector) return;
  if (auto const other = other_detector(requirement.against, *model.detector)) {
    model.warnings += fmt::format("warning: --against: {}\n  {}\n", other->what, other->suggestion);
    Problem const warning{{}, other->what, other->suggestion, Severity::warning};
    model.warnings_json += problems_as_json(InputError({warning}, ""));
  }
}

std::string name_of_line(Model const& model) {
  return model.design.empty() ? "" : fmt::format("{:.3g} x {}", model.noise.margin, model.design.front().name);
}

std::vector<double> line_of(Model const& model) {
  std::vector<double> line(model.noise.grid.size(), not_a_number);
  for (std::size_t i = 0; i < line.size() && !model.design.empty(); ++i)
    line[i] = model.noise.margin * model.design.front().asd[i];
  return line;
}

void judge(ScanPoint& point, NoiseBudget const& b, std::vector<double> const& line) {
  point.unresolved = b.unresolved;
  for (std::size_t i = 0; i < line.size(); ++i) {
    double const ratio = b.total.asd[i] / line[i];
    if (!(line[i] > 0) || std::isnan(ratio) || !(std::isnan(point.ratio.value) || ratio > point.ratio.value)) continue;
    point.ratio = {ratio, b.total.sigma[i] / line[i], at_most(b.total, i)};
    point.worst_hz = b.grid.centre(i);
  }
}

std::string run_name(std::string const& model_hash, std::uint64_t seed) {
  return fmt::format("{}-{}", model_hash.substr(0, 16), seed);
}

Scanner::Scanner(Options options, Requirement requirement, std::string folder)
    : options_(std::move(options)), requirement_(std::move(requirement)), folder_(std::move(folder)) {}

std::shared_ptr<CouplingTable const> Scanner::trace_of(Model& model, ScanPoint& point) {
  std::string const name = run_name(point.model_hash, model.seed);
  if (auto const known = traced_.find(name); known != traced_.end()) {
    point.from = ScanPoint::From::shared;
    return known->second;
  }
  std::string const file = folder_.empty() ? "" : fmt::format("{}/runs/{}.h5", folder_, name);
  std::uint64_t before = 0;
  if (auto const stored = file.empty() ? std::nullopt : earlier_run(file, point.model_hash, model.seed, options_.force))
    before = stored->trace.coupling.histories;
  TraceResult result = trace_model(model, options_, file);
  point.complete = !result.checkpointed();
  bool const unchanged = result.coupling.histories == before;
  point.from = unchanged && !made_.contains(name) ? ScanPoint::From::stored : ScanPoint::From::traced;
  if (!file.empty() && !unchanged) write_run(file, content_of(model, result, nullptr));
  auto const coupling = std::make_shared<CouplingTable const>(std::move(result.coupling));
  if (point.complete) traced_.emplace(name, coupling);
  return coupling;
}

ScanPoint Scanner::at(std::vector<std::string> const& settings) {
  ScanPoint point;
  point.settings = settings;
  std::vector<std::string> overrides = options_.overrides;
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  Model model;
  try {
    model = read_model(options_.input, overrides);
    apply(options_, model);
    apply(requirement_, model);
  } catch (InputError const& e) {
    throw InputError(fmt::format("{}\nat the point {}", e.what(), fmt::join(settings, ", ")));
  }
  if (!model.detector)
    throw InputError("error: a scan looks at noise, and the scene has no 'interferometer'\n  add one, and 'ports'");
  if (model.warnings != told_) tell_warnings(model, options_);
  told_ = model.warnings;
  point.model_hash = model.hash();
  auto const coupling = trace_of(model, point);
  point.histories = coupling->histories;
  NoiseBudget const budget = model.project(*coupling);
  tell_warnings(budget, options_, fmt::format("{}", fmt::join(settings, ", ")));
  point.warnings = budget.warnings;
  for (double const hz : frequencies) point.strain.push_back(strain_at(budget.total, budget.grid, hz));
  judge(point, budget, line_of(model));
  line_ = name_of_line(model);
  return point;
}

}  // namespace straytrace
