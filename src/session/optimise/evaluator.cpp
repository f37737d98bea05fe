// SPDX-License-Identifier: BSD-3-Clause
#include "session/optimise/evaluator.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>

#include "base/errors.hpp"
#include "base/math/distributions.hpp"
#include "base/math/rng.hpp"
#include "base/math/samples.hpp"
#include "base/text/words.hpp"
#include "noise/fundamental/budget.hpp"
#include "results/curves/band.hpp"
#include "scene/model_tree.hpp"
#include "scene/scope.hpp"
#include "session/decide/what_if.hpp"
#include "world/model/world.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t multipliers = 10000;
constexpr std::uint64_t multiplier_seed = 20;
constexpr double tenfold = 10;  // as of routes that are too faint to be told (noise.hpp)

// Constants, of no run: independent of its seed.
std::vector<double> const& gaussian_multipliers() {
  static std::vector<double> const all = [] {
    std::vector<double> out;
    for (std::uint64_t m = 0; m < multipliers; ++m) {
      Rng rng(multiplier_seed, m, 0, Stream::static_phase);
      for (int r = 0; r < replica_count; ++r) out.push_back(normal_quantile(rng.uniform()));
    }
    return out;
  }();
  return all;
}

// Deviations of each bin over the root of the sum of their squares, [bin][replica]; bins without error are left out.
std::vector<std::vector<double>> studentised(std::vector<std::vector<double>> const& deviations) {
  std::vector<std::vector<double>> out;
  std::size_t const bins = deviations.empty() ? 0 : deviations.front().size();
  for (std::size_t i = 0; i < bins; ++i) {
    std::vector<double> own;
    double square = 0;
    for (auto const& of_replica : deviations) {
      own.push_back(of_replica[i]);
      square += of_replica[i] * of_replica[i];
    }
    if (!(square > 0) || !std::isfinite(square)) continue;
    for (double& d : own) d /= std::sqrt(square);
    out.push_back(std::move(own));
  }
  return out;
}

}  // namespace

double factor_of_all(std::vector<std::vector<double>> const& deviations, double confidence) {
  auto const bins = studentised(deviations);
  double factor = normal_quantile(confidence);
  if (bins.size() > 1) {
    std::vector<double> const& g = gaussian_multipliers();
    std::vector<double> largest;
    for (std::size_t m = 0; m < multipliers; ++m) {
      double worst = -infinity;
      for (auto const& own : bins) {
        double sum = 0;
        for (std::size_t r = 0; r < own.size(); ++r) sum += g[m * replica_count + r] * own[r];
        worst = std::max(worst, sum);
      }
      largest.push_back(worst);
    }
    std::sort(largest.begin(), largest.end());
    factor = nearest_rank(largest, confidence);
  }
  if (deviations.size() < 2) return factor;
  return student_quantile(double(deviations.size() - 1), normal_cdf(factor));  // the errors are estimates themselves
}

LineVerdict compared(NoiseBudget const& budget, std::vector<double> const& line, double confidence) {
  std::vector<std::size_t> bins;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (line[i] > 0 && std::isfinite(line[i])) bins.push_back(i);
  LineVerdict out;
  if (bins.empty()) return out;
  std::vector<std::vector<double>> chosen;
  for (auto const& of_replica : deviations(budget.total)) {
    chosen.emplace_back();
    for (std::size_t const i : bins) chosen.back().push_back(of_replica[i]);
  }
  out.factor = factor_of_all(chosen, confidence);
  std::optional<std::size_t> decides;
  double const unresolved = 0.5 * std::log1p((tenfold - 1) * budget.unresolved_hint);
  for (std::size_t const i : bins) {
    double const h = budget.total.asd[i], sigma = budget.total.sigma[i];
    double const excess = std::log(std::max((h + out.factor * sigma) / line[i], 1e-300)) + unresolved;
    if (std::isnan(h) || !(std::isnan(out.excess) || excess > out.excess)) continue;
    out.excess = excess;
    decides = i;
    out.hz = budget.grid.centre(i);
    out.ratio = {h / line[i], sigma / line[i], results::at_most(budget.total, i), !budget.unresolved.empty()};
  }
  if (decides)
    for (auto const& of_replica : deviations(budget.total))
      out.deviations.push_back(of_replica[*decides] / budget.total.asd[*decides]);
  return out;
}

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

std::map<std::string, double> areas_of(Model const& model) {
  World const& world = model.world;
  std::vector<double> const areas = group_areas(world.view(), world.groups().size());
  std::map<std::string, double> all;
  for (std::size_t i = 0; i < areas.size(); ++i) all[entry_of(world.groups()[i])] += areas[i];
  return all;
}

// Errors of the groups are added linearly: the same histories make them. Nothing seen is no limit met.
LineVerdict compared(std::vector<ObjectRow> const& objects, PowerLimit const& limit, double beam_power) {
  WithError watts;
  bool seen = false;
  for (ObjectRow const& row : objects) {
    if (!matches(limit.entry, entry_of(row.name)) || !row.arriving) continue;
    seen = seen || row.arriving->scored > 0;
    watts.value += beam_power * row.arriving->mean;
    watts.sigma += beam_power * row.arriving->std_error;
  }
  LineVerdict out;
  if (!seen) return out;
  std::vector<std::vector<double>> const one_bin(replica_count, {1 / std::sqrt(double(replica_count))});
  out.factor = factor_of_all(one_bin, limit.confidence);
  out.ratio = watts.over(limit.watts);
  out.excess = std::log((watts.value + out.factor * watts.sigma) / limit.watts);
  return out;
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
    : options_(std::move(options)),
      order_(order),
      scanner_(options_, {}, options_.out),
      first_histories_(scanner_.model_at({}).histories) {}

Scanner& Evaluator::scanner(int level) {
  if (level == 0) return scanner_;
  if (auto const found = finer_.find(level); found != finer_.end()) return found->second;
  ScanOptions more = options_;
  more.histories = histories(level);
  more.until.clear();
  std::string const folder = fmt::format("{}/runs/{}", options_.out, more.histories.value());
  std::filesystem::create_directories(folder + "/runs");
  return finer_.emplace(level, Scanner(more, {}, folder)).first->second;
}

std::vector<std::string> Evaluator::settings_of(std::vector<double> const& values) const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < values.size(); ++i) out.push_back(setting_of(order_.vary[i], values[i]));
  return out;
}

std::vector<double> Evaluator::own_values() const {
  Model const model = scanner_.model_at({});
  scene::Scope const* const scope = model.scene.root().scope().get();
  std::vector<SceneValue> const values = scene_values(model.scene);
  std::vector<double> out;
  for (VariedParameter const& p : order_.vary) {
    auto const parameter = scene::find_parameter(scope, p.name).value;
    std::optional<Quantity> own = parameter ? std::optional(parameter->quantity) : std::nullopt;
    for (SceneValue const& value : values)
      if (value.place == p.name) own = value.quantity;
    bool const usable = !p.listed() && own && (own->dimension == p.dimension || own->si == 0);
    double const value = usable ? std::clamp(own->si, p.low, p.high) : p.listed() ? 0 : 0.5 * (p.low + p.high);
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
  if (!order_.powers.empty() && !(model.world.beam_power > 0))
    errors.emplace_back(fmt::format("'{}': no beam of the scene states its power", order_.powers.front().text),
                        "give the beam a power, as in 'beams: {arm: {..., power: 300 kW}}'");
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
    SceneValues const values(scene, prices, [&] { return areas_of(scanner_.model_at(settings)); });
    for (Relation const& r : order_.relations) out.excess.push_back(values.excess(r));
    if (!order_.least_noise())
      if (auto const price = values.value(order_.minimise)) out.price = price->quantity.si;
    scene.throw_if_problems();
  } catch (InputError const& e) {  // no scene here: as far from its limits as can be
    out = {not_a_number, std::vector<double>(order_.relations.size(), not_a_number), e.reason()};
  } catch (scene::ExpressionProblem const& p) {
    out = {not_a_number, std::vector<double>(order_.relations.size(), not_a_number), p.what};
  }
  return known_.emplace(settings, out).first->second;
}

double Evaluator::price(std::vector<double> const& values) const { return known(settings_of(values)).price; }

void Evaluator::judge(Outcome& out, Model const& model, TracedLight const& light, NoiseBudget const& budget) const {
  for (NoiseLimit const& limit : order_.limits) {
    out.limits.push_back(compared(budget, limit_line(limit, model), limit.confidence));
    out.excess.push_back(out.limits.back().excess);
  }
  for (PowerLimit const& limit : order_.powers) {
    out.limits.push_back(compared(light.objects, limit, model.world.beam_power));
    out.excess.push_back(out.limits.back().excess);
  }
  if (!order_.least_noise()) return;
  out.limits.push_back(compared(budget, line_of(model), 0.5));
  out.objective = out.limits.back().ratio.value;
}

void Evaluator::measure(Outcome& out, Scanner& scanner) const {
  out.point = scanner.at(out.settings, [&](Model const& model, TracedLight const& light, NoiseBudget const& budget) {
    judge(out, model, light, budget);
  });
  out.traced = true;
}

std::optional<std::size_t> Evaluator::evaluate(std::vector<double> const& values, int level) {
  std::vector<std::string> const settings = settings_of(values);
  if (auto const found = numbers_.find({level, settings}); found != numbers_.end()) return found->second;
  Known const before = known(settings);
  Outcome out;
  out.settings = settings;
  out.objective = before.price;
  out.excess = before.excess;
  out.problem = before.problem;
  bool const impossible = !order_.least_noise() && std::isnan(before.price);
  if (!impossible && !(out.worst() > 0)) {
    if (!options_.quiet)
      std::cerr << fmt::format("optimise  candidate {}: {}\n", outcomes_.size() + 1, fmt::join(settings, ", "));
    try {
      measure(out, scanner(level));
    } catch (InputError const& e) {
      if (outcomes_.empty()) throw;
      out.objective = not_a_number;
      out.problem = e.reason();
    }
    if (out.traced && !out.point.complete) return {};
    line_ = scanner(level).line();
  }
  out.excess.resize(order_.relations.size() + order_.limit_texts().size(), not_a_number);
  outcomes_.push_back(std::move(out));
  return numbers_.emplace(std::pair(level, settings), outcomes_.size() - 1).first->second;
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
