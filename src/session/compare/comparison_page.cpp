// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "base/errors.hpp"
#include "io/markup.hpp"
#include "report/html/page_json.hpp"
#include "session/compare/model_diff.hpp"
#include "session/compare/run_diff.hpp"
#include "session/open_run.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t rows_shown = 100;

// A run against the first one.
struct Pair {
  std::size_t after = 0;
  RunDifference results;
  std::vector<Change> by_frequency;
  std::vector<DifferenceLine> models;
  std::string motion;
};

PageJson text_table(std::vector<std::string> const& titles, std::vector<bool> const& text, PageJson const& rows) {
  PageJson columns = PageJson::array();
  for (std::size_t i = 0; i < titles.size(); ++i)
    columns.push_back({{"title", titles[i]}, {"text", bool(text[i])}, {"digits", 3}});
  return {{"columns", columns}, {"rows", rows}};
}

bool is_zero(Change const& c) { return c.before.value == 0 && c.after.value == 0; }

// Columns of a change: ratio, what became of it, the value in both runs and the significance. Rows that are zero in
// both runs are left out.
PageJson change_table(std::string const& what, std::string const& unit, std::vector<Change> const& all,
                      std::string const& before, std::string const& after) {
  PageJson rows = PageJson::array();
  for (Change const& c : all)
    if (rows.size() < rows_shown && !is_zero(c))
      rows.push_back({c.what, ratio_text(c), outcome_text(c), value_text(c, false), value_text(c, true),
                      verdict_text(c), c.error.paired ? "paired" : "independent"});
  return text_table({what, "ratio", "change", before + unit, after + unit, "significance", "error"},
                    {true, false, true, false, false, true, true}, rows);
}

PageJson ratio_curve(RunFile const& before, Pair const& pair) {
  std::vector<double> hz, value, low, high;
  for (std::size_t i = 0; i < pair.by_frequency.size(); ++i) {
    WithError const r = pair.by_frequency[i].ratio();
    bool const known = pair.by_frequency[i].before.value > 0 && std::isfinite(r.value);
    hz.push_back(before.noise->grid.centre(i));
    value.push_back(known ? r.value : not_a_number);
    low.push_back(known ? std::max(0.0, r.value - r.sigma) : not_a_number);
    high.push_back(known ? r.value + r.sigma : not_a_number);
  }
  return {{"frequency", report::numbers(hz)},
          {"value", report::numbers(value)},
          {"low", report::numbers(low)},
          {"high", report::numbers(high)}};
}

std::string bound_words(NoiseTrace const& total) {
  bool const bound = std::ranges::any_of(total.bound_share, [](double s) { return s > 0; });
  if (total.resolved) return bound ? "upper bound" : "";
  return bound ? "contains upper bounds, and routes are unresolved" : "lower bound";
}

PageJson run_json(RunFile const& run, std::string const& label) {
  NoiseBudget const& b = *run.noise;
  std::vector<double> hz, low, high;
  for (std::size_t i = 0; i < b.grid.size(); ++i) {
    hz.push_back(b.grid.centre(i));
    low.push_back(std::max(0.0, b.total.asd[i] - b.total.sigma[i]));
    high.push_back(b.total.asd[i] + b.total.sigma[i]);
  }
  PageJson design = PageJson::array();
  for (DesignCurve const& c : b.design) design.push_back({{"name", c.name}, {"asd", report::numbers(c.asd)}});
  return {{"label", label},
          {"frequency", report::numbers(hz)},
          {"asd", report::numbers(b.total.asd)},
          {"low", report::numbers(low)},
          {"high", report::numbers(high)},
          {"bound", bound_words(b.total)},
          {"unresolved", b.unresolved},
          {"design", design},
          {"warnings", run.content().all_warnings()},
          {"provenance", report::provenance_json(run.content())}};
}

// "h from 3 to 1000 Hz: after is 0.832(12) times before, -14.0 sigma, significant (...)."
std::string sentence(Pair const& pair, std::string const& before, std::string const& after) {
  Change const& c = pair.results.whole;
  std::string const band = fmt::format("h from {:g} to {:g} Hz: ", pair.results.low, pair.results.high);
  if (c.before.value == c.after.value) return band + fmt::format("'{}' and '{}' are the same.", after, before);
  return band + fmt::format("'{}' is {} times '{}', {}{} ({}).", after, ratio_text(c), before, verdict_text(c),
                            c.bound ? "; unresolved routes may add to it" : "",
                            c.error.paired ? "paired replicas" : "independent errors");
}

PageJson pair_json(RunFile const& first, Pair const& pair, std::string const& before, std::string const& after) {
  PageJson lines = PageJson::array();
  for (DifferenceLine const& l : pair.models) lines.push_back({l.section, l.what, l.change});
  RunDifference const& d = pair.results;
  std::size_t const zero = std::size_t(std::ranges::count_if(d.routes, is_zero)), moving = d.routes.size() - zero;
  return {{"after", pair.after},
          {"sentence", sentence(pair, before, after)},
          {"error", error_words(d.common)},
          {"ratio", ratio_curve(first, pair)},
          {"bands", change_table("band", "", d.bands, before, after)},
          {"routes", change_table("route", "", d.routes, before, after)},
          {"more", moving - std::min(moving, rows_shown)},
          {"still", zero},
          {"receivers", change_table("receiver", " [" + unit_of_receivers(d) + "]", d.receivers, before, after)},
          {"models", text_table({"of", "what", before + " → " + after}, {true, true, true}, lines)},
          {"motion", pair.motion}};
}

std::vector<Pair> all_pairs(std::vector<RunFile> const& runs) {
  std::vector<std::optional<Scene>> scenes(runs.size());  // built where two models may differ
  auto const scene = [&](std::size_t i) -> Scene const& {
    RunContent const& about = runs[i].about;
    if (!scenes[i]) scenes[i] = read_by_all(about.main_file, about.overrides, &about.files);
    return *scenes[i];
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 1; i < runs.size(); ++i) {
    Pair pair{i, run_differences(runs[0], runs[i]), changes_by_frequency(runs[0], runs[i]), {}, {}};
    if (!same_texts(runs[0].about, runs[i].about))
      pair.models = difference_lines(parameter_differences(scene(0), scene(i)), differences(scene(0), scene(i)));
    pair.motion = motion_difference(runs[0].about, runs[i].about);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

std::string static_part(std::vector<Pair> const& pairs, std::vector<std::string> const& labels) {
  std::string head, text;
  for (Pair const& p : pairs) {
    std::string const& after = labels[p.after];
    head += fmt::format("<p class=\"verdict\">{}</p>\n", escaped(sentence(p, labels[0], after)));
    text +=
        fmt::format("{} -> {}\n\n{}{}\n", labels[0], after, difference_text(p.models), run_difference_text(p.results));
  }
  return head + "<noscript>\n<p>Scripts are off: this is the text of the comparison.</p>\n<pre>" + escaped(text) +
         "</pre>\n</noscript>\n";
}

}  // namespace

std::vector<std::string> run_labels(std::vector<std::string> const& files) {
  std::vector<std::string> labels;
  for (std::string const& file : files) {
    std::filesystem::path const path = std::filesystem::absolute(file).lexically_normal();
    labels.push_back(path.filename() == "run.h5" ? path.parent_path().filename().string() : path.stem().string());
  }
  std::vector<std::string> const plain = labels;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (std::ranges::count(plain, plain[i]) > 1) labels[i] += fmt::format(" ({})", i + 1);
  return labels;
}

std::vector<RunFile> read_compared(std::vector<std::string> const& files) {
  std::vector<RunFile> runs;
  std::vector<InputError> errors;
  for (std::string const& file : files) {
    try {
      RunFile run = read_run_file(file);
      if (!run.noise)
        throw InputError(fmt::format("'{}' has no noise to compare", file),
                         "give runs of scenes with an 'interferometer'; for a run without noise use 'straytrace noise "
                         "RUN -o DIR'");
      if (run.noise->routes.empty())
        throw InputError(fmt::format("in '{}' no traced light has rejoined a port", file), "trace more histories");
      runs.push_back(std::move(run));
      auto const &own = runs.back().noise->grid.edges, &first = runs.front().noise->grid.edges;
      if (!(std::max(own.front(), first.front()) < std::min(own.back(), first.back())))
        throw InputError(fmt::format("the band of '{}', {:g} to {:g} Hz, does not overlap that of the first run, {:g} "
                                     "to {:g} Hz",
                                     file, own.front(), own.back(), first.front(), first.back()),
                         "project one again with another 'band' in 'noise'");
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  }
  throw_all(errors);
  return runs;
}

std::string comparison_page(std::vector<RunFile> const& runs, std::vector<std::string> const& labels,
                            std::string const& title) {
  std::vector<Pair> const pairs = all_pairs(runs);
  report::HtmlPage page;
  std::vector<std::string> const others(labels.begin() + 1, labels.end());
  page.title = !title.empty() ? title : fmt::format("{} against {}", fmt::join(others, ", "), labels[0]);
  page.body = static_part(pairs, labels);
  PageJson& j = page.data;
  j["kind"] = "comparison";
  j["runs"] = j["pairs"] = PageJson::array();
  for (std::size_t i = 0; i < runs.size(); ++i) j["runs"].push_back(run_json(runs[i], labels[i]));
  for (Pair const& p : pairs) j["pairs"].push_back(pair_json(runs[0], p, labels[0], labels[p.after]));
  j["libraries"] = {{"plots", report::d3_script().name}};
  page.plots = true;
  page.scripts = {"base.js", "plot.js", "comparison.js"};
  return html_text(page);
}

}  // namespace straytrace::session
