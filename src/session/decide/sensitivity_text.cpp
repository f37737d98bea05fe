// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/text/json_text.hpp"
#include "results/curves/band.hpp"
#include "results/text/columns.hpp"
#include "session/decide/sensitivity.hpp"

namespace straytrace::session {
namespace {

using Json = nlohmann::ordered_json;

constexpr double worth_naming = 0.03;  // narrowing of the band

std::string hertz(double hz) { return hz < 1000 ? fmt::format("{:.3g} Hz", hz) : fmt::format("{:.0f} Hz", hz); }

std::string elasticity_text(BinValues const& e, std::size_t bin) {
  if (bin >= e.value.size()) return "outside the band";
  if (std::isnan(e.value[bin])) return "not known";
  if (std::fabs(e.value[bin]) < 5e-5 && e.sigma[bin] < 5e-5) return "below 1e-4";
  return e.sigma[bin] < 1e-6 ? fmt::format("{:.4g} exact", e.value[bin]) : with_brackets(e.value[bin], e.sigma[bin]);
}

std::string stated_text(SensitiveInput const& in) {
  std::string text;
  if (in.factor > 1) text = fmt::format("one sigma: factor {:.3g}", in.factor);
  if (in.low < 1 || in.high > 1)
    text += fmt::format("{}bracket: x {:.3g} to {:.3g}", text.empty() ? "" : ", ", in.low, in.high);
  return text.empty() ? "taken as exact" : text;
}

double gain_of_halving(SensitiveInput const& in, std::size_t bin) { return in.halving.empty() ? 0 : in.halving[bin]; }

// Of the narrowing, by the error of the elasticity.
double sigma_of_gain(SensitiveInput const& in, std::size_t bin) {
  double const share = in.share[bin], relative = in.elasticity.sigma[bin] / std::fabs(in.elasticity.value[bin]);
  return 0.375 / std::sqrt(1 - 0.75 * share) * 2 * share * (1 - share) * relative;
}

SensitiveInput const* leader_at(Sensitivity const& s, std::size_t bin) {
  SensitiveInput const* best = nullptr;
  for (SensitiveInput const& in : s.inputs)
    if (gain_of_halving(in, bin) > worth_naming && (!best || gain_of_halving(in, bin) > gain_of_halving(*best, bin)))
      best = &in;
  return best;
}

// Where other inputs than the one named lead: "motion of tube below 8 Hz".
std::string other_leaders(Sensitivity const& s, SensitiveInput const* named) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < s.grid.size();) {
    SensitiveInput const* const leads = leader_at(s, i);
    std::size_t end = i;
    while (end < s.grid.size() && leader_at(s, end) == leads) ++end;
    if (leads && leads != named)
      parts.push_back(fmt::format("{} from {} to {}", leads->name, hertz(s.grid.edges[i]), hertz(s.grid.edges[end])));
    i = end;
  }
  constexpr std::size_t most = 4;
  if (parts.size() > most) parts.resize(most);
  return parts.empty() ? "" : fmt::format(" Elsewhere others lead: {}.", fmt::join(parts, ", "));
}

std::string brackets_text(Sensitivity const& s) {
  std::string text;
  for (SensitiveInput const& in : s.inputs)
    if ((in.low < 1 || in.high > 1) && std::isfinite(in.elasticity.value[s.decides])) {
      double const e = in.elasticity.value[s.decides];
      text += fmt::format(
          "The bracket of {} moves h at {} by a factor {:.3g} to {:.3g}, to first order; it is a range and has no "
          "share.\n",
          in.name, hertz(s.grid.centre(s.decides)), std::pow(in.low, e), std::pow(in.high, e));
    }
  return text;
}

std::string traced_text(Sensitivity const& s, SensitiveInput const& in) {
  std::string check;
  for (double const hz : s.frequencies)
    if (std::size_t const i = s.grid.bin_of(hz); i < in.extrapolated.value.size())
      check += fmt::format("{} {}", check.empty() ? "" : ",", elasticity_text(in.extrapolated, i));
  if (!check.empty()) check = "; with twice the step, extrapolated to none:" + check;
  return fmt::format(
      "{}: {}{}; correlation of both {:.3g}{}.\n", in.name, in.method, check, in.correlation,
      in.correlation < 0.5 ? ": the paths have come apart, the error is nearly that of independent runs" : "");
}

// What the shares of all inputs leave is of several together.
std::string band_text(Sensitivity const& s) {
  if (!(s.band[s.decides] > 0)) return "";
  double alone = 0;
  for (SensitiveInput const& in : s.inputs) alone += in.share.empty() ? 0 : in.share[s.decides];
  std::string const how = s.sampled[s.decides] ? "by samples, because first order fails" : "to first order";
  std::string text = fmt::format("The stated standard deviations give h at {} a band of {:.3g} % (one sigma, {}).\n",
                                 hertz(s.grid.centre(s.decides)), 100 * (std::exp(s.band[s.decides]) - 1), how);
  if (s.sampled[s.decides] && alone < 0.98)
    text += fmt::format("Of its variance, {:.2g} % come from several inputs together.\n", 100 * (1 - alone));
  return text;
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json numbers(std::vector<double> const& values) {
  Json all = Json::array();
  for (double const v : values) all.push_back(json_number(v));
  return all;
}

Json json_of(Sensitivity const& s, SensitiveInput const& in) {
  Json j{{"name", in.name},
         {"class", name_of(in.kind)},
         {"value", in.value},
         {"method", in.method},
         {"elasticity", numbers(in.elasticity.value)},
         {"elasticity_sigma", numbers(in.elasticity.sigma)},
         {"one_sigma_factor", in.factor},
         {"bracket", {in.low, in.high}}};
  j["share"] = numbers(in.share);
  j["narrowing"] = numbers(in.halving);
  if (!in.share.empty()) j["gain_of_halving"] = json_number(gain_of_halving(in, s.decides));
  if (std::isfinite(in.correlation)) j["correlation"] = in.correlation;
  if (std::isfinite(in.step)) j["step"] = in.step;
  if (!in.extrapolated.value.empty()) {
    j["extrapolated"] = numbers(in.extrapolated.value);
    j["extrapolated_sigma"] = numbers(in.extrapolated.sigma);
  }
  return j;
}

}  // namespace

std::string next_measurement(Sensitivity const& s) {
  std::string const where = fmt::format("at {}{}", hertz(s.grid.centre(s.decides)),
                                        s.line.empty() ? "" : ", where h is closest to " + s.line);
  if (std::ranges::none_of(s.inputs, [](SensitiveInput const& in) { return in.factor > 1; })) {
    std::vector<std::string> names;
    for (SensitiveInput const& in : s.inputs)
      if (names.size() < 3 && std::ranges::find(names, in.name) == names.end()) names.push_back(in.name);
    if (names.empty()) return "No input of these classes has an effect on h.\n";
    return fmt::format(
        "No input states a standard deviation ('uncertainty'). State first those that h follows most: {}.\n",
        fmt::join(names, ", "));
  }
  if (std::isnan(s.band[s.decides]))
    return fmt::format(
        "The band of h {} is not known, because an elasticity of an input with a stated uncertainty is not.{}\n", where,
        other_leaders(s, nullptr));
  SensitiveInput const* const best = leader_at(s, s.decides);
  if (!best)
    return fmt::format(
        "No single input narrows the band of h {} by more than {:.0f} % when its uncertainty is halved.{}\n", where,
        100 * worth_naming, other_leaders(s, nullptr));
  double const gain = 100 * gain_of_halving(*best, s.decides), sigma = 100 * sigma_of_gain(*best, s.decides);
  return fmt::format("Measure next: {}. Halving its uncertainty narrows the band of h {} by {} %.{}\n", best->name,
                     where + (s.line.empty() ? "" : ","),
                     s.sampled[s.decides] ? fmt::format("about {:.2g}", gain)
                     : sigma > 1e-3       ? with_error(gain, sigma)
                                          : fmt::format("{:.3g}", gain),
                     other_leaders(s, best));
}

std::string sensitivity_text(Sensitivity const& s) {
  Columns c;
  c.titles = {"input", "class", "value"};
  c.left = {true, true, true};
  for (double const hz : s.frequencies) c.titles.push_back(hertz(hz));
  c.titles.insert(c.titles.end(), {"stated", "share of the band"});
  c.left.resize(c.titles.size());
  c.left[c.titles.size() - 2] = true;
  for (SensitiveInput const& in : s.inputs) {
    std::vector<std::string> row{in.name, name_of(in.kind), in.value};
    for (double const hz : s.frequencies) row.push_back(elasticity_text(in.elasticity, s.grid.bin_of(hz)));
    row.push_back(stated_text(in));
    bool const known = !in.share.empty() && std::isfinite(in.share[s.decides]);
    row.push_back(in.share.empty() ? "-" : known ? fmt::format("{:.3g} %", 100 * in.share[s.decides]) : "not known");
    c.rows.push_back(std::move(row));
  }
  std::string text =
      "Elasticity of h, d ln h/d ln p: by how many per cent h changes with 1 % of the input.\n\n" + aligned(c);
  text +=
      "\nexact: all light changes by one factor, so that the Monte-Carlo error cancels. not known: the light that "
      "depends "
      "on the input is unresolved, or has too few kept paths, or an edge of its BSDF moves.\n";
  if (!s.idle.empty()) text += fmt::format("\nWithout effect on h: {}.\n", fmt::join(s.idle, ", "));
  for (SensitiveInput const& in : s.inputs)
    if (in.kind == InputClass::traced) text += traced_text(s, in);
  text += "\n" + brackets_text(s);
  text += band_text(s);
  return text + next_measurement(s);
}

std::string sensitivity_csv(Sensitivity const& s) {
  std::string text =
      "name,class,value,method,one_sigma_factor,low,high,frequency,elasticity,sigma,share,narrowing,sampled\n";
  auto const of_share = [](std::vector<double> const& share, std::size_t i) {
    bool const known = !share.empty() && std::isfinite(share[i]);
    return csv_number(known, known ? share[i] : 0);
  };
  for (SensitiveInput const& in : s.inputs)
    for (std::size_t i = 0; i < s.grid.size(); ++i)
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_text(in.name), name_of(in.kind),
                          csv_text(in.value), csv_text(in.method), in.factor, in.low, in.high, s.grid.centre(i),
                          csv_number(std::isfinite(in.elasticity.value[i]), in.elasticity.value[i]),
                          csv_number(std::isfinite(in.elasticity.sigma[i]), in.elasticity.sigma[i]),
                          of_share(in.share, i), of_share(in.halving, i), int(s.sampled[i]));
  return text;
}

std::string sensitivity_json(Sensitivity const& s) {
  Json j;
  std::vector<double> centres;
  for (std::size_t i = 0; i < s.grid.size(); ++i) centres.push_back(s.grid.centre(i));
  j["frequency"] = numbers(centres);
  j["asd"] = numbers(s.total.asd);
  j["band"] = numbers(s.band);
  j["sampled"] = s.sampled;
  j["at"] = s.frequencies;
  j["decides"] = centres.at(s.decides);
  j["line"] = s.line;
  j["inputs"] = Json::array();
  for (SensitiveInput const& in : s.inputs) j["inputs"].push_back(json_of(s, in));
  j["without_effect"] = s.idle;
  j["warnings"] = s.warnings;
  std::string sentence = next_measurement(s);
  sentence.pop_back();
  j["next"] = sentence;
  return json_text(j, 2) + "\n";
}

}  // namespace straytrace::session
