// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple lines: a driven line and its harmonics.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "app/couple_driven.hpp"
#include "base/message.hpp"
#include "commission/fringe_lines.hpp"
#include "report/columns.hpp"

namespace straytrace {
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
        fmt::format("error: at {:g} Hz the target has no third harmonic of {:.4g} Hz\n  give it at a higher "
                    "rate",
                    d.pair.target.rate, d.frequency()));
  std::vector<std::vector<LinePoint>> harmonics;
  for (int n = 1; n <= orders; ++n) harmonics.push_back(follow_line(d.pair.target, d.drive, d.window, n));
  return fit_harmonics(harmonics, o.z_max);
}

std::string verdict(Driven const& d, LineOptions const& o, HarmonicFit const& f) {
  auto const metres = [&](double z) { return motion_of_phase(z, d.wavelength, o.multiplicity); };
  if (f.limit_only && f.open) return "no harmonic tells a fringe from a line\n";
  if (f.limit_only)
    return fmt::format(
        "linear as far as harmonics tell: phase amplitude below {:.3g} rad, effective motion below {:.3g} m "
        "peak (95 %)\n",
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
  auto* const command = couple.add_subcommand("lines", "a driven line: coupling, harmonics against Bessel ratios");
  auto const options = std::make_shared<LineOptions>();
  LineOptions& o = *options;
  add_line_options(*command, o);
  command->add_option("--harmonics", o.harmonics, "how many, the line itself counted")
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

}  // namespace straytrace
