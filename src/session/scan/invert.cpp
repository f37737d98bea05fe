// SPDX-License-Identifier: BSD-3-Clause
#include "session/scan/invert.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "base/text/pattern.hpp"
#include "base/text/words.hpp"
#include "noise/bands/inversion.hpp"
#include "results/text/columns.hpp"
#include "session/interrupt.hpp"
#include "session/open_run.hpp"
#include "session/scan/scan_points.hpp"
#include "session/session.hpp"

namespace straytrace::session {
namespace {

// "brdf(steel)", "motion(tube)".
struct Question {
  std::string kind, name;
};

// Number of the material or body that the question names.
std::size_t subject_of(Question const& question, ProjectionModel const& model) {
  bool const scatter = question.kind == "brdf";
  std::vector<std::string> known = model.motion.bodies;
  if (scatter) {
    known.clear();
    for (MaterialSpread const& m : model.traced.materials) known.push_back(m.name);
  }
  auto const hit = std::find(known.begin(), known.end(), question.name);
  if (hit != known.end()) return std::size_t(hit - known.begin());
  throw InputError(
      fmt::format("--invert: {} '{}' does not exist", scatter ? "material that scatters" : "body", question.name),
      did_you_mean(question.name, known, fmt::format("known: {}", fmt::join(known, ", "))));
}

// Inputs of the inversion of one run.
struct Traced {
  std::unique_ptr<OpenRun> run;  // owns the texts that the model refers to
  ProjectionModel model;
  CouplingTable coupling;
  bool complete = true;
};

void refuse_without_line(ProjectionModel const& model) {
  if (!model.detector)
    throw InputError("a requirement needs noise, but the scene has no 'interferometer'", "add one, with 'ports'");
  if (model.design.empty())
    throw InputError("there is no line to compare with", "name a design curve, for example --against adv-lal");
}

// Rejects invalid requests before tracing, with all earlier errors of the command.
void ask(std::optional<Question> const& question, Requirement const& requirement, ProjectionModel& model,
         ScanOptions const& options, std::vector<InputError> errors) {
  std::size_t const earlier = errors.size();
  collect(errors, [&] { apply(requirement, model); });
  print_warnings(model, options);
  if (errors.size() == earlier) collect(errors, [&] { refuse_without_line(model); });
  if (question) collect(errors, [&] { subject_of(*question, model); });
  throw_all(errors);
}

Traced traced(std::optional<Question> const& question, ScanOptions const& options, Requirement const& requirement,
              std::vector<InputError> errors) {
  Traced t;
  Model model;
  bool const of_run = names_run(options.input);
  std::size_t const earlier = errors.size();
  collect(errors, [&] {
    if (of_run)
      t.run = std::make_unique<OpenRun>(options.input);
    else
      model = read_model(options.input, options.overrides);
  });
  if (errors.size() > earlier) throw_all(errors);
  if (of_run) {
    t.model = std::move(t.run->model);
    ask(question, requirement, t.model, options, std::move(errors));
    t.coupling = std::move(t.run->file.trace.coupling);
  } else {
    apply(options, model);
    ask(question, requirement, model, options, std::move(errors));
    std::string const run = options.out.empty() ? "" : options.out + "/run.h5";
    std::optional<OutputFolder> folder;
    if (!options.out.empty()) folder.emplace(options.out);
    TraceResult result = trace_model(model, options, run).result;
    t.complete = !result.checkpointed();
    if (!run.empty()) write_run(run, content_of(model, result, nullptr));
    t.coupling = std::move(result.coupling);
    t.model = std::move(model);
  }
  return t;
}

Answer scatter_answer(Traced const& t, std::size_t material, ScanOptions const& options) {
  ProjectionInputs const& known = t.model.traced;
  NoiseBudget const budget = t.model.project(t.coupling);
  print_warnings(budget, options);
  Composition const composition(t.coupling, {known.materials[material]}, t.model.motion, *t.model.detector,
                                t.model.noise);
  Answer a = answer_about(t.model, budget, invert_scatter(budget, composition, line_of(t.model)));
  a.tis = known.scattered[material];
  a.subject = Answer::Subject::scatter;
  return a;
}

Answer motion_answer(Traced const& t, std::size_t moved, ScanOptions const& options, bool every_bin) {
  BodyId const body{std::uint32_t(moved)};
  NoiseBudget const budget = t.model.project(t.coupling);
  print_warnings(budget, options);
  auto const at = [&](double scale) {
    return project_noise(t.coupling, with_scaled_body(t.model.motion, body, scale), *t.model.detector, t.model.noise)
        .total;
  };
  Answer a = answer_about(t.model, budget, invert_motion(at, line_of(t.model), every_bin));
  a.subject = Answer::Subject::motion;
  a.motion = root_spectrum(t.model.motion, body, t.model.noise.grid);
  return a;
}

void print(Answer const& a, ScanOptions const& options, bool per_frequency) {
  std::cout << (options.json() ? answer_json(a) : answer_text(a, per_frequency));
}

}  // namespace

int invert(ScanOptions const& options, Requirement const& requirement, InvertOrder const& order,
           std::vector<ScanAxis> const& axes, std::vector<InputError> errors) {
  static Pattern const form(R"(\s*(brdf|motion|param)\s*\(\s*(.+?)\s*\)\s*)");
  std::optional<Question> question;
  if (PatternMatch const m = form.match(order.what))
    question = {m[1], m[2]};
  else
    errors.emplace_back(fmt::format("--invert: '{}' is not valid", order.what),
                        "write \"brdf(MATERIAL)\", \"motion(BODY)\" or \"param(NAME)\" with NAME=lo..hi");
  bool const parameter = question && question->kind == "param";
  if (question && !parameter && !axes.empty())
    errors.emplace_back(fmt::format("--invert \"{}\" needs a single model", order.what), "set parameters with -p");
  if (parameter) {
    throw_all(errors);
    return invert_parameter(options, requirement, order, question->name, axes);
  }
  Traced const t = traced(question, options, requirement, std::move(errors));
  std::size_t const subject = subject_of(*question, t.model);
  Answer answer = question->kind == "brdf" ? scatter_answer(t, subject, options)
                                           : motion_answer(t, subject, options, order.per_frequency || options.json());
  answer.what = order.what;
  answer.complete = t.complete;
  print(answer, options, order.per_frequency);
  return t.complete ? done : checkpointed;
}

// --invert "param(NAME)" NAME=lo..hi: traces at both ends and halves the range as far as the errors allow.

namespace {

constexpr double sure = 2;  // standard errors

struct Probe {
  double number;
  ScanPoint point;
  bool meets() const { return point.unresolved.empty() && point.ratio.value + sure * point.ratio.sigma < 1; }
  bool fails() const { return point.ratio.value - sure * point.ratio.sigma > 1; }
};

class Search {
 public:
  Search(Scanner& scanner, ScanAxis const& axis, bool quiet, std::atomic<bool> const& stop)
      : scanner_(scanner), axis_(axis), quiet_(quiet), stop_(stop) {}

  // Of the models at both ends, before any trace.
  void check() const {
    for (double const number : {axis_.numbers.front(), axis_.numbers.back()})
      refuse_without_line(scanner_.model_at({axis_.name + "=" + value_of(number)}));
  }

  // None when stopped.
  std::optional<Probe> at(double number) {
    if (stop_) return {};
    std::string const value = value_of(number);
    if (!quiet_) std::cerr << fmt::format("scan  {} = {}\n", axis_.name, value);
    Probe p{number, scanner_.at({axis_.name + "=" + value})};
    if (!p.point.complete) return {};
    if (std::isnan(p.point.ratio.value))
      throw InputError(fmt::format("at {} = {} there is no result to compare: no route is resolved, or the line has no "
                                   "value in the band",
                                   axis_.name, value),
                       "give more --histories, or another line with --against");
    return p;
  }

 private:
  std::string value_of(double number) const {
    return axis_.unit.empty() ? fmt::format("{:.12g}", number) : fmt::format("{:.12g} {}", number, axis_.unit);
  }

  Scanner& scanner_;
  ScanAxis const& axis_;
  bool quiet_;
  std::atomic<bool> const& stop_;
};

std::string words(Probe const& p, std::string const& unit) {
  return fmt::format("{:.6g}{}{} (h/line {}{})", p.number, unit.empty() ? "" : " ", unit,
                     p.point.unresolved.empty() || p.point.ratio.at_most ? "" : "> ", with_error(p.point.ratio));
}

struct Bracket {
  Probe meets, fails;        // the nearest known ends
  std::vector<Probe> doubt;  // between them, from `meets` to `fails`, within two standard errors of the line
  bool stopped = false;
};

struct Gap {
  double from, to;
  double width() const { return std::fabs(to - from); }
};

// Beside the doubt, where an answer is still to be had; the wider one of both sides.
Gap widest(Bracket const& b) {
  if (b.doubt.empty()) return {b.meets.number, b.fails.number};
  Gap const near{b.meets.number, b.doubt.front().number}, far{b.doubt.back().number, b.fails.number};
  return near.width() > far.width() ? near : far;
}

void place(Bracket& b, Probe const& p, bool before_doubt) {
  if (!p.meets() && !p.fails()) {
    b.doubt.insert(before_doubt ? b.doubt.begin() : b.doubt.end(), p);
    return;
  }
  if (p.meets() != before_doubt) b.doubt.clear();  // it lies beyond them
  (p.meets() ? b.meets : b.fails) = p;
}

// The ratio between two probes lies between theirs, within errors.
void refuse_other_shapes(Bracket const& b, Probe const& p, ScanAxis const& axis) {
  auto const above = [](Probe const& x, Probe const& y) {  // x clearly above y
    return x.point.ratio.value - y.point.ratio.value > 3 * std::hypot(x.point.ratio.sigma, y.point.ratio.sigma);
  };
  if (!above(p, b.fails) && !above(b.meets, p)) return;
  throw InputError(fmt::format("h/line is not monotonic in '{}': {}, {} and {}", axis.name, words(b.meets, axis.unit),
                               words(p, axis.unit), words(b.fails, axis.unit)),
                   "scan the range first, and choose a monotonic part");
}

// Halves the unknown intervals; close to the line itself the errors leave a doubt that no halving removes.
void narrow(Bracket& b, Search& search, ScanAxis const& axis, double wanted) {
  for (Gap gap = widest(b); gap.width() > wanted; gap = widest(b)) {
    std::optional<Probe> const p = search.at(0.5 * (gap.from + gap.to));
    b.stopped = !p;
    if (b.stopped) return;
    refuse_other_shapes(b, *p, axis);
    place(b, *p, gap.from == b.meets.number);
  }
}

std::string text_of(Bracket const& b, ScanAxis const& axis, std::string const& what, std::string const& line) {
  std::string text = fmt::format("{}: the total stays under {} at {} and exceeds it at {}.\n", what, line,
                                 words(b.meets, axis.unit), words(b.fails, axis.unit));
  if (!b.doubt.empty())
    text += fmt::format("{}{} it is within two standard errors of the line: trace longer for a narrower answer.\n",
                        b.doubt.size() > 1 ? "Between, as at " : "At ", words(b.doubt[b.doubt.size() / 2], axis.unit));
  if (b.stopped) text += "Stopped before the requested width.\n";
  return text;
}

nlohmann::ordered_json json_of(Bracket const& b, ScanAxis const& axis) {
  return {{"verdict", "found"}, {"meets", b.meets.number}, {"exceeds", b.fails.number},
          {"unit", axis.unit},  {"complete", !b.stopped},  {"limited_by_errors", !b.doubt.empty()}};
}

int stopped_early(ScanOptions const& options) {
  std::cerr << (options.out.empty() ? no_way_to_go_on : how_to_go_on);
  return checkpointed;
}

}  // namespace

int invert_parameter(ScanOptions const& options, Requirement const& requirement, InvertOrder const& order,
                     std::string const& name, std::vector<ScanAxis> const& axes) {
  if (names_run(options.input))
    throw InputError(fmt::format("'{}' is a run, but --invert \"param({})\" traces a scene", options.input, name),
                     "name the scene file in place of the run");
  if (axes.size() != 1 || axes.front().name != name || !axes.front().range)
    throw InputError(fmt::format("--invert \"param({})\" needs one search range", name),
                     fmt::format("write {}=lo..hi", name));
  ScanAxis const& axis = axes.front();
  InterruptGuard const guard;
  Scanner scanner(options, requirement, options.out);
  Search search(scanner, axis, options.quiet, guard.stop());
  search.check();
  std::optional<OutputFolder> folder;
  if (!options.out.empty()) folder.emplace(options.out + "/runs");
  std::optional<Probe> const low = search.at(axis.numbers.front()),
                             high = low ? search.at(axis.numbers.back()) : std::nullopt;
  if (!high) return stopped_early(options);  // one end has no result
  std::string const ends = fmt::format("{} and {}", words(*low, axis.unit), words(*high, axis.unit));
  nlohmann::ordered_json answer;
  std::string text;
  bool stopped = false;
  if (low->meets() && high->meets()) {
    answer["verdict"] = "always";
    text = fmt::format("{}: both ends stay under {}: {}.\n", order.what, scanner.line(), ends);
  } else if (!low->meets() && !high->meets()) {
    answer["verdict"] = low->fails() && high->fails() ? "never" : "undecided";
    text = fmt::format("{}: neither end is known to stay under {}: {}.\n", order.what, scanner.line(), ends);
  } else if (!low->fails() && !high->fails()) {
    answer["verdict"] = "undecided";
    text = fmt::format("{}: neither end is known to exceed {}: {}. Trace longer.\n", order.what, scanner.line(), ends);
  } else {
    Bracket b{low->meets() ? *low : *high, low->meets() ? *high : *low, {}};
    narrow(b, search, axis, order.tolerance * std::fabs(high->number - low->number));
    answer = json_of(b, axis);
    text = text_of(b, axis, order.what, scanner.line());
    stopped = b.stopped;
  }
  nlohmann::ordered_json const j{{"question", order.what}, {"line", scanner.line()}, {"answer", answer}};
  std::cout << (options.json() ? json_text(j, 2) + "\n" : text);
  return stopped ? stopped_early(options) : done;
}

namespace {

using Json = nlohmann::ordered_json;
using Verdict = Allowed::Verdict;

std::string hertz(double hz) { return fmt::format("{:.3g} Hz", hz); }

char const* word_of(Verdict verdict) {
  constexpr char const* words[] = {"found", "always", "never", "not known", "no line"};
  return words[std::size_t(verdict)];
}

std::string subject_words(Answer const& a) {
  return a.subject == Answer::Subject::scatter ? "the BRDF of the material" : "the motion (ASD) of the body";
}

// The factor as physical quantities.
std::string in_numbers(Answer const& a) {
  Allowed const& all = a.inversion.all;
  if (a.subject == Answer::Subject::scatter && std::isfinite(a.tis)) {
    double const tis = all.scale * a.tis;
    std::string text = fmt::format("Scattered share at normal incidence: {:.3g} now, {} allowed.\n", a.tis,
                                   with_error(tis, all.sigma * a.tis));
    if (tis > 1) text += "That exceeds the incident light: scatter of this material alone cannot exceed the line.\n";
    return text;
  }
  if (a.subject == Answer::Subject::motion && a.motion[a.inversion.decides] > 0)
    return fmt::format("Motion of the body at {}: {:.3g} m/sqrt(Hz) now (root sum of x, y, z), {:.3g} allowed.\n",
                       hertz(a.grid.centre(a.inversion.decides)), a.motion[a.inversion.decides],
                       all.scale * a.motion[a.inversion.decides]);
  return "";
}

std::string sentence(Answer const& a) {
  Allowed const& all = a.inversion.all;
  std::string const at = hertz(a.grid.centre(a.inversion.decides));
  switch (all.verdict) {
    case Verdict::found:
      return fmt::format("{}: the total stays under {} up to {} times {} as traced; {} decides.\n", a.what, a.line,
                         with_error(all.scale, all.sigma), subject_words(a), at) +
             in_numbers(a);
    case Verdict::always:
      return fmt::format("{}: every factor tested stays under {}: it sets no limit.\n", a.what, a.line);
    case Verdict::never:
      return fmt::format("{}: no factor suffices: other light alone is a factor {:.3g} above {} at {}.\n", a.what,
                         all.rest, a.line, at);
    case Verdict::unknown:
      return fmt::format(
          "{}: not known. Routes without a name carry up to {:.3g} % of the noise power at a frequency, and it is not "
          "known how often their light scatters on the material. Raise 'route_vertices', or trace a run of an earlier "
          "version again.\n",
          a.what, 100 * a.inversion.mixed);
    default:
      return fmt::format("{}: {} has no value in the band: nothing was compared.\n", a.what, a.line);
  }
}

std::string table(Answer const& a) {
  Columns c;
  c.titles = {"frequency/Hz", "line", "largest factor"};
  if (!a.motion.empty()) c.titles.emplace_back("motion/(m/sqrt(Hz))");
  for (std::size_t i = 0; i < a.grid.size(); ++i) {
    Allowed const& one = a.inversion.bins[i];
    if (one.verdict == Verdict::no_answer) continue;
    bool const found = one.verdict == Verdict::found;
    c.rows.push_back({fmt::format("{:.4g}", a.grid.centre(i)), fmt::format("{:.3e}", a.line_asd[i]),
                      found ? with_brackets(one.scale, one.sigma) : word_of(one.verdict)});
    if (!a.motion.empty())
      c.rows.back().push_back(found && a.motion[i] > 0 ? fmt::format("{:.3e}", one.scale * a.motion[i]) : "-");
  }
  return "\n" + aligned(c) +
         "\nEach frequency separately. never: the rest is above the line; always: every factor meets it; "
         "not known: routes without a name carry too much of the noise.\n";
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json json_of(Allowed const& a) {
  return {{"verdict", word_of(a.verdict)},
          {"scale", finite_or_null(a.scale)},
          {"sigma", finite_or_null(a.sigma)},
          {"rest_over_line", finite_or_null(a.rest)}};
}

}  // namespace

Answer answer_about(ProjectionModel const& model, NoiseBudget const& budget, Inversion inversion) {
  Answer a;
  a.line = name_of_line(model);
  a.grid = model.noise.grid;
  a.line_asd = line_of(model);
  a.inversion = std::move(inversion);
  a.unresolved = budget.unresolved;
  return a;
}

std::vector<double> root_spectrum(MotionSet const& motion, BodyId body, FrequencyGrid const& grid) {
  std::vector<double> psd(grid.size());
  for (MotionInput const& input : motion.inputs)
    for (int axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < psd.size(); ++i) {
        double const low = grid.edges[i], high = grid.edges[i + 1], hz = input.tone_frequency;
        double const power = hz > 0 ? (hz >= low && hz < high ? 0.5 : 0) : input.spectrum.power(low, high);
        std::complex<double> gain = 0;  // gains of one input on one axis add before they are squared
        for (Gain const& g : input.gains)
          if (g.body == body && g.axis == axis)
            gain += g.value * (g.transfer && hz == 0 ? (*g.transfer)(grid.centre(i)) : 1.0);
        psd[i] += std::norm(gain) * power / (high - low);
      }
    }
  for (double& p : psd) p = std::sqrt(p);
  return psd;
}

std::string answer_text(Answer const& a, bool per_frequency) {
  std::string text = sentence(a);
  if (a.inversion.touched > 0)
    text += fmt::format("Affected routes carry at most {:.3g} % of the noise power at any frequency.\n",
                        100 * a.inversion.touched);
  else
    text += "No resolved route is affected.\n";
  if (a.inversion.first_order && a.inversion.all.verdict != Verdict::unknown)
    text += fmt::format(
        "Routes without a name scale as the named ones of their row do; without any, as one scatter: first order, for "
        "up "
        "to {:.3g} % of the noise power.\n",
        100 * a.inversion.mixed);
  text += fmt::format("Errors: {}one standard error, Monte Carlo only.\n",
                      a.subject == Answer::Subject::scatter ? "at most " : "");
  if (!a.unresolved.empty())
    text += fmt::format(
        "This result is not conservative: {} unresolved, with only the observed part in the total. Trace longer.\n",
        counted(a.unresolved.size(), "route", "is", "are"));
  return per_frequency ? text + table(a) : text;
}

std::string answer_json(Answer const& a) {
  Json j;
  j["question"] = a.what;
  j["line"] = a.line;
  j["answer"] = json_of(a.inversion.all);
  j["decides_Hz"] = a.grid.centre(a.inversion.decides);
  j["touched_share"] = a.inversion.touched;
  j["first_order"] = a.inversion.first_order;
  j["mixed_share"] = a.inversion.mixed;
  j["scattered_share"] = finite_or_null(a.tis);
  j["unresolved"] = a.unresolved;
  j["complete"] = a.complete;
  j["frequencies"] = Json::array();
  for (std::size_t i = 0; i < a.grid.size(); ++i) {
    Json one = json_of(a.inversion.bins[i]);
    one["frequency_Hz"] = a.grid.centre(i);
    one["line"] = finite_or_null(a.line_asd[i]);
    if (!a.motion.empty()) one["motion_m_per_sqrtHz"] = a.motion[i];
    j["frequencies"].push_back(one);
  }
  return json_text(j, 2) + "\n";
}

}  // namespace straytrace::session
