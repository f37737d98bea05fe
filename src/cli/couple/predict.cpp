// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple predict: coupling of a body to h from a traced run, compared with a measured one.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "analysis/coupling/lines.hpp"
#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/words.hpp"
#include "cli/couple/couple.hpp"
#include "cli/options.hpp"
#include "noise/project/sensor_noise.hpp"
#include "results/curves/band.hpp"
#include "results/text/columns.hpp"
#include "scene/expression.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

constexpr std::array<char const*, 6> axes{"x", "y", "z", "rx", "ry", "rz"};

struct PredictOptions {
  DataOptions data;
  std::string run, body, axis = "z", amplitude, frequency, measured, unit, witness_unit;
  double points = 0;
  std::size_t show = 8;
  bool own = false;
};

BodyAxis place_of(PredictOptions const& o, std::vector<std::string> const& bodies) {
  auto const body = std::find(bodies.begin(), bodies.end(), o.body);
  if (body == bodies.end()) {
    throw InputError(fmt::format("--body: the run has no body '{}'", o.body),
                     did_you_mean(o.body, bodies, fmt::format("bodies: {}", fmt::join(bodies, ", "))));
  }
  return {BodyId{std::uint32_t(body - bodies.begin())},
          int(std::find(axes.begin(), axes.end(), o.axis) - axes.begin())};
}

// Peak amplitude in m or rad; the kind of amplitude must be stated.
double peak_of(PredictOptions const& o, bool rotation) {
  static ParameterLookup const none{[](std::string_view) { return ParameterLookup::Found{}; },
                                    [] { return std::vector<std::string>(); }};
  std::string const example = rotation ? "2 urad peak" : "2 um peak";
  std::string why = fmt::format("'{}' is not {} with its kind", o.amplitude, rotation ? "an angle" : "a length");
  try {
    auto const v = evaluate_expression(o.amplitude, none);
    if (v && v->quantity.dimension == (rotation ? dim::angle : dim::length) && v->quantity.si > 0) {
      if (v->quantity.amplitude == Amplitude::peak) return v->quantity.si;
      if (v->quantity.amplitude == Amplitude::peak_to_peak) return v->quantity.si / 2;
      if (v->quantity.amplitude == Amplitude::rms) return v->quantity.si * std::sqrt(2);
      why = fmt::format("'{}' does not say which amplitude it is", o.amplitude);
    }
  } catch (ExpressionProblem const& problem) {
    why = fmt::format("'{}': {}", o.amplitude, problem.what);
  }
  throw InputError(fmt::format("--amplitude: {}", why), fmt::format("write --amplitude \"{}\", pp or rms", example));
}

FrequencyGrid grid_of(PredictOptions const& o, ProjectionModel const& model) {
  if (o.data.band.empty() && o.points == 0) return model.noise.grid;
  FrequencyBand band{model.noise.grid.edges.front(), model.noise.grid.edges.back()};
  if (!o.data.band.empty()) band = option_band(o.data.band, "--band");
  if (!(band.low > 0)) throw InputError("--band: it begins at 0 Hz", "write --band \"10 Hz..1 kHz\"");
  return logarithmic_grid(band.low, band.high, o.points > 0 ? o.points : 60);
}

// Those of every table, 10 to 1000 Hz; of a band that holds few of them, five across it.
std::vector<double> told_frequencies(FrequencyGrid const& grid) {
  std::vector<double> out;
  double const low = grid.edges.front(), high = grid.edges.back();
  for (double const f : {10.0, 30.0, 100.0, 300.0, 1000.0})
    if (f >= low && f < high) out.push_back(f);
  if (out.size() > 1) return out;
  out.clear();
  for (int i = 0; i < 5; ++i) out.push_back(low * std::pow(high / low, (i + 0.5) / 5));
  return out;
}

std::string bound_of(PredictedCoupling const& p) {
  std::string const text = bound_text(p.has_bounds(), p.unresolved.size());
  return text.empty() ? "" : fmt::format(" ({})", text);
}

// Upper bounds make a part of the factor in a bin.
bool factor_at_most(PredictedCoupling const& p, std::size_t i) {
  double const sigma = p.unresolved.empty() ? p.sigma[i] : 0;  // the error of the observed part hides no bound
  return results::at_most(p.factor[i], sigma, p.bound_share[i]);
}

std::string factor_text(PredictedCoupling const& p, std::size_t i) {
  if (!(p.factor[i] > 0)) return "unresolved";
  return factor_at_most(p, i) ? with_error(WithError{p.factor[i], p.sigma[i], true, !p.unresolved.empty()})
                              : plus_minus(p.factor[i], p.sigma[i]);
}

std::string share_text(PredictedRoute const& r) {
  if (!r.resolved) return "unresolved";
  return r.upper_bound ? with_error(WithError{100 * r.share, 0, true}) + " %" : fmt::format("{:.3g} %", 100 * r.share);
}

std::string linear_text(PredictOptions const& o, PredictedCoupling const& p, bool rotation) {
  char const* const unit = rotation ? "rad" : "m";
  if (p.routes.empty()) return fmt::format("no route moves with '{}'\n", o.body);
  std::string text =
      fmt::format("coupling of {} {} to h, mean over static phases, small motion{}\n", o.body, o.axis, bound_of(p));
  Columns curve{{"frequency", fmt::format("coupling [1/{}]", unit)}, {}, {}};
  for (double const f : told_frequencies(p.grid))
    curve.rows.push_back({fmt::format("{:.4g} Hz", f), factor_text(p, p.grid.bin_of(f))});
  Columns routes{
      {"route", "share", fmt::format("phase [rad/{}]", unit), "multiplicity", fmt::format("linear to [{} peak]", unit)},
      {true},
      {}};
  for (std::size_t i = 0; i < std::min(o.show, p.routes.size()); ++i) {
    PredictedRoute const& r = p.routes[i];
    routes.rows.push_back({r.name, share_text(r), fmt::format("{:.4g}", r.phase),
                           rotation ? "" : fmt::format("{:.3g}", r.multiplicity), fmt::format("{:.3g}", 1 / r.phase)});
  }
  text += aligned(curve) + aligned(routes);
  if (p.routes.size() > o.show)
    text += fmt::format("and {}: --show {}\n", counted(p.routes.size() - o.show, "more route"), p.routes.size());
  for (std::string const& u : p.unresolved) text += "unresolved: " + u + "\n";
  return text + fmt::format("linear up to {:.3g} {} peak\n", p.linear_to, unit);
}

std::string driven_text(DrivenResponse const& d, double peak, double hz, char const* unit) {
  return fmt::format("driven with {:.4g} {} peak at {:g} Hz: phase up to {:.3g} rad, {} {:.4g} Hz\n", peak, unit, hz,
                     d.phase_peak, d.phase_peak > 1 ? "fringe wrapped, shelf up to" : "linear; fastest fringe",
                     d.cutoff);
}

void add_curve(CurveSheet& sheet, std::string const& name, std::string const& unit, std::vector<double> const& value,
               std::vector<double> const& sigma, std::string const& style = "line") {
  CurveColumn mean{name, unit, {}, style}, low{name + "_low", unit, {}, "band-low"},
      high{name + "_high", unit, {}, "band-high"};
  for (std::size_t i = 0; i < value.size(); ++i) {
    bool const known = value[i] > 0;
    mean.values.push_back(known ? value[i] : not_a_number);
    low.values.push_back(known && value[i] > sigma[i] ? value[i] - sigma[i] : not_a_number);
    high.values.push_back(known ? value[i] + sigma[i] : not_a_number);
  }
  for (CurveColumn const& c : {mean, low, high}) sheet.y.push_back(c);
}

nlohmann::json routes_json(PredictedCoupling const& p) {
  nlohmann::json list = nlohmann::json::array();
  for (PredictedRoute const& r : p.routes)
    list.push_back({{"route", r.name},
                    {"share", number_or_null(r.resolved ? r.share : not_a_number)},
                    {"phase", r.phase},
                    {"multiplicity", r.multiplicity},
                    {"linear_to", 1 / r.phase},
                    {"resolved", r.resolved},
                    {"upper_bound", r.upper_bound},
                    {"why_not", r.why_not}});
  return list;
}

bool is_limit(OverlayPoint const& point) { return point.measured.flag == CouplingFlag::upper_limit; }

// Of a ratio of measured to predicted: it has an upper bound where the measured factor has one or routes are missing in
// the prediction, a lower bound where the prediction contains upper bounds.
std::string ratio_bound(bool limit, bool at_most, bool incomplete) { return bound_name(limit || incomplete, at_most); }

std::string bounded_ratio(double ratio, std::string const& bound) {
  if (bound.empty()) return fmt::format("{:.3g}", ratio);
  if (bound == "neither") return fmt::format("about {:.2g}", ratio);
  return bound == "upper" ? "at most " + two_digits(ratio, true) : "at least " + two_digits(ratio, false);
}

std::string bound_at(OverlayPoint const& point, PredictedCoupling const& p) {
  return ratio_bound(is_limit(point), factor_at_most(p, point.bin), !p.unresolved.empty());
}

std::string bound_of_mean(Overlay const& o, PredictedCoupling const& p) {
  bool const at_most = std::ranges::any_of(
      o.points, [&](OverlayPoint const& point) { return !is_limit(point) && factor_at_most(p, point.bin); });
  return ratio_bound(false, at_most, !p.unresolved.empty());
}

std::string overlay_text(Overlay const& o, PredictedCoupling const& predicted, std::size_t show) {
  Columns table{{"frequency", "measured [" + o.unit + "]", "predicted", "measured/predicted", "significance"}, {}, {}};
  std::size_t const step = std::max<std::size_t>(1, (o.points.size() + show - 1) / std::max<std::size_t>(1, show));
  for (std::size_t i = 0; i < o.points.size(); i += step) {
    OverlayPoint const& p = o.points[i];
    table.rows.push_back({fmt::format("{:g} Hz", p.measured.hz),
                          is_limit(p) ? "at most " + two_digits(p.measured.factor, true)
                                      : plus_minus(p.measured.factor, p.measured.sigma),
                          factor_text(predicted, p.bin), bounded_ratio(p.ratio, bound_at(p, predicted)),
                          std::isfinite(p.significance) ? fmt::format("{:.1f}", p.significance) : "unknown"});
  }
  std::string text = aligned(table);
  if (o.measured > 0) {
    double const mean = std::exp(o.mean_ratio);
    std::string const bound = bound_of_mean(o, predicted);
    text += fmt::format("measured over predicted: {} from {}, chi^2 {:.1f} of {}\n",
                        bound.empty() ? plus_minus(mean, mean * o.mean_sigma) : bounded_ratio(mean, bound),
                        counted(o.measured, "point"), o.chi_square, o.measured - 1);
  }
  if (o.above_limit > 0)
    text += fmt::format("the prediction exceeds {} by three sigma\n", counted(o.above_limit, "measured limit"));
  return text;
}

nlohmann::json overlay_json(Overlay const& o, PredictedCoupling const& predicted) {
  nlohmann::json points = nlohmann::json::array();
  for (OverlayPoint const& p : o.points)
    points.push_back({{"frequency", p.measured.hz},
                      {"measured", p.measured.factor},
                      {"measured_sigma", number_or_null(p.measured.sigma)},
                      {"flag", name_of(p.measured.flag)},
                      {"predicted", p.predicted},
                      {"predicted_sigma", p.predicted_sigma},
                      {"ratio", p.ratio},
                      {"bound", bound_at(p, predicted)},
                      {"significance", number_or_null(p.significance)}});
  return {{"points", points},
          {"unit", o.unit},
          {"mean_ratio", number_or_null(o.measured > 0 ? std::exp(o.mean_ratio) : not_a_number)},
          {"mean_ratio_sigma", number_or_null(std::exp(o.mean_ratio) * o.mean_sigma)},
          {"bound", bound_of_mean(o, predicted)},
          {"chi_square", o.chi_square},
          {"measured", o.measured},
          {"above_limit", o.above_limit}};
}

// Measured points and limits on the axis of the sheet.
void add_overlay(CurveSheet& sheet, Overlay const& o) {
  std::size_t const n = sheet.x.values.size();
  CurveColumn value{"measured", o.unit, std::vector<double>(n, not_a_number), "points"}, limit = value, sigma = value;
  limit.name = "measured_limit";
  limit.style = "upper-limit";
  sigma.name = "measured_sigma";
  sigma.style = "hidden";
  std::vector<OverlayPoint const*> const shown = points_by_bin(o, n);
  for (std::size_t i = 0; i < n; ++i) {
    if (shown[i] == nullptr) continue;
    CouplingPoint const& p = shown[i]->measured;
    bool const measured = p.flag == CouplingFlag::measured;
    (measured ? value : limit).values[i] = p.factor;
    if (measured) sigma.values[i] = p.sigma;
  }
  for (CurveColumn const& c : {value, limit, sigma}) sheet.y.push_back(c);
}

struct Prediction {
  CurveSheet sheet;
  std::string text;
  nlohmann::json result;
};

void add_motion(Prediction& out, PredictOptions const& o, RunFile const& file, ProjectionModel const& model,
                BodyAxis where, FrequencyGrid const& grid) {
  char const* const unit = where.axis > 2 ? "rad" : "m";
  CouplingTable const& table = file.trace.coupling;
  if (!o.amplitude.empty()) {
    double const peak = peak_of(o, where.axis > 2);
    if (o.frequency.empty()) throw InputError("--amplitude needs --frequency", "write --frequency \"0.5 Hz\"");
    double const hz = option_quantity(o.frequency, dim::frequency, "--frequency", "0.5 Hz");
    if (!(hz > 0)) throw InputError("--frequency: it is not positive", "write --frequency \"0.5 Hz\"");
    DrivenResponse const d = drive_body(table, model.motion.bodies, *model.detector, grid, where, peak, hz);
    add_curve(out.sheet, "h_driven", "1/sqrt(Hz)", d.budget.total.asd, d.budget.total.sigma,
              "points");  // lines without a continuum
    out.text += driven_text(d, peak, hz, unit);
    for (DrivenRoute const& r : d.routes)
      out.result["driven"].push_back({{"route", r.name}, {"phase_peak", r.phase_peak}, {"shelf_edge", r.cutoff}});
  }
  if (o.own) {
    NoiseSettings settings;
    settings.grid = grid;
    NoiseBudget const b = project_noise(table, motion_along(model.motion, where), *model.detector, settings);
    double const rms = rms_of(model.motion, where);
    add_curve(out.sheet, "h_own_motion", "1/sqrt(Hz)", b.total.asd, b.total.sigma);
    out.text += fmt::format("its own motion has {:.3g} {} rms\n", rms, unit);
    out.result["own_motion_rms"] = rms;
  }
}

int run_predict(PredictOptions const& o) {
  check_outputs(o.data);
  OpenRun const run(o.run);
  RunFile const& file = run.file;
  ProjectionModel const& model = run.model;
  if (!model.detector)
    throw InputError("the run has no interferometer, so there is no coupling to h",
                     "trace a scene with 'interferometer'");
  BodyAxis const where = place_of(o, model.motion.bodies);
  FrequencyGrid const grid = grid_of(o, model);
  PredictedCoupling const p = predict_coupling(file.trace.coupling, model.motion.bodies, *model.detector, grid, where);
  std::string const unit = where.axis > 2 ? "1/rad" : "1/m";
  Prediction out;
  out.sheet.title = fmt::format("coupling of {} {} to h", o.body, o.axis);
  out.sheet.notes = {"predicted by the coupling table: mean over static phases, small motion; one Monte-Carlo sigma"};
  out.sheet.x = {"frequency", "Hz", {}};
  for (std::size_t i = 0; i < grid.size(); ++i) out.sheet.x.values.push_back(grid.centre(i));
  if (std::string const bound = bound_of(p); !bound.empty()) out.sheet.notes.push_back("predicted" + bound);
  add_curve(out.sheet, "predicted", unit, p.factor, p.sigma);
  out.text = linear_text(o, p, where.axis > 2);
  out.result = {{"body", o.body},           {"axis", o.axis},
                {"linear_to", p.linear_to}, {"bound", bound_name(p.has_bounds(), !p.unresolved.empty())},
                {"routes", routes_json(p)}, {"unresolved", p.unresolved}};
  add_motion(out, o, file, model, where, grid);
  if (!o.measured.empty()) {
    std::vector<bool> at_most;
    for (std::size_t i = 0; i < grid.size(); ++i) at_most.push_back(factor_at_most(p, i));
    Overlay const overlay = overlay_of(parse_coupling(read_text(o.measured), o.measured, o.unit, o.witness_unit),
                                       {grid.edges, p.factor, p.sigma, unit, at_most});
    add_overlay(out.sheet, overlay);
    out.text += overlay_text(overlay, p, o.show);
    out.result["measured"] = overlay_json(overlay, p);
  }
  answer_with_result(o.data, out.sheet, out.text, out.result);
  return 0;
}

}  // namespace

void add_couple_predict(CLI::App& couple, int& exit_code) {
  auto* const command = couple.add_subcommand("predict", "Predict the coupling of a body to h from a traced run.");
  auto const options = std::make_shared<PredictOptions>();
  PredictOptions& o = *options;
  command->add_option("run", o.run, "run file (HDF5)")->required();
  command->add_option("--body", o.body, "body that moves; all others are at rest")->required();
  command->add_option("--axis", o.axis, "x, y, z, or rotations rx, ry, rz about its pivot")
      ->default_str("z")
      ->check(CLI::IsMember(std::vector<std::string>(axes.begin(), axes.end())));
  command->add_option("--amplitude", o.amplitude,
                      "amplitude of a sine, with its kind: \"2 um peak\"; needs --frequency");
  command->add_option("--frequency", o.frequency, "frequency of that sine: \"0.5 Hz\"");
  command->add_flag("--own-motion", o.own, "also the response to the body's own motion along this axis");
  add_band_option(*command, o.data, "LOW..HIGH; default: of the run");
  command->add_option("--points-per-decade", o.points, "default: bins of the run, 60 with --band")
      ->check(number_between(1.0, 10000.0, "60"));
  command->add_option("--measured", o.measured, "CSV of pemcoupling to compare: ratio and significance")
      ->check(CLI::ExistingFile);
  command->add_option("--coupling-unit", o.unit, "unit of the measured factor, where the file has none: 1/m");
  command->add_option("--witness-unit", o.witness_unit, "unit of its witness, where the file has none: m");
  command->add_option("--show", o.show, "rows of the tables")->default_str("8")->check(whole_between(1, 1e6, "20"));
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple predict demo/run.h5 --body tube --axis z\n"
      "  straytrace couple predict demo/run.h5 --body tube --axis z --amplitude \"2 um peak\" --frequency \"0.5 Hz\" "
      "-o "
      "tube.png");
  command->callback([options, &exit_code] { exit_code = run_predict(*options); });
}

}  // namespace straytrace::cli
