// SPDX-License-Identifier: BSD-3-Clause
#include "session/optimise/evaluator.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "base/errors.hpp"
#include "noise/fundamental/design.hpp"
#include "scene/model_tree.hpp"
#include "scene/scope.hpp"

namespace straytrace::session {
namespace {

std::vector<std::string> with(std::vector<std::string> overrides, std::vector<std::string> const& settings) {
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  return overrides;
}

// Seven digits: what is printed is what is traced.
std::string setting_of(VariedParameter const& p, double value) {
  if (p.listed()) return fmt::format("{}={}", p.name, p.values.at(std::size_t(value)));
  double const rounded = std::strtod(fmt::format("{:.7g}", std::clamp(value, p.low, p.high)).c_str(), nullptr);
  return fmt::format("{}={}", p.name, si_text(Value{{rounded, p.dimension, {}}, false}));
}

// ASD per bin, NaN outside the band.
std::vector<double> limit_line(NoiseLimit const& limit, ProjectionModel const& model) {
  FrequencyGrid const& grid = model.noise.grid;
  std::vector<double> line(grid.size(), not_a_number);
  std::vector<double> const own = line_of(model);
  auto const design = std::ranges::find(model.design, limit.curve, &DesignCurve::name);
  for (std::size_t i = 0; i < line.size(); ++i) {
    double const hz = grid.centre(i);
    if (hz < limit.low_hz || hz > limit.high_hz) continue;
    line[i] = limit.factor * (limit.curve == "line"          ? own[i]
                              : design != model.design.end() ? design->asd[i]
                                                             : design_asd(limit.curve, hz));
  }
  return line;
}

}  // namespace

double Outcome::worst() const {
  double largest = -infinity;
  for (double const e : excess) largest = std::isnan(e) ? infinity : std::max(largest, e);
  return largest;
}

LineVerdict const* Outcome::deciding() const {
  auto const largest = std::ranges::max_element(limits, {}, &LineVerdict::excess);
  return largest == limits.end() ? nullptr : &*largest;
}

Evaluator::Evaluator(ScanOptions options, OptimiseOrder const& order)
    : options_(std::move(options)), order_(order), scanner_(options_, {}, options_.out) {}

std::vector<std::string> Evaluator::settings_of(std::vector<double> const& values) const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < values.size(); ++i) out.push_back(setting_of(order_.vary[i], values[i]));
  return out;
}

std::vector<double> Evaluator::own_values() const {
  Scene const scene = read_scene(options_.input, options_.overrides);
  scene::Scope const* const scope = scene.root().scope().get();
  std::vector<double> out;
  for (VariedParameter const& p : order_.vary) {
    auto const own = scene::find_parameter(scope, p.name).value;
    bool const usable = !p.listed() && own && (own->quantity.dimension == p.dimension || own->bare_zero);
    double const value = usable ? std::clamp(own->quantity.si, p.low, p.high) : p.listed() ? 0 : 0.5 * (p.low + p.high);
    out.push_back(p.whole ? std::round(value) : value);
  }
  return out;
}

void Evaluator::check(std::vector<double> const& start) const {
  Model const model = scanner_.model_at(settings_of(start));
  std::vector<InputError> errors;
  auto const nowhere = [](std::vector<double> const& line) {
    return std::ranges::none_of(line, [](double asd) { return asd > 0; });
  };
  for (NoiseLimit const& limit : order_.limits)
    if (nowhere(limit_line(limit, model)))
      errors.emplace_back(fmt::format("'{}': the curve has no value in this band", limit.text),
                          "name a curve under 'compare' in 'noise', and a band inside that of the noise");
  if (order_.least_noise() && nowhere(line_of(model)))
    errors.emplace_back("h_total is minimised relative to a line, but there is none",
                        "name a curve under 'compare' in 'noise'");
  throw_all(errors);
}

Evaluator::Known Evaluator::known(std::vector<std::string> const& settings) const {
  if (auto const found = known_.find(settings); found != known_.end()) return found->second;
  Known out;
  std::map<std::string, double> prices;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    VariedParameter const& p = order_.vary[i];
    if (p.price.empty()) continue;
    auto const at = std::ranges::find(p.values, settings[i].substr(p.name.size() + 1)) - p.values.begin();
    prices[p.name] = p.price.at(std::size_t(at));
  }
  try {
    Scene const scene = read_scene(options_.input, with(options_.overrides, settings));
    SceneValues const values(scene, prices);
    for (Relation const& r : order_.relations) out.excess.push_back(values.excess(r));
    if (!order_.least_noise())
      if (auto const price = values.value(order_.minimise)) out.price = price->quantity.si;
    scene.throw_if_problems();
  } catch (InputError const&) {  // no scene here: as far from its limits as can be
    out = {not_a_number, std::vector<double>(order_.relations.size(), not_a_number)};
  } catch (scene::ExpressionProblem const&) {
    out = {not_a_number, std::vector<double>(order_.relations.size(), not_a_number)};
  }
  return known_.emplace(settings, out).first->second;
}

double Evaluator::price(std::vector<double> const& values) const { return known(settings_of(values)).price; }

void Evaluator::judge(Outcome& out, Model const& model, NoiseBudget const& budget) const {
  for (NoiseLimit const& limit : order_.limits) {
    out.limits.push_back(compared(budget, limit_line(limit, model), limit.confidence));
    out.excess.push_back(out.limits.back().excess);
  }
  if (!order_.least_noise()) return;
  out.limits.push_back(compared(budget, line_of(model), 0.5));
  out.objective = out.limits.back().ratio.value;
}

void Evaluator::measure(Outcome& out, Scanner& scanner) const {
  out.point = scanner.at(out.settings, [&](Model const& model, CouplingTable const&, NoiseBudget const& budget) {
    judge(out, model, budget);
  });
  out.traced = true;
}

std::optional<std::size_t> Evaluator::evaluate(std::vector<double> const& values) {
  std::vector<std::string> const settings = settings_of(values);
  if (auto const found = numbers_.find(settings); found != numbers_.end()) return found->second;
  Known const before = known(settings);
  Outcome out;
  out.settings = settings;
  out.objective = before.price;
  out.excess = before.excess;
  bool const impossible = !order_.least_noise() && std::isnan(before.price);
  if (!impossible && !(out.worst() > 0)) {
    if (!options_.quiet)
      std::cerr << fmt::format("optimise  candidate {}: {}\n", outcomes_.size() + 1, fmt::join(settings, ", "));
    try {
      measure(out, scanner_);
    } catch (InputError const&) {
      if (outcomes_.empty()) throw;
      out.objective = not_a_number;
    }
    if (out.traced && !out.point.complete) return {};
    line_ = scanner_.line();
  }
  out.excess.resize(order_.relations.size() + order_.limits.size(), not_a_number);
  outcomes_.push_back(std::move(out));
  return numbers_.emplace(settings, outcomes_.size() - 1).first->second;
}

Outcome Evaluator::traced_anew(Outcome const& known, std::uint64_t seed, std::uint64_t histories) const {
  ScanOptions options = options_;
  options.seed = seed;
  options.histories = histories;
  options.until.clear();
  Scanner scanner(options, {}, options.out);
  Outcome out;
  out.settings = known.settings;
  out.objective = known.objective;
  out.excess.assign(known.excess.begin(), known.excess.begin() + std::ptrdiff_t(order_.relations.size()));
  measure(out, scanner);
  return out;
}

}  // namespace straytrace::session
