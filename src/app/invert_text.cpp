// SPDX-License-Identifier: BSD-3-Clause
#include "app/invert_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "app/scan_points.hpp"
#include "base/counted.hpp"
#include "report/columns.hpp"

namespace straytrace {
namespace {

using Json = nlohmann::ordered_json;
using Verdict = Allowed::Verdict;

std::string hertz(double hz) { return fmt::format("{:.3g} Hz", hz); }

char const* word_of(Verdict verdict) {
  constexpr char const* words[] = {"found", "always", "never", "no line"};
  return words[std::size_t(verdict)];
}

std::string subject_words(Answer const& a) {
  return a.subject == Answer::Subject::scatter ? "the BRDF of the material" : "the motion (ASD) of the body";
}

// What the factor means in numbers of the trade.
std::string in_numbers(Answer const& a) {
  Allowed const& all = a.inversion.all;
  if (a.subject == Answer::Subject::scatter && std::isfinite(a.tis)) {
    double const tis = all.scale * a.tis;
    std::string text = fmt::format("Scattered share at normal incidence: {:.3g} now, {} allowed.\n", a.tis,
                                   with_error(tis, all.sigma * a.tis));
    if (tis > 1) text += "That is more than all light: no scatter of this material alone breaks the line.\n";
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
      return fmt::format("{}: every factor that was looked at stays under {}: it does not decide.\n", a.what, a.line);
    case Verdict::never:
      return fmt::format("{}: nothing helps: light that it does not touch alone is a factor {:.3g} above {} at {}.\n",
                         a.what, all.rest, a.line, at);
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
         "\nEach frequency alone. never: the rest is above the line; always: every factor meets it.\n";
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json json_of(Allowed const& a) {
  return {{"verdict", word_of(a.verdict)},
          {"scale", finite_or_null(a.scale)},
          {"sigma", finite_or_null(a.sigma)},
          {"rest_over_line", finite_or_null(a.rest)}};
}

}  // namespace

Answer answer_about(Model const& model, NoiseBudget const& budget, Inversion inversion) {
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
    text += fmt::format("Routes that it acts on carry at most {:.3g} % of the noise power at any frequency.\n",
                        100 * a.inversion.touched);
  else
    text += "No resolved route is touched by it.\n";
  if (a.inversion.first_order)
    text += "Rows 'other' are scaled as their named routes are; without any, as one scatter: first order.\n";
  text += fmt::format("Errors: {}one standard error, Monte Carlo only.\n",
                      a.subject == Answer::Subject::scatter ? "at most " : "");
  if (!a.unresolved.empty())
    text += fmt::format("This is no safe answer: {} unresolved, and in the total by what was seen. Trace longer.\n",
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
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace straytrace
