// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/scatter_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "base/text/words.hpp"

namespace straytrace::results {
namespace {

nlohmann::json audit_json(ScatterAudit const& audit) {
  nlohmann::json rows = nlohmann::json::array();
  for (IncidenceAudit const& i : audit.incidences) {
    rows.push_back({{"deg", i.theta_i * 180 / pi},
                    {"points", i.points},
                    {"limits", i.limits},
                    {"nearest", i.nearest},
                    {"farthest", i.farthest},
                    {"tis", i.tis},
                    {"tis_sampling", i.sampling},
                    {"tis_inside", i.inside},
                    {"tis_outside", i.outside}});
    if (i.stated >= 0) rows.back().update({{"tis_stated", i.stated}, {"tis_table", i.integral}});
  }
  return {{"incidences", rows},
          {"points", audit.points},
          {"limits", audit.limits},
          {"duplicates", audit.duplicates},
          {"turns", audit.turns},
          {"reciprocity",
           {{"pairs", audit.pairs}, {"worst_ln", audit.worst_reciprocity}, {"rms_ln", audit.rms_reciprocity}}},
          {"spread", audit.spread}};
}

nlohmann::json fit_json(ScatterFit const& fit) {
  nlohmann::json out{{"model", fit.model}, {"why_not", fit.why}};
  if (fit.fitted.empty()) return out;
  for (FitParameter const& p : fit.parameters)
    out["parameters"].push_back({{"name", p.name},
                                 {"unit", p.unit},
                                 {"value", p.value},
                                 {"error", std::isfinite(p.error) ? nlohmann::json(p.error) : nlohmann::json()}});
  out.update({{"chi2", fit.chi2},
              {"freedom", fit.freedom},
              {"outliers", fit.outliers},
              {"rms_log10", fit.rms},
              {"errors_scaled", fit.scaled},
              {"tis", fit.tis},
              {"yaml", fit.yaml},
              {"fitted", fit.fitted}});
  return out;
}

// Curves in the plane of incidence towards the normal and past it, for the picture.
void add_curves(nlohmann::json& fit_out, ScatterFit const& fit, ScatterAudit const& audit) {
  if (!fit.why.empty()) return;
  for (IncidenceAudit const& i : audit.incidences) {
    nlohmann::json x = nlohmann::json::array(), y = nlohmann::json::array();
    for (int k = 0; k <= 120; ++k) {
      double const offset =
                       std::max(i.nearest / 3, 1e-6) * std::pow(i.farthest / std::max(i.nearest / 3, 1e-6), k / 120.0),
                   sine = std::sin(i.theta_i) - offset;
      if (std::fabs(sine) >= 1) continue;
      x.push_back(offset);
      y.push_back(fit.at(offset, std::cos(i.theta_i), std::sqrt(1 - sine * sine)));
    }
    fit_out["curves"].push_back({{"deg", i.theta_i * 180 / pi}, {"offset", x}, {"bsdf", y}});
  }
}

}  // namespace

nlohmann::json scatter_json(std::string const& name, ScatterFile const& file, ScatterAudit const& audit,
                            std::vector<ScatterFit> const& fits) {
  ScatterDeclared const& d = file.declared;
  nlohmann::json out{{"file", name},
                     {"format", file.format},
                     {"wavelength", d.wavelength},
                     {"side", file.transmitted ? "transmitted" : "reflected"},
                     {"polarisation_in", d.polarisation_in},
                     {"polarisation_out", d.polarisation_out},
                     {"noise_floor", d.noise_floor >= 0 ? nlohmann::json(d.noise_floor) : nlohmann::json()},
                     {"notes", file.notes},
                     {"audit", audit_json(audit)},
                     {"fits", nlohmann::json::array()}};
  for (ScatterPoint const& p : file.points) {
    bool const directed = std::isfinite(p.theta_s);
    out["points"].push_back({{"deg", p.theta_i * 180 / pi},
                             {"offset", p.offset},
                             {"bsdf", p.value},
                             {"error", p.error},
                             {"limit", p.limit},
                             {"cos_i", std::cos(p.theta_i)},
                             {"cos_s", directed ? nlohmann::json(std::cos(p.theta_s)) : nlohmann::json()},
                             {"towards", directed && p.theta_s * std::cos(p.phi) < p.theta_i}});
  }
  for (ScatterFit const& fit : fits) {
    out["fits"].push_back(fit_json(fit));
    add_curves(out["fits"].back(), fit, audit);
  }
  return out;
}

namespace {

std::string or_undeclared(std::string const& text) { return text.empty() ? "not declared" : text; }

std::string head(std::string const& name, ScatterFile const& file) {
  ScatterDeclared const& d = file.declared;
  std::string out = fmt::format("{}: {}, {}, {:g} nm\n", name, file.format,
                                file.transmitted ? "transmitted" : "reflected", d.wavelength * 1e9);
  out += fmt::format("  polarisation in: {}, out: {}; noise floor: {}\n", or_undeclared(d.polarisation_in),
                     or_undeclared(d.polarisation_out),
                     d.noise_floor > 0    ? fmt::format("{:g} /sr", d.noise_floor)
                     : d.noise_floor == 0 ? "none"
                                          : "not declared");
  for (std::string const& note : file.notes) out += fmt::format("  {}\n", note);
  return out;
}

std::string totals(ScatterAudit const& audit, std::string const& beyond) {
  bool const stated =
      std::any_of(audit.incidences.begin(), audit.incidences.end(), [](auto const& i) { return i.stated >= 0; });
  std::string out =
      fmt::format("\n{:>6} {:>7} {:>7} {:>11} {:>11} {:>10} {:>9} {:>13}{}\n", "deg", "points", "limits", "nearest",
                  "farthest", "TIS", "sampling", "extrapolated", stated ? "      stated   of table" : "");
  for (IncidenceAudit const& i : audit.incidences) {
    out += fmt::format("{:6.4g} {:7} {:7} {:11.3g} {:11.3g} {:10.3e} {:9.1e} {:>13}", i.theta_i / degree, i.points,
                       i.limits, i.nearest, i.farthest, i.tis, i.sampling,
                       i.tis > 0 ? fmt::format("{:.1f} %", 100 * (i.inside + i.outside) / i.tis) : "-");
    if (stated)
      out += i.stated >= 0 ? fmt::format(" {:11.4g} {:10.4g}", i.stated, i.integral) : "           -          -";
    out += '\n';
  }
  return out + fmt::format(
                   "nearest, farthest: |beta-beta0| of the points. TIS: by |beta-beta0| alone, {} beyond the points "
                   "(extrapolated: the share\nof it there). sampling: its change without every second point.\n",
                   beyond);
}

std::string finding(char const* about, bool good, std::string const& what) {
  return fmt::format("  {:<14}{} {}\n", about, good ? "ok:" : "look:", what);
}

// Degrees would end at 90: a column of radian, read as degrees, ends at pi/2 of them.
bool seems_to_be_radian(ScatterFile const& file) {
  double most = 0, least = infinity;
  for (ScatterPoint const& p : file.points) {
    if (!std::isfinite(p.theta_s)) return false;
    most = std::max({most, p.theta_i, std::fabs(p.theta_s)});
    least = std::min(least, p.theta_i);
  }
  return most > 0.5 * degree && most < 1.58 * degree && least < 0.9 * most;
}

// What the order of the points shows: a scan that turns back, directions measured twice.
std::string order_text(ScatterFile const& file, ScatterAudit const& audit) {
  bool const tested = file.stated.empty() &&
                      std::ranges::none_of(file.points, [](ScatterPoint const& p) { return std::isnan(p.theta_s); });
  if (!tested) return "order and repeats of directions not tested: the points are not a scan";
  return fmt::format("{}; {}",
                     audit.turns == 0 ? "theta_s runs one way at each incidence"
                                      : "theta_s turns back " + counted(audit.turns, "time"),
                     audit.duplicates == 0 ? "each direction was measured once"
                                           : counted(audit.duplicates, "direction", "was", "were") + " measured twice");
}

std::string findings(ScatterFile const& file, ScatterAudit const& audit) {
  std::string out = "\n";
  auto const most = std::max_element(audit.incidences.begin(), audit.incidences.end(),
                                     [](auto const& a, auto const& b) { return a.tis < b.tis; });
  out += finding("energy", most->tis <= 1,
                 fmt::format("at most {:.3g} of the light, at {:.3g} deg", most->tis, most->theta_i / degree));
  out += audit.pairs == 0
             ? finding("reciprocity", true, "no pair of directions was measured both ways: not tested")
             : finding("reciprocity", audit.worst_reciprocity < 0.4,
                       fmt::format("{} pairs of directions measured both ways: factor {:.3g} at most, {:.3g} rms",
                                   audit.pairs, std::exp(audit.worst_reciprocity), std::exp(audit.rms_reciprocity)));
  if (file.declared.noise_floor > 0)
    out += finding("noise floor", audit.limits * 10 < audit.points,
                   fmt::format("{} of {} points at or below it: upper limits", audit.limits, audit.points));
  else
    out += finding(
        "noise floor", file.declared.noise_floor == 0 || file.format != "laboratory CSV",
        file.declared.noise_floor == 0 ? "declared as none" : "not declared: no point counts as an upper limit");
  bool const tiny = seems_to_be_radian(file);
  out += finding(
      "angles", audit.turns + audit.duplicates == 0 && !tiny,
      fmt::format("{}{}", order_text(file, audit),
                  tiny ? "; none is above 1.58 deg: if they are radian, write 'theta_i [rad], theta_s [rad]'" : ""));
  out += finding(
      "isotropy", audit.spread < 1.5,
      fmt::format("points of one incidence at the same |beta-beta0| differ by a factor {:.3g} at most", audit.spread));
  for (IncidenceAudit const& i : audit.incidences)
    if (i.stated >= 0 && std::fabs(i.integral / i.stated - 1) > 0.05) {
      out += finding("stated TIS", false,
                     fmt::format("{:.4g} at {:.3g} deg, but the table integrates to {:.4g}", i.stated,
                                 i.theta_i / degree, i.integral));
      break;
    }
  return out;
}

// Two digits of the error, as many of the value.
std::string parameter_text(FitParameter const& p) {
  std::string const unit = p.unit.empty() ? "" : " " + p.unit;
  if (!std::isfinite(p.error)) return fmt::format("{} = {:.2g}{} (not resolved)", p.name, p.value, unit);
  int const digits = std::clamp(int(std::floor(std::log10(std::fabs(p.value) / p.error))) + 2, 1, 6);
  return fmt::format("{} = {:.{}g} +- {:.2g}{}", p.name, p.value, digits, p.error, unit);
}

// The worst outlier of a fit, if large: a glint, light that missed the sample, a typing error.
std::string farthest_text(ScatterFile const& file, ScatterFit const& fit) {
  constexpr double far = 3;  // factor
  double worst = std::log(far);
  ScatterPoint const* point = nullptr;
  double ratio = 1;
  for (std::size_t i = 0; i < file.points.size() && i < fit.fitted.size(); ++i) {
    ScatterPoint const& p = file.points[i];
    double const off = std::fabs(std::log(p.value / fit.fitted[i]));
    if (p.limit || !(off > worst)) continue;
    worst = off;
    point = &p;
    ratio = p.value / fit.fitted[i];
  }
  if (!point) return "";
  std::string const where =
      std::isfinite(point->theta_s)
          ? fmt::format("theta_i {:.4g} deg, theta_s {:.4g} deg", point->theta_i / degree, point->theta_s / degree)
          : fmt::format("theta_i {:.4g} deg, offset {:.4g}", point->theta_i / degree, point->offset);
  return fmt::format(
      "  look: line {} ({}) is {:.3g} times the best fit: a glint, or a bad point? 'model: table' spreads it over a\n"
      "  ring about the specular direction; remove it there, and inspect the part that it comes from\n",
      point->line, where, ratio);
}

std::string fits_text(ScatterFile const& file, std::vector<ScatterFit> const& fits) {
  bool const stated = std::any_of(file.points.begin(), file.points.end(), [](auto const& p) { return p.error > 0; });
  std::string out = fmt::format("\nfits to all incidences at once; errors of the points: {}\n",
                                stated ? "of the file" : fmt::format("{:.0f} % assumed", 100 * assumed_scatter_error));
  ScatterFit const* best = nullptr;
  for (ScatterFit const& fit : fits) {
    if (!fit.why.empty()) {
      out += fmt::format("  {:<14}{}\n", fit.model, fit.why);
      continue;
    }
    if (!best || fit.chi2 < best->chi2) best = &fit;
    std::string parameters;
    for (FitParameter const& p : fit.parameters) parameters += (parameters.empty() ? "" : ", ") + parameter_text(p);
    out += fmt::format(
        "  {:<14}{}\n  {:<14}chi2 {:.4g} for {} degrees of freedom, residuals {:.2g} dex rms, {} outliers; TIS(0) = "
        "{:.3g}\n",
        fit.model, parameters, "", fit.chi2, fit.freedom, fit.rms, fit.outliers, fit.tis);
  }
  if (!best) return out;
  if (best->scaled) out += "  errors of the parameters: scaled by the residuals, sqrt(chi2 / degrees of freedom)\n";
  out += farthest_text(file, *best);
  out += "\nto paste into a material, the best fit first:\n";
  std::vector<ScatterFit const*> sound;
  for (ScatterFit const& fit : fits)
    if (fit.why.empty()) sound.push_back(&fit);
  std::sort(sound.begin(), sound.end(), [](auto a, auto b) { return a->chi2 < b->chi2; });
  for (ScatterFit const* fit : sound) out += fmt::format("  scatter: {}\n", fit->yaml);
  return out;
}

}  // namespace

std::string scatter_text(std::string const& name, ScatterFile const& file, ScatterAudit const& audit,
                         std::vector<ScatterFit> const& fits, std::string const& beyond) {
  return head(name, file) + totals(audit, beyond) + findings(file, audit) + fits_text(file, fits);
}

}  // namespace straytrace::results
