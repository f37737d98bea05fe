// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple lines: a driven line and its harmonics.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/fringes/fringe_lines.hpp"
#include "base/errors.hpp"
#include "cli/couple/couple_data.hpp"
#include "results/text/columns.hpp"

namespace straytrace::cli {
namespace {

struct LineAmplitude {
  double value = 0, sigma = not_a_number;  // an upper limit has no error
  bool limit = false;
};

std::string text(LineAmplitude const& a) {
  return a.limit ? fmt::format("<= {:.3g}", a.value) : plus_minus(a.value, a.sigma);
}

LineAmplitude amplitude_of(Harmonic const& h) {
  if (!h.seen) return {h.limit, not_a_number, true};
  double const a = std::sqrt(h.power);
  return {a, h.sigma / (2 * a)};
}

LineAmplitude over(LineAmplitude const& a, LineAmplitude const& b) {
  double const ratio = a.value / b.value;
  return {ratio, a.limit ? not_a_number : ratio * std::hypot(a.sigma / a.value, b.sigma / b.value), a.limit};
}

// Mean over the windows; its error is the spread.
LineAmplitude mean_drive(std::vector<LinePoint> const& points) {
  double const n = double(points.size());
  double mean = 0, square = 0;
  for (LinePoint const& p : points) mean += std::abs(p.amplitude) / n;
  for (LinePoint const& p : points) square += std::pow(std::abs(p.amplitude) - mean, 2) / n;
  return {mean, std::sqrt(square / std::max(1.0, n - 1))};
}

HarmonicFit fit_of(Driven const& d, LineOptions const& o) {
  int const orders = std::min(o.harmonics, int(std::floor(0.49 * d.pair.target.rate / d.frequency())));
  if (orders < 3)
    throw InputError(
        fmt::format("at {:g} Hz the target has no third harmonic of {:.4g} Hz", d.pair.target.rate, d.frequency()),
        "give a higher sample rate");
  std::vector<std::vector<LinePoint>> harmonics;
  for (int n = 1; n <= orders; ++n) harmonics.push_back(follow_line(d.pair.target, d.drive, d.window, n));
  return fit_harmonics(harmonics, o.z_max);
}

std::string verdict(Driven const& d, LineOptions const& o, HarmonicFit const& f) {
  auto const metres = [&](double z) { return motion_of_phase(z, d.wavelength, o.multiplicity); };
  if (f.limit_only && f.open) return "no harmonic distinguishes a fringe from a line\n";
  if (f.limit_only)
    return fmt::format(
        "linear within the sensitivity of the harmonics: phase amplitude below {:.3g} rad, effective motion below "
        "{:.3g} m peak (95 %)\n",
        f.z_limit, metres(f.z_limit));
  double const sigma = (f.z_high - f.z_low) / 2;
  std::string out = fmt::format("fringe at {:.1f} sigma: phase amplitude {} rad, effective motion {} m peak\n",
                                f.significance, plus_minus(f.z, sigma), plus_minus(metres(f.z), metres(sigma)));
  for (double const z : f.others) out += fmt::format("  {:.3g} rad, {:.3g} m fits as well\n", z, metres(z));
  return out + fmt::format(
                   "G |cos phi_0| {:.3g}, G |sin phi_0| {:.3g}{}; chi^2 {:.1f} of {} degrees; lambda {:g} nm, "
                   "multiplicity {:g}\n",
                   f.odd, f.even, d.pair.target.unit == "1" ? "" : " " + d.pair.target.unit, f.chi_square, f.degrees,
                   d.wavelength * 1e9, o.multiplicity);
}

nlohmann::json json_of(Driven const& d, LineOptions const& o, HarmonicFit const& f, LineAmplitude const& coupling) {
  nlohmann::json list = nlohmann::json::array();
  LineAmplitude const first = amplitude_of(f.harmonics[0]);
  for (Harmonic const& h : f.harmonics) {
    LineAmplitude const a = amplitude_of(h), ratio = over(a, first);
    list.push_back({{"order", h.order},
                    {"amplitude", a.value},
                    {"sigma", number_or_null(a.sigma)},
                    {"upper_limit", a.limit},
                    {"over_first", number_or_null(first.limit ? not_a_number : ratio.value)},
                    {"over_first_sigma", number_or_null(first.limit ? not_a_number : ratio.sigma)}});
  }
  bool const known = !f.limit_only;
  return {{"frequency", d.frequency()},
          {"drive_unit", d.unit},
          {"coupling", coupling.value},
          {"coupling_sigma", number_or_null(coupling.sigma)},
          {"coupling_unit", d.coupling_unit},
          {"upper_limit", coupling.limit},
          {"harmonics", list},
          {"verdict", known ? "fringe" : "linear"},
          {"z", number_or_null(known ? f.z : not_a_number)},
          {"z_low", number_or_null(known ? f.z_low : not_a_number)},
          {"z_high", number_or_null(known ? f.z_high : not_a_number)},
          {"z_limit", number_or_null(f.open ? not_a_number : f.z_limit)},
          {"significance", f.significance},
          {"other_z", f.others},
          {"motion", number_or_null(known ? motion_of_phase(f.z, d.wavelength, o.multiplicity) : not_a_number)}};
}

int run_lines(LineOptions const& o) {
  check_outputs(o.data);
  Driven const d = follow_drive(o);
  HarmonicFit const f = fit_of(d, o);
  LineAmplitude const first = amplitude_of(f.harmonics[0]), drive = mean_drive(d.drive), coupling = over(first, drive);
  Columns table{{"harmonic", "frequency", "amplitude [" + d.pair.target.unit + "]", "over the first"}, {}, {}};
  for (Harmonic const& h : f.harmonics)
    table.rows.push_back({std::to_string(h.order), fmt::format("{:.4g} Hz", h.order * d.frequency()),
                          text(amplitude_of(h)), first.limit ? "" : text(over(amplitude_of(h), first))});
  table.rows[0][3] = "1";
  std::string const said = fmt::format("{}: {:.5g} Hz, {} {} peak, {} windows of {:g} s\ncoupling at the line {} {}\n",
                                       d.pair.witness.name, d.frequency(), fmt::format("{:.4g}", drive.value), d.unit,
                                       d.drive.size(), d.window, text(coupling), d.coupling_unit) +
                           aligned(table) + verdict(d, o, f);
  answer_with_result(o.data, line_sheet(d), said, json_of(d, o, f, coupling));
  return 0;
}

}  // namespace

void add_couple_lines(CLI::App& couple, int& exit_code) {
  auto* const command = couple.add_subcommand(
      "lines", "Measure the coupling of a driven line, and compare its harmonics with Bessel ratios.");
  auto const options = std::make_shared<LineOptions>();
  LineOptions& o = *options;
  add_line_options(*command, o);
  command->add_option("--harmonics", o.harmonics, "number of harmonics, including the line itself")
      ->default_str("5")
      ->check(CLI::Range(3, 100));
  add_couple_outputs(*command, o.data);
  command->footer(
      "Examples:\n"
      "  straytrace couple lines --witness examples/data/shaker.csv::DRIVE --target examples/data/shaker.csv::H --band "
      "\"9 Hz..11 Hz\" --gps 20..28 --window \"1 s\"\n"
      "  straytrace couple lines --witness examples/data/shaker.csv::DRIVE --target examples/data/shaker.csv::H --band "
      "\"9 Hz..11 Hz\" --window \"1 s\" --multiplicity 2 --format json");
  command->callback([options, &exit_code] { exit_code = run_lines(*options); });
}

// straytrace couple ramp: whether a driven line is linear in its drive or fringe-wrapped.

namespace {

using RampOutcome = RampFit::Verdict;

char const* word(RampOutcome v) {
  switch (v) {
    case RampOutcome::linear:
      return "linear";
    case RampOutcome::fringe:
      return "fringe";
    case RampOutcome::neither:
      return "neither";
    case RampOutcome::unseen:
      return "unseen";
  }
  return "";
}

double limit_of(RampFit const& r) { return r.slope + 1.645 * r.slope_sigma; }  // 95 %

std::string text_of(Driven const& d, LineOptions const& o, RampFit const& r) {
  auto const metres = [&](double z) { return motion_of_phase(z, d.wavelength, o.multiplicity); };
  double most = 0;
  for (LinePoint const& p : d.drive) most = std::max(most, std::abs(p.amplitude));
  std::string out = fmt::format("{}: {:.5g} Hz, up to {:.3g} {} peak, {} windows of {:g} s\n", d.pair.witness.name,
                                d.frequency(), most, d.unit, d.drive.size(), d.window);
  out += fmt::format(
      "straight line: {} {}, chi^2 {:.1f} of {}\nfringe J_1: chi^2 {:.1f} of {}, better by {:.1f} sigma\n",
      r.verdict == RampOutcome::unseen ? fmt::format("<= {:.3g}", limit_of(r)) : plus_minus(r.slope, r.slope_sigma),
      d.coupling_unit, r.chi_linear, r.degrees_linear, r.chi_fringe, r.degrees_fringe, r.significance);
  if (r.verdict == RampOutcome::unseen)
    return out + "outcome: no line of the target at the drive frequency; the coupling is an upper limit (95 %)\n";
  if (r.verdict == RampOutcome::linear)
    return out + (r.open
                      ? "outcome: linear\n"
                      : fmt::format("outcome: linear; phase amplitude at the largest drive below {:.3g} rad, effective "
                                    "motion below {:.3g} m peak (95 %)\n",
                                    r.z_limit, metres(r.z_limit)));
  if (r.verdict == RampOutcome::neither)
    return out +
           "outcome: neither: the target is not explained by the drive; the cause may be a drifting static phase or "
           "another source\n";
  double const sigma = (r.z_high - r.z_low) / 2;
  return out + fmt::format(
                   "outcome: fringe; phase amplitude at the largest drive {} rad, effective motion {} m peak, "
                   "coupling of small motion {:.3g} {}\n",
                   plus_minus(r.z, sigma), plus_minus(metres(r.z), metres(sigma)), r.small_slope, d.coupling_unit);
}

CurveSheet sheet_of(Driven const& d, RampFit const& r) {
  CurveSheet sheet = line_sheet(d);
  sheet.title = fmt::format("ramp of {} in {}", d.pair.witness.name, d.pair.target.name);
  sheet.notes.push_back(fmt::format("outcome: {}, fringe better by {:.2f} sigma", word(r.verdict), r.significance));
  CurveColumn line{"linear", d.pair.target.unit, {}}, time{"time", "s", sheet.x.values, "hidden"};
  sheet.x = sheet.y[1];
  sheet.x.style = "line";
  for (double const a : sheet.x.values) line.values.push_back(r.slope * a);
  CurveColumn fringe{"fringe", d.pair.target.unit, {}};
  double const most = *std::max_element(sheet.x.values.begin(), sheet.x.values.end());
  for (double const a : sheet.x.values) {
    double const z = r.z * a / most;
    fringe.values.push_back(r.small_slope * a * std::fabs(2 * std::cyl_bessel_j(1, z) / z));
  }
  sheet.y = {time, sheet.y[0], sheet.y[2], sheet.y[3], line};
  sheet.y[2].style = "points";
  if (r.verdict == RampOutcome::fringe) sheet.y.push_back(std::move(fringe));
  sheet.log_x = true;
  return sheet;
}

// The coupling at the line with the outcome as its flag, for the projection.
CouplingFunction coupling_of(Driven const& d, RampFit const& r) {
  CouplingPoint p;
  p.hz = d.frequency();
  p.significance = r.slope / r.slope_sigma;
  if (r.verdict == RampOutcome::unseen) {
    p.flag = CouplingFlag::upper_limit;
    p.factor = limit_of(r);
    return {d.pair.witness.name, d.pair.target.name, d.unit, d.coupling_unit, {p}};
  }
  p.factor = r.verdict == RampOutcome::linear ? r.slope : r.small_slope;
  p.sigma = r.verdict == RampOutcome::linear ? r.slope_sigma : not_a_number;
  p.flag = r.verdict == RampOutcome::linear ? CouplingFlag::measured : CouplingFlag::not_linear;
  return {d.pair.witness.name, d.pair.target.name, d.unit, d.coupling_unit, {p}};
}

int run_ramp(LineOptions const& o) {
  check_outputs(o.data);
  Driven const d = follow_drive(o);
  RampFit const r = fit_ramp(d.drive, d.target, o.significance, o.z_max);
  bool const fringe = r.verdict == RampOutcome::fringe, unseen = r.verdict == RampOutcome::unseen;
  auto const metres = [&](double z) { return motion_of_phase(z, d.wavelength, o.multiplicity); };
  answer_with_result(o.data, sheet_of(d, r), text_of(d, o, r),
                     {{"verdict", word(r.verdict)},
                      {"significance", r.significance},
                      {"frequency", d.frequency()},
                      {"slope", unseen ? limit_of(r) : r.slope},
                      {"slope_sigma", number_or_null(unseen ? not_a_number : r.slope_sigma)},
                      {"upper_limit", unseen},
                      {"unit", d.coupling_unit},
                      {"chi_square_linear", r.chi_linear},
                      {"chi_square_fringe", r.chi_fringe},
                      {"points", d.drive.size()},
                      {"z", number_or_null(fringe ? r.z : not_a_number)},
                      {"z_low", number_or_null(fringe ? r.z_low : not_a_number)},
                      {"z_high", number_or_null(fringe ? r.z_high : not_a_number)},
                      {"z_limit", number_or_null(r.open ? not_a_number : r.z_limit)},
                      {"motion", number_or_null(fringe ? metres(r.z) : not_a_number)}});
  save_coupling(o.save, coupling_of(d, r), o.data.quiet);
  return 0;
}

}  // namespace

void add_couple_ramp(CLI::App& couple, int& exit_code) {
  auto* const command =
      couple.add_subcommand("ramp", "Distinguish linear from fringe coupling with a growing drive, with significance.");
  auto const options = std::make_shared<LineOptions>();
  LineOptions& o = *options;
  add_line_options(*command, o);
  command->add_option("--significance", o.significance, "threshold for a fringe, standard deviations")
      ->default_str("3")
      ->check(CLI::Range(0.0, 37.0));
  command->add_option("--save", o.save, "CSV of pemcoupling with the outcome as flag, for straytrace project");
  add_couple_outputs(*command, o.data);
  command->footer(
      "Examples:\n"
      "  straytrace couple ramp --witness examples/data/shaker.csv::DRIVE --target examples/data/shaker.csv::H --band "
      "\"9 Hz..11 Hz\" --window \"1 s\"\n"
      "  straytrace couple ramp --witness examples/data/shaker.csv::DRIVE --target examples/data/shaker.csv::H --band "
      "\"9 Hz..11 Hz\" --window \"1 s\" --significance 5 -o ramp.png --save line.csv");
  command->callback([options, &exit_code] { exit_code = run_ramp(*options); });
}

}  // namespace straytrace::cli
