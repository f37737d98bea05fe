// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include <cmath>

#include "app/fit_report.hpp"

namespace straytrace {
namespace {

nlohmann::json number(Fitted const& f) {
  return {{"value", f.value}, {"sigma", f.sigma}, {"free", f.sigma > 0}, {"at_end_of_range", f.at_end}};
}

nlohmann::json prediction_json(FittedPath const& p, RoutePrediction const& r) {
  AgainstPrediction const a = against(p, r);
  nlohmann::json j{{"rank", r.rank},
                   {"route", r.route},
                   {"port", r.port},
                   {"body", r.body},
                   {"axis", r.axis},
                   {"multiplicity", r.multiplicity},
                   {"multiplicity_spread", r.spread},
                   {"resolved", !std::isnan(r.coupling)}};
  if (std::isnan(r.coupling)) return j;
  j["recoupled_fraction"] = {{"value", r.coupling}, {"sigma", r.sigma}};
  j["measured_over_predicted"] = number(a.ratio);
  if (r.speckle) j["speckle"] = {{"low_5", a.low}, {"high_95", a.high}, {"within", a.within}};
  return j;
}

nlohmann::json path_json(FitAnswer const& a, std::size_t i) {
  FittedPath const& p = a.fit.paths[i];
  Fitted const peak = effective_peak(a, i);
  nlohmann::json j{{"name", p.name},
                   {"static_phase_rad", number(p.phase)},
                   {"multiplicity", number(p.multiplicity)},
                   {"delay_s", number(p.delay)},
                   {"drift_rad_per_s", number(p.drift)},
                   {"effective_motion_peak_m", peak.value},
                   {"effective_motion_peak_sigma_m", peak.sigma},
                   {"unseen_phase_rad", unseen_phase(a, i)},
                   {"chi2_gained", p.gain},
                   {"ln_false_alarm", p.ln_false_alarm}};
  if (a.field) {
    double const f = p.amplitude.value;
    j["recoupled_fraction"] = number({f * f, 2 * f * p.amplitude.sigma});
  } else {
    j["amplitude"] = number(p.amplitude);
  }
  if (!a.routes.empty()) j["prediction"] = prediction_json(p, a.routes[i]);
  return j;
}

nlohmann::json clock_json(FitAnswer const& a) {
  ClockCheck const& c = a.fit.clock;
  nlohmann::json j{{"range_s", c.range}, {"better", c.better}, {"doubtful", c.doubtful}};
  if (!c.better) return j;
  j["delay_s"] = number(c.delay);
  j["chi2_gained"] = c.gain;
  for (FittedPath const& p : c.paths)
    j["paths"].push_back({{"name", p.name},
                          {a.field ? "field" : "amplitude", number(p.amplitude)},
                          {"multiplicity", number(p.multiplicity)}});
  return j;
}

char const* verdict_word(FitVerdict v) {
  char const* const words[] = {"none", "untested", "not-general", "clock", "end-of-range", "found"};
  return words[std::size_t(v)];
}

}  // namespace

nlohmann::json fit_json(FitAnswer const& a) {
  FringeFit const& fit = a.fit;
  nlohmann::json paths = nlohmann::json::array();
  for (std::size_t i = 0; i < fit.paths.size(); ++i) paths.push_back(path_json(a, i));
  nlohmann::json out{{"verdict", verdict_word(fit.verdict)},
                     {"target", a.records.target.name},
                     {"target_unit", a.records.target.unit},
                     {"band_hz", {a.settings.low, a.settings.high}},
                     {"wavelength_m", a.settings.wavelength},
                     {"method", a.settings.method == FitMethod::time ? "time" : "frequency"},
                     {"gps", {{"start", fit.start}, {"split", fit.split}, {"end", fit.end}, {"middle", fit.middle}}},
                     {"paths", paths},
                     {"highest_fringe_hz", fit.highest_fringe},
                     {"chi2", {{"without", fit.without}, {"with", fit.with}, {"degrees", fit.degrees}}},
                     {"ln_false_alarm", fit.ln_false_alarm},
                     {"parameters", fit.names}};
  for (TimeSeries const& x : a.records.witnesses) out["witnesses"].push_back(x.name);
  if (a.records.witnesses.size() > 1) out["ratio"] = number(fit.ratio);
  std::size_t const n = fit.names.size();
  for (std::size_t i = 0; i < n; ++i)
    out["correlation"].push_back(std::vector<double>(fit.correlation.begin() + std::ptrdiff_t(i * n),
                                                     fit.correlation.begin() + std::ptrdiff_t((i + 1) * n)));
  if (fit.clock.range > 0) out["clock"] = clock_json(a);
  if (fit.test.seconds > 0)
    out["out_of_sample"] = {
        {"seconds", fit.test.seconds},
        {"chi2", {{"without", fit.test.without}, {"with", fit.test.with}, {"degrees", fit.test.degrees}}},
        {"ln_odds", fit.test.ln_odds},
        {"ln_odds_expected", number(fit.test.ln_odds_expected)},
        {"scale", number(fit.test.scale)},
        {"reduction", number(fit.test.reduction)}};
  return out;
}

}  // namespace straytrace
