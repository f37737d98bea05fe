// SPDX-License-Identifier: BSD-3-Clause
#include "session/optimise/optimise.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "results/text/picture.hpp"
#include "scene/model_tree.hpp"
#include "scene/scope.hpp"
#include "session/interrupt.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t most_combinations = 64, most_finalists = 3;
constexpr int fresh_rounds = 2;            // each with four times the histories of the one before
constexpr std::uint64_t fresh_factor = 4;  // the first: relative to the search

// Values of the listed parameters, for every combination; ranges keep those of `start`.
std::vector<std::vector<double>> combinations_of(OptimiseOrder const& order, std::vector<double> const& start) {
  std::vector<std::vector<double>> all{start};
  for (std::size_t i = 0; i < order.vary.size(); ++i) {
    if (!order.vary[i].listed()) continue;
    std::vector<std::vector<double>> next;
    for (auto const& before : all)
      for (std::size_t k = 0; k < order.vary[i].values.size(); ++k) {
        next.push_back(before);
        next.back()[i] = double(k);
      }
    all = std::move(next);
    if (all.size() > most_combinations)
      throw InputError(fmt::format("more than {} combinations of listed values", most_combinations),
                       "list fewer values, or vary a number over a range");
  }
  return all;
}

class Optimisation {
 public:
  Optimisation(OptimiseOptions const& options, OptimiseReport& report, InterruptGuard const& guard)
      : options_(options), report_(report), guard_(guard), evaluator_(options, report.order) {}

  void run() {
    std::vector<double> const start = evaluator_.own_values();
    auto const combinations = combinations_of(report_.order, start);
    evaluator_.check(combinations.front());
    for (auto const& values : combinations) {
      if (stopped_) break;
      search_from(values, 0);
    }
    if (options_.pareto && !stopped_)
      for (double const allowance : {-1.5, -1.0, -0.5, 0.5, 1.0, 1.5})
        for (auto const& values : combinations)
          if (!stopped_) search_from(values, allowance * std::log(2.0));
    report_.outcomes = evaluator_.outcomes();
    report_.line = evaluator_.line();
    if (!stopped_) decide();
    report_.complete = !stopped_;
  }

 private:
  // One search over the ranges; listed values stay. `allowance`: of the logarithm of h over its limits.
  void search_from(std::vector<double> const& values, double allowance) {
    std::vector<std::size_t> free;
    SearchProblem problem;
    for (std::size_t i = 0; i < values.size(); ++i) {
      VariedParameter const& p = report_.order.vary[i];
      if (p.listed()) continue;
      free.push_back(i);
      problem.ranges.push_back({p.low, p.high, p.whole});
      problem.start.push_back(values[i]);
    }
    auto const all = [&](std::vector<double> const& x) {
      std::vector<double> full = values;
      for (std::size_t k = 0; k < free.size(); ++k) full[free[k]] = x[k];
      return full;
    };
    problem.tolerance = options_.tolerance;
    problem.most = options_.most;
    if (!report_.order.least_noise()) problem.price = [&](auto const& x) { return evaluator_.price(all(x)); };
    while (evaluator_.histories(problem.levels) <= options_.most_histories) ++problem.levels;
    problem.evaluate = [&](std::vector<double> const& x, int level) -> std::optional<Candidate> {
      auto const number = guard_.stop() ? std::nullopt : evaluator_.evaluate(all(x), level);
      if (!number) return {};
      return candidate(*number, x, allowance);
    };
    SearchResult const result = search(problem);
    stopped_ = result.stopped;
    report_.ended.push_back(result.ended);
    if (Candidate const* const best = result.best(); best && allowance == 0) {
      auto& found = report_.multipliers[best->number] = result.multipliers;
      if (report_.order.least_noise())
        for (WithError& m : found) m = m.over(std::exp(-best->objective));
    }
  }

  Candidate candidate(std::size_t number, std::vector<double> const& x, double allowance) const {
    Outcome const& o = evaluator_.outcome(number);
    Candidate c{x, o.objective, o.excess, 0, number};
    if (report_.order.least_noise()) c.objective = std::log(o.objective);
    for (std::size_t k = report_.order.relations.size(); k < c.excess.size(); ++k) c.excess[k] -= allowance;
    if (LineVerdict const* const v = o.deciding()) {
      c.sigma = v->ratio.sigma / v->ratio.value;
      c.deviations = v->deviations;
    }
    if (report_.order.least_noise() && !o.limits.empty()) c.objective_deviations = o.limits.back().deviations;
    c.excess_deviations.resize(report_.order.relations.size());
    for (LineVerdict const& v : o.limits) c.excess_deviations.push_back(v.deviations);
    return c;
  }

  // The best candidates with fresh seeds, until one meets the limits; of the least noise the best of them.
  void decide() {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < report_.outcomes.size(); ++i)
      if (report_.outcomes[i].traced) order.push_back(i);
    auto const before = [&](std::size_t a, std::size_t b) { return better(candidate(a, {}, 0), candidate(b, {}, 0)); };
    std::ranges::stable_sort(order, before);
    if (!order.empty()) report_.closest = order.front();
    for (std::size_t const number : order) {
      Outcome const& searched = report_.outcomes[number];
      bool const enough = report_.chosen && !report_.order.least_noise();
      if (enough || !searched.met() || report_.finalists.size() == most_finalists) break;
      report_.finalists.push_back(final_of(number));
      if (stopped_) return;
      Finalist const& last = report_.finalists.back();
      bool const best = !report_.chosen || last.fresh.objective < report_.finalists[*report_.chosen].fresh.objective;
      if (last.verdict == Finalist::Verdict::met && best) report_.chosen = report_.finalists.size() - 1;
    }
  }

  Finalist final_of(std::size_t number) {
    Finalist f;
    f.number = number;
    Outcome const& searched = report_.outcomes[number];
    std::uint64_t const seed = report_.seed + 1 + report_.finalists.size();
    std::uint64_t histories = searched.point.histories;
    for (int round = 0; round < fresh_rounds && f.verdict == Finalist::Verdict::undecided; ++round) {
      histories *= fresh_factor;
      if (!options_.quiet)
        std::cerr << fmt::format("optimise  fresh seed {}, {} histories: {}\n", seed, histories,
                                 fmt::join(searched.settings, ", "));
      f.fresh = evaluator_.traced_anew(searched, seed, histories);
      stopped_ = !f.fresh.point.complete;
      if (stopped_) return f;
      f.verdict = verdict_of(f.fresh);
    }
    return f;
  }

  // Decided by two standard errors.
  static Finalist::Verdict verdict_of(Outcome const& o) {
    constexpr double sure = 2;
    if (o.met()) return Finalist::Verdict::met;
    for (LineVerdict const& v : o.limits)
      if (v.excess > 0 && v.ratio.value - sure * v.ratio.sigma > 1) return Finalist::Verdict::missed;
    return Finalist::Verdict::undecided;
  }

  OptimiseOptions const& options_;
  OptimiseReport& report_;
  InterruptGuard const& guard_;
  Evaluator evaluator_;
  bool stopped_ = false;
};

// The scene with the settings on the command line and those of a candidate.
std::string scene_of_best(OptimiseOptions const& options, Outcome const& best) {
  std::string const scene = std::filesystem::relative(options.input, options.out).generic_string();
  std::string const text = fmt::format("straytrace: 1\ninclude: [{}]\n", yaml_text(scene));
  std::string params, places;
  std::vector<std::string> settings = options.overrides;
  settings.insert(settings.end(), best.settings.begin(), best.settings.end());
  for (std::string const& s : settings) {
    std::size_t const equal = s.find('=');
    (scene::names_place(s) ? places : params) +=
        fmt::format("  {}: {}\n", yaml_text(s.substr(0, equal)), yaml_text(s.substr(equal + 1)));
  }
  return text + (params.empty() ? "" : "params:\n  override: true\n" + params) +
         (places.empty() ? "" : "set:\n" + places);
}

void save(OptimiseOptions const& options, OptimiseReport const& report) {
  std::string const json = options.out + "/optimise.json";
  std::vector<std::pair<std::string, std::string>> files{{options.out + "/candidates.csv", optimise_csv(report)},
                                                         {json, optimise_json(report)},
                                                         {options.out + "/optimise.txt", optimise_text(report)}};
  if (report.chosen) {
    Finalist const& best = report.finalists[*report.chosen];
    files.emplace_back(options.out + "/best.yaml", scene_of_best(options, best.fresh));
    std::string const run = run_name(best.fresh.point.model_hash, report.seed + 1 + *report.chosen);
    std::filesystem::create_directories(options.out + "/best");
    std::filesystem::copy_file(fmt::format("{}/runs/{}.h5", options.out, run), options.out + "/best/run.h5",
                               std::filesystem::copy_options::overwrite_existing);
  }
  write_files(files);
  std::string message;
  bool const drawn = draw_from_json("optimise", json, options.out + "/optimise.png", message);
  if (!drawn && !options.quiet) std::cerr << "warning: optimise.png was not drawn: " << message << '\n';
  Picture const picture{"png", drawn ? read_file(options.out + "/optimise.png") : ""};
  write_file(options.out + "/optimise.html", optimise_page(report, picture));
}

// The answer to another question stays, unless --force overwrites it.
void refuse_other_question(OptimiseOptions const& options, OptimiseReport const& report) {
  std::string const file = options.out + "/optimise.json";
  if (options.force || !std::filesystem::exists(file)) return;
  nlohmann::json earlier;
  try {
    earlier = read_json(read_file(file));
  } catch (nlohmann::json::parse_error const&) {  // not written by this program: another question
  }
  nlohmann::json const own = read_json(optimise_json(report));
  for (char const* key : {"model", "minimise", "vary", "limits"})
    if (!earlier.is_object() || earlier.value(key, nlohmann::json()) != own[key])
      throw InputError(
          fmt::format("'{}' contains the answer to another question ('{}'); nothing was traced", options.out, key),
          "choose another folder with -o, or overwrite it with --force, which keeps its traces");
}

}  // namespace

bool OptimiseReport::on_front(std::size_t outcome) const {
  auto const ratio = [](Outcome const& o) { return o.deciding() ? o.deciding()->ratio.value : not_a_number; };
  Outcome const& own = outcomes.at(outcome);
  if (!own.traced || order.least_noise() || std::isnan(ratio(own))) return false;
  return std::ranges::none_of(outcomes, [&](Outcome const& o) {
    bool const no_worse = o.objective <= own.objective && ratio(o) <= ratio(own);
    return o.traced && no_worse && (o.objective < own.objective || ratio(o) < ratio(own));
  });
}

int optimise(OptimiseOptions const& options) {
  OptimiseReport report;
  report.model = std::filesystem::path(options.input).filename().string();
  {
    Scene const scene = read_scene(options.input, options.overrides);
    report.order = read_order(scene, options.words);
    report.seed = options.seed.value_or(scene.table("trace") ? scene.table("trace").whole("seed", 1, 0, 9e15) : 1);
  }
  if (options.pareto && (report.order.least_noise() || report.order.limits.empty()))
    throw InputError("--pareto needs a cost to minimise and a limit of h_total", "write --subject 'h_total < line'");
  refuse_other_question(options, report);
  OutputFolder const folder(options.out + "/runs");
  FolderLock const lock(options.out);
  InterruptGuard const guard;
  Optimisation(options, report, guard).run();
  save(options, report);
  std::cout << (options.json() ? optimise_json(report) : optimise_text(report));
  if (!report.complete) {
    std::cerr << how_to_go_on;
    return checkpointed;
  }
  return report.chosen ? done : unmet;
}

}  // namespace straytrace::session
