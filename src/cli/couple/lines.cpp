// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple lines: a driven line and its harmonics.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/fringes/fringe_lines.hpp"
#include "base/errors.hpp"
#include "cli/couple/couple.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"

namespace straytrace::cli {
namespace {

struct LineOptions {
  DataOptions data;
  PairOptions pair;
  std::string window = "4 s", wavelength = "1064 nm", save;
  double multiplicity = 1, z_max = 20, significance = 3;
  int harmonics = 5;
};
struct Driven {
  ChannelPair pair;
  std::vector<LinePoint> drive, target;  // drive in `unit`
  double window = 0, wavelength = 0;     // s, m
  std::string unit, coupling_unit;

  double frequency() const {  // Hz, mean
    double sum = 0;
    for (LinePoint const& p : drive) sum += p.hz / double(drive.size());
    return sum;
  }
};
// All but --harmonics, --save, --significance and outputs.
void add_line_options(CLI::App& command, LineOptions& o) {
  add_pair_options(command, o.pair, "FILE::CHANNEL of the drive: motion, force or sound");
  add_band_option(command, o.data, "LOW..HIGH that contains the driven line: \"18 Hz..22 Hz\"");
  add_gps_options(command, o.data.gps, o.data.segments);
  command.add_option("--window", o.window, "length of the windows")->default_str(o.window);
  command.add_option("--wavelength", o.wavelength, "of the light")->default_str(o.wavelength);
  command.add_option("--multiplicity", o.multiplicity, "bounces off the moving surface: phase over 4 pi x/lambda")
      ->default_str("1")
      ->check(number_between(1e-3, 1e6, "2"));
  command.add_option("--z-max", o.z_max, "largest phase amplitude searched, rad")
      ->default_str("20")
      ->check(number_between(0.1, 1000.0, "20"));
}

Driven follow_drive(LineOptions const& o) {
  if (o.data.band.empty())
    throw InputError("--band is missing: it must contain the driven line", "write --band \"18 Hz..22 Hz\"");
  FrequencyBand const band = option_band(o.data.band, "--band");
  Driven d;
  d.window = option_quantity(o.window, dim::time, "--window", "4 s");
  d.wavelength = positive_quantity(o.wavelength, dim::length, "--wavelength", "1064 nm");
  d.pair = read_pair(o.pair, span_of(o.data));
  d.drive = track_line(d.pair.witness, {band.low, band.high, d.window});
  d.target = follow_line(d.pair.target, d.drive, d.window);
  ToMetres const metres = to_metres(o.pair.displacement, d.pair.witness.unit);
  in_metres(metres, d.drive);
  d.unit = metres.unit;
  d.coupling_unit = coupling_unit(d.pair.target.unit, d.unit);
  return d;
}

// Frequency, drive and target against time.
CurveSheet line_sheet(Driven const& d) {
  CurveSheet sheet;
  sheet.title = fmt::format("line of {} in {}", d.pair.witness.name, d.pair.target.name);
  sheet.notes = {source_note(d.pair.witness), source_note(d.pair.target),
                 fmt::format("Hann windows of {:g} s, half overlap; amplitudes are peak", d.window)};
  sheet.x = {"time", "s", {}};
  sheet.log_x = false;
  CurveColumn hz{"frequency", "Hz", {}, "hidden"}, drive{"drive", d.unit, {}, "hidden"},
      target{"target", d.pair.target.unit, {}}, sigma{"target_sigma", d.pair.target.unit, {}, "hidden"};
  for (std::size_t i = 0; i < d.drive.size(); ++i) {
    sheet.x.values.push_back(d.drive[i].time);
    hz.values.push_back(d.drive[i].hz);
    drive.values.push_back(std::abs(d.drive[i].amplitude));
    target.values.push_back(std::abs(d.target[i].amplitude));
    sigma.values.push_back(d.target[i].sigma);
  }
  sheet.y = {hz, drive, target, sigma};
  return sheet;
}

std::string text(LineAmplitude const& a) {
  return a.limit ? fmt::format("<= {:.3g}", a.value) : plus_minus(a.value, a.sigma);
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
  HarmonicFit const f = fit_harmonics(d.pair.target, d.drive, d.window, o.harmonics, o.z_max);
  LineAmplitude const first = amplitude_of(f.harmonics[0]), drive = mean_amplitude(d.drive),
                      coupling = over(first, drive);
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
      ->check(whole_between(3, 100, "5"));
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
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

std::string text_of(Driven const& d, LineOptions const& o, RampFit const& r) {
  auto const metres = [&](double z) { return motion_of_phase(z, d.wavelength, o.multiplicity); };
  double most = 0;
  for (LinePoint const& p : d.drive) most = std::max(most, std::abs(p.amplitude));
  std::string out = fmt::format("{}: {:.5g} Hz, up to {:.3g} {} peak, {} windows of {:g} s\n", d.pair.witness.name,
                                d.frequency(), most, d.unit, d.drive.size(), d.window);
  out += fmt::format(
      "straight line: {} {}, chi^2 {:.1f} of {}\nfringe J_1: chi^2 {:.1f} of {}, better by {:.1f} sigma\n",
      r.verdict == RampOutcome::unseen ? fmt::format("<= {:.3g}", r.limit()) : plus_minus(r.slope, r.slope_sigma),
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
                      {"slope", unseen ? r.limit() : r.slope},
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
  save_coupling(o.save,
                {d.pair.witness.name, d.pair.target.name, d.unit, d.coupling_unit, {coupling_at(r, d.frequency())}},
                o.data.quiet);
  return 0;
}

}  // namespace

void add_couple_ramp(CLI::App& couple, int& exit_code) {
  auto* const command =
      couple.add_subcommand("ramp", "Distinguish linear from fringe coupling with a growing drive, with significance.");
  auto const options = std::make_shared<LineOptions>();
  LineOptions& o = *options;
  add_line_options(*command, o);
  add_significance_option(*command, o.significance, "threshold for a fringe, standard deviations");
  mark_output(*command, *command->add_option("--save", o.save,
                                             "CSV of pemcoupling with the outcome as flag, for straytrace project"));
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple ramp --witness examples/data/shaker.csv::DRIVE --target examples/data/shaker.csv::H --band "
      "\"9 Hz..11 Hz\" --window \"1 s\"\n"
      "  straytrace couple ramp --witness examples/data/shaker.csv::DRIVE --target examples/data/shaker.csv::H --band "
      "\"9 Hz..11 Hz\" --window \"1 s\" --significance 5 -o ramp.png --save line.csv");
  command->callback([options, &exit_code] { exit_code = run_ramp(*options); });
}

}  // namespace straytrace::cli
