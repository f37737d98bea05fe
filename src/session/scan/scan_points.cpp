// SPDX-License-Identifier: BSD-3-Clause
#include "session/scan/scan_points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <unistd.h>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/process/threads.hpp"
#include "base/text/json_text.hpp"
#include "base/text/pattern.hpp"
#include "base/text/words.hpp"
#include "io/delimited_text.hpp"
#include "noise/fundamental/budget.hpp"
#include "results/curves/band.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"
#include "results/text/table.hpp"
#include "scene/scene_document.hpp"
#include "session/compare/model_diff.hpp"
#include "session/open_run.hpp"
#include "spectra/curve.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t most_points = 10000;

struct Number {
  double value = not_a_number;
  std::string unit;
};

Number number_in(std::string const& written) {
  std::string const text = with_plain_spaces(written);
  static Pattern const form(R"(\s*([+-]?[0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*)");
  PatternMatch const m = form.match(text);
  if (!m) return {};
  auto const number = leading_number(m[1]);
  return {number ? number->value : infinity, m[2]};  // inf: beyond double
}

std::string written(double value, std::string const& unit) {
  return unit.empty() ? fmt::format("{:.12g}", value) : fmt::format("{:.12g} {}", value, unit);
}

// With the decimal commas of a range as points.
std::string pointed(std::string const& text) {
  static Pattern const comma("([0-9]),([0-9])");
  return comma.replaced(text, "$1.$2");
}

std::string example(std::string const& name) {
  return fmt::format("write {0}=50cm..80cm:7, {0}=50cm..80cm:7:log or {0}=50cm,60cm,80cm", name);
}

[[noreturn]] void refuse_range(std::string const& word, std::string const& why, std::string const& name) {
  throw InputError(fmt::format("'{}': {}", word, why), example(name));
}

void add_range(ScanAxis& axis, std::string const& word, PatternMatch const& m, bool open) {
  if (std::string const meant = pointed(word); meant != word)
    throw InputError(fmt::format("'{}' has a decimal comma", word), fmt::format("write '{}'", meant));
  Number const low = number_in(m[1]), high = number_in(m[2]);
  if (std::size_t const colon = high.unit.find(':'); colon != high.unit.npos)
    refuse_range(word, fmt::format("'{}' is not a number of values, with or without ':log'", high.unit.substr(colon)),
                 axis.name);
  if (!std::isfinite(low.value) || !std::isfinite(high.value))
    refuse_range(word, "a range runs from a number to a number", axis.name);
  if (low.unit != high.unit) refuse_range(word, "both ends of a range must have the same unit", axis.name);
  std::string const count = m[3];
  bool const logarithmic = m.matched(4);
  if (count.empty() && !open) refuse_range(word, "the range has no number of values", axis.name);
  double const n = count.empty() ? 2 : std::strtod(count.c_str(), nullptr);
  if (n < 2 || n > double(most_points))
    refuse_range(word, fmt::format("a range has 2 to {} values", most_points), axis.name);
  if (logarithmic && !(low.value > 0 && high.value > 0))
    refuse_range(word, "logarithmic steps need values above 0", axis.name);
  if (low.value == high.value) refuse_range(word, "the range has no width", axis.name);
  axis.unit = low.unit;
  axis.range = true;
  for (int i = 0; i < int(n); ++i) {
    double const share = i / (n - 1);
    double const value = logarithmic ? low.value * std::pow(high.value / low.value, share)
                                     : low.value + share * (high.value - low.value);
    axis.numbers.push_back(value);
    axis.values.push_back(written(value, axis.unit));
  }
}

void add_list(ScanAxis& axis, std::string const& word, std::string const& text) {
  for (std::size_t at = 0; at <= text.size();) {
    std::size_t const comma = std::min(text.find(',', at), text.size());
    std::string const value = text.substr(at, comma - at);
    if (value.find_first_not_of(' ') == value.npos) refuse_range(word, "a value is missing", axis.name);
    Number const number = number_in(value);
    if (axis.values.empty()) axis.unit = number.unit;
    axis.numbers.push_back(number.unit == axis.unit ? number.value : not_a_number);
    axis.values.push_back(value);
    at = comma + 1;
  }
}

ScanAxis parse_axis(std::string const& word, bool open) {
  static Pattern const range(R"(\s*(.+?)\s*\.\.\s*(.+?)\s*(?::([0-9]+)(:log)?)?\s*)");
  std::size_t const equal = word.find('=');
  if (equal == 0 || equal == word.npos)
    throw InputError(fmt::format("'{}' does not name a parameter and its values", word), example("name"));
  ScanAxis axis{word.substr(0, equal), {}, {}, "", false};
  std::string const text = word.substr(equal + 1);
  if (PatternMatch const m = range.match(text))
    add_range(axis, word, m, open);
  else
    add_list(axis, word, text);
  return axis;
}

}  // namespace

std::vector<ScanAxis> parse_axes(std::vector<std::string> const& words, bool open, std::vector<InputError>& errors) {
  std::vector<ScanAxis> axes;
  std::set<std::string> names;
  double points = 1;
  for (std::string const& word : words) try {
      ScanAxis axis = parse_axis(word, open);
      if (!names.insert(axis.name).second)
        throw InputError(fmt::format("'{}' is given twice", axis.name), "write all its values in one list");
      points *= double(axis.values.size());
      axes.push_back(std::move(axis));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  if (points <= double(most_points)) return axes;
  errors.emplace_back(fmt::format("{:.0f} combinations are more than {}", points, most_points), "use fewer values");
  return {};
}

std::vector<std::vector<std::string>> combinations(std::vector<ScanAxis> const& axes) {
  std::vector<std::vector<std::string>> all{{}};
  for (ScanAxis const& axis : axes) {
    std::vector<std::vector<std::string>> next;
    for (auto const& before : all)
      for (std::string const& value : axis.values) {
        next.push_back(before);
        next.back().push_back(axis.name + "=" + value);
      }
    all = std::move(next);
  }
  return all;
}

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
    throw InputError(fmt::format("--against: '{}' is neither a design curve nor a file", name),
                     did_you_mean(name, known, fmt::format("known: {}", fmt::join(known, ", "))));
  }
  Curve const table = read_named_curve(
      name, strain_columns, "--against: a design curve consists of two columns: frequency in Hz, strain in 1/sqrt(Hz)");
  for (std::size_t i = 0; i < grid.size(); ++i) curve.asd.push_back(table.at(grid.centre(i)));
  return curve;
}

}  // namespace

void apply(Requirement const& requirement, ProjectionModel& model) {
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

std::string name_of_line(ProjectionModel const& model) {
  return model.design.empty() ? "" : fmt::format("{:.3g} x {}", model.noise.margin, model.design.front().name);
}

std::vector<double> line_of(ProjectionModel const& model) {
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
    point.ratio = {ratio, b.total.sigma[i] / line[i], at_most(b.total, i), !b.unresolved.empty()};
    point.worst_hz = b.grid.centre(i);
  }
}

std::string run_name(std::string const& model_hash, std::uint64_t seed) {
  return fmt::format("{}-{}", model_hash.substr(0, 16), seed);
}

Scanner::Scanner(ScanOptions options, Requirement requirement, std::string folder)
    : options_(std::move(options)), requirement_(std::move(requirement)), folder_(std::move(folder)) {}

std::shared_ptr<TracedLight const> Scanner::trace_of(Model& model, ScanPoint& point) {
  std::string const name = run_name(point.model_hash, model.seed);
  if (auto const known = traced_.find(name); known != traced_.end()) {
    point.from = ScanPoint::From::shared;
    return known->second;
  }
  std::string const file = folder_.empty() ? "" : fmt::format("{}/runs/{}.h5", folder_, name);
  std::uint64_t before = 0;
  if (auto const stored = file.empty() ? std::nullopt : earlier_run(file, point.model_hash, model.seed, options_.force))
    before = stored->trace.coupling.histories;
  TraceResult result = trace_model(model, options_, file).result;
  point.complete = !result.checkpointed();
  bool const unchanged = result.coupling.histories == before;
  point.from = unchanged && !made_.contains(name) ? ScanPoint::From::stored : ScanPoint::From::traced;
  if (!file.empty() && !unchanged) write_run(file, content_of(model, result, nullptr));
  std::vector<ObjectRow> objects = object_rows(result);
  auto const light = std::make_shared<TracedLight const>(TracedLight{std::move(result.coupling), std::move(objects)});
  if (point.complete) traced_.emplace(name, light);
  return light;
}

Model Scanner::model_at(std::vector<std::string> const& settings) const {
  std::vector<std::string> overrides = options_.overrides;
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  Model model;
  try {
    model = read_model(options_.input, overrides);
    apply(options_, model);
    apply(requirement_, model);
  } catch (InputError const& e) {
    throw InputError(e.problems, fmt::format("{}\nat the point {}", e.what(), fmt::join(settings, ", ")), e.files);
  }
  if (!model.detector)
    throw InputError("a scan needs noise, but the scene has no 'interferometer'", "add one, and 'ports'");
  return model;
}

namespace {

// The same problems at one more point.
InputError also_at(InputError const& e, std::vector<std::string> const& point) {
  return {e.problems, fmt::format("{}; {}", e.what(), fmt::join(point, ", ")), e.files};
}

std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-'; });
  return text;
}

// Equal for errors that differ only in the values of their points.
std::string fault_of(InputError const& e) {
  std::string fault;
  for (Problem const& p : e.problems)
    fault += fmt::format("{}:{}:{} {}\n{}\n", p.place.file, p.place.line, p.place.column, without_numbers(p.what),
                         without_numbers(p.suggestion));
  return fault;
}

}  // namespace

void Scanner::check(ScanList const& list) const {
  constexpr std::size_t most_told = 20;
  std::vector<InputError> errors;
  std::map<std::string, std::size_t> known;  // the error with this fault
  std::size_t bad = 0;
  for (std::size_t i = 0; i < list.points.size() && bad < most_told; ++i) try {
      model_at(list.points[i]);
    } catch (InputError const& e) {
      ++bad;
      InputError const here = in_points(e, list, i, options_.overrides.size());
      auto const [same, is_new] = known.emplace(fault_of(e), errors.size());
      if (is_new)
        errors.push_back(here);
      else if (!here.files.empty())
        errors[same->second] = also_at(errors[same->second], list.points[i]);
    }
  throw_all(errors);
}

ScanPoint Scanner::at(std::vector<std::string> const& settings, Look const& look) {
  ScanPoint point;
  point.settings = settings;
  Model model = model_at(settings);
  if (model.warnings != told_) print_warnings(model, options_);
  told_ = model.warnings;
  point.model_hash = model.hash();
  auto const light = trace_of(model, point);
  point.histories = light->coupling.histories;
  NoiseBudget const budget = model.project(light->coupling);
  print_warnings(budget, options_, fmt::format("{}", fmt::join(settings, ", ")));
  point.warnings = budget.warnings;
  for (double const hz : frequencies) point.strain.push_back(strain_at(budget.total, budget.grid, hz));
  judge(point, budget, line_of(model));
  line_ = name_of_line(model);
  if (look) look(model, *light, budget);
  return point;
}

namespace {

using Settings = std::vector<std::string>;

struct Job {
  Settings const* point = nullptr;
  std::string run;  // name of its file
};

// One point for each model; points that cannot be read are left out.
std::vector<Job> different_models(std::vector<Settings> const& points, ScanOptions const& options) {
  std::vector<Job> jobs;
  std::set<std::string> known;
  for (Settings const& point : points) try {
      std::vector<std::string> overrides = options.overrides;
      overrides.insert(overrides.end(), point.begin(), point.end());
      Model model = read_model(options.input, overrides);
      apply(options, model);
      std::string const run = run_name(model.hash(), model.seed);
      if (known.insert(run).second) jobs.push_back({&point, run});
    } catch (InputError const&) {
    }
  return jobs;
}

// A child; it ends its blocks and writes when the scan is killed.
[[noreturn]] void work(Job const& job, ScanOptions options, Requirement const& requirement, unsigned jobs) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  options.quiet = true;
  if (options.threads == 0) options.threads = std::max(1u, thread_count(0) / jobs);
  int code = input_error;
  try {
    code = Scanner(options, requirement, options.out).at(*job.point).complete ? done : checkpointed;
  } catch (std::exception const&) {  // repeated by the scan that follows
  }
  ::_exit(code);
}

// Identity of a run file, to detect changes by a job.
std::filesystem::file_time_type age(std::string const& folder, std::string const& run) {
  std::error_code none;
  return std::filesystem::last_write_time(fmt::format("{}/runs/{}.h5", folder, run), none);
}

}  // namespace

std::set<std::string> trace_together(std::vector<Settings> const& points, ScanOptions const& options,
                                     Requirement const& requirement, unsigned jobs, std::atomic<bool> const& stop) {
  std::vector<Job> const all = different_models(points, options);
  std::map<std::string, std::filesystem::file_time_type> before;
  for (Job const& job : all) before[job.run] = age(options.out, job.run);
  std::map<pid_t, Job const*> running;
  std::size_t next = 0, finished = 0;
  while (next < all.size() || !running.empty()) {
    while (next < all.size() && running.size() < jobs && !stop) {
      std::cout.flush();
      pid_t const child = ::fork();
      if (child == 0) work(all[next], options, requirement, jobs);
      if (child < 0) throw InputError("cannot start another process", "reduce --jobs");
      running[child] = &all[next++];
    }
    if (running.empty()) break;  // stopped
    int status = 0;
    pid_t const child = ::waitpid(-1, &status, 0);
    if (child < 0 && errno == EINTR) {  // Ctrl-C reached the jobs too; a signal to this process alone is passed on
      for (auto const& [process, ignored] : running)
        if (stop) ::kill(process, SIGTERM);
      continue;
    }
    auto const job = running.find(child);
    if (job == running.end()) continue;
    ++finished;
    if (!options.quiet)
      std::cerr << fmt::format("scan  traced {} of {}: {}\n", finished, all.size(),
                               fmt::join(*job->second->point, ", "));
    running.erase(job);
  }
  std::set<std::string> made;
  for (auto const& [run, time] : before)
    if (age(options.out, run) != time) made.insert(run);
  return made;
}

namespace {

constexpr std::size_t most_listed_points = 10000;

}  // namespace

ScanList read_points(std::string const& file) {
  std::vector<Problem> problems;
  CsvTable const table = parse_csv_table(read_text(file), Comments::whole_lines, "rim [cm], baffles", problems);
  if (table.rows.size() > most_listed_points)
    complain(problems, {"", table.rows[most_listed_points].line(), 1},
             fmt::format("more than {} points", most_listed_points), "use fewer");
  if (!problems.empty()) throw errors_in(file, problems);
  ScanList list;
  list.file = file;
  for (CsvTable::Column const& c : table.columns) list.axes.push_back({c.name, {}, {}, c.written_unit, false});
  for (CsvTable::Row const& row : table.rows) {
    std::vector<std::string> point;
    std::vector<Place> places;
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      ScanAxis& axis = list.axes[i];
      axis.values.push_back(std::string(row.cells[i].text) + (axis.unit.empty() ? "" : " " + axis.unit));
      axis.numbers.push_back(io::number_in(row.cells[i].text).value_or(not_a_number));
      point.push_back(axis.name + "=" + axis.values.back());
      places.push_back({0, row.cells[i].line, row.cells[i].column});
    }
    list.points.push_back(std::move(point));
    list.places.push_back(std::move(places));
  }
  return list;
}

InputError in_points(InputError const& e, ScanList const& list, std::size_t point, std::size_t overrides) {
  if (list.file.empty() || e.files.empty()) return e;
  std::vector<Problem> problems = e.problems;
  std::vector<std::string> files = e.files;
  files.push_back(list.file);
  std::string text;
  for (Problem& p : problems) {
    if (files[p.place.file] == command_line_name && p.place.line > overrides) {
      p.place = list.places[point][p.place.line - 1 - overrides];
      p.place.file = std::uint32_t(files.size() - 1);
    }
    text += placed_message(p, files[p.place.file]) + "\n";
  }
  text += fmt::format("at the point {}", fmt::join(list.points[point], ", "));
  return {std::move(problems), std::move(text), std::move(files)};
}

namespace {

using Json = nlohmann::ordered_json;

char const* word_of(ScanPoint::From from) {
  constexpr char const* words[] = {"traced", "stored", "same trace"};
  return words[std::size_t(from)];
}

std::string value_of(std::string const& setting) { return setting.substr(setting.find('=') + 1); }

std::string short_hertz(double hz) { return fmt::format("{:.3g}", hz); }

bool incomplete(ScanPoint const& p) { return !p.unresolved.empty(); }

bool has_upper_bounds(ScanPoint const& p) {
  return p.ratio.at_most || std::any_of(p.strain.begin(), p.strain.end(), [](WithError const& h) { return h.at_most; });
}

std::string above(ScanPoint const& p, WithError const& x) { return incomplete(p) && !x.at_most ? "> " : ""; }

std::vector<std::string> row_of(ScanPoint const& p, bool compared) {
  std::vector<std::string> row;
  for (std::string const& s : p.settings) row.push_back(value_of(s));
  for (WithError const& h : p.strain) row.push_back(std::isnan(h.value) ? "no answer" : above(p, h) + with_brackets(h));
  if (compared) {
    bool const known = !std::isnan(p.ratio.value);
    row.push_back(known ? above(p, p.ratio) + with_brackets(p.ratio) : "-");
    row.push_back(known ? short_hertz(p.worst_hz) : "-");
  }
  row.push_back(incomplete(p) ? fmt::format("{}", p.unresolved.size()) : "none");
  row.push_back(fmt::format("{:.3g}", double(p.histories)));
  row.push_back(p.complete ? word_of(p.from) : "not finished");
  return row;
}

}  // namespace

std::string scan_text(ScanTable const& t) {
  Columns c;
  for (ScanAxis const& axis : t.axes) c.titles.push_back(axis.name);
  for (double const f : Scanner::frequencies) c.titles.push_back(fmt::format("h({:g} Hz)", f));
  bool const compared = !t.line.empty();
  if (compared) c.titles.insert(c.titles.end(), {"worst h/line", "at/Hz"});
  c.titles.insert(c.titles.end(), {"unresolved", "histories", "from"});
  for (ScanPoint const& p : t.points) c.rows.push_back(row_of(p, compared));
  std::string text = aligned(c);
  if (compared) text += fmt::format("\nline: {}; above 1 the total exceeds it.", t.line);
  text +=
      "\nh: one-sided strain ASD in 1/sqrt(Hz), mean over random static phases; (n): one standard error, last "
      "digits.\n";
  if (std::any_of(t.points.begin(), t.points.end(), has_upper_bounds))
    text +=
        "'at most': an upper bound, since routes of kind edge contribute; 'about': no bound, since others are "
        "unresolved as well.\n";
  if (std::any_of(t.points.begin(), t.points.end(), incomplete))
    text +=
        "'>': a lower bound, 'no answer': no route is resolved; give more --histories, or --until \"h_total < 5 %\".\n";
  return text;
}

std::string scan_csv(ScanTable const& t) {
  std::string text = fmt::format("# straytrace scan of {}\n# line: {}\n", t.model, t.line.empty() ? "none" : t.line);
  text +=
      "# h: one-sided strain ASD [1/sqrt(Hz)]; sigma: one standard error, Monte Carlo; bound: what h and ratio are: "
      "lower, upper or neither bound, or empty\n";
  for (ScanAxis const& axis : t.axes) text += csv_text(axis.name) + ",";
  for (double const f : Scanner::frequencies) text += fmt::format("h_{0:g}Hz,h_{0:g}Hz_sigma,", f);
  text += "worst_ratio,worst_ratio_sigma,worst_Hz,unresolved,bound,histories,from,complete,model_hash\n";
  for (ScanPoint const& p : t.points) {
    for (std::string const& s : p.settings) text += csv_text(value_of(s)) + ",";
    for (WithError const& h : p.strain) text += csv_number(true, h.value) + "," + csv_number(true, h.sigma) + ",";
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{}\n", csv_number(true, p.ratio.value), csv_number(true, p.ratio.sigma),
                    csv_number(true, p.worst_hz), p.unresolved.size(), bound_name(has_upper_bounds(p), incomplete(p)),
                    p.histories, word_of(p.from), int(p.complete), p.model_hash);
  }
  return text;
}

std::string scan_json(ScanTable const& t) {
  Json j;
  j["model"] = t.model;
  j["line"] = t.line;
  j["complete"] = t.points.size() == t.wanted && (t.points.empty() || t.points.back().complete);
  j["parameters"] = Json::array();
  for (ScanAxis const& a : t.axes)
    j["parameters"].push_back({{"name", a.name}, {"unit", a.unit}, {"values", a.values}, {"numbers", a.numbers}});
  j["points"] = Json::array();
  for (ScanPoint const& p : t.points) {
    Json point, settings = Json::object();
    for (std::string const& s : p.settings) settings[s.substr(0, s.find('='))] = value_of(s);
    point["settings"] = settings;
    point["strain"] = Json::array();
    for (std::size_t i = 0; i < p.strain.size(); ++i) {
      Json h = error_json(p.strain[i]);
      h["frequency_Hz"] = Scanner::frequencies[i];
      point["strain"].push_back(h);
    }
    point["worst_ratio"] = error_json(p.ratio);
    point["worst_Hz"] = p.worst_hz;
    point["unresolved"] = p.unresolved;
    point["warnings"] = p.warnings;
    point["histories"] = p.histories;
    point["from"] = word_of(p.from);
    point["complete"] = p.complete;
    point["model_hash"] = p.model_hash;
    j["points"].push_back(point);
  }
  return json_text(j, 2) + "\n";
}

}  // namespace straytrace::session
