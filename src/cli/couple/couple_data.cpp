// SPDX-License-Identifier: BSD-3-Clause
#include "cli/couple/couple_data.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"
#include "session/build_info.hpp"
#include "spectra/files/gps.hpp"
#include "spectra/files/series_file.hpp"
#include "spectra/integration.hpp"

namespace straytrace::cli {

void add_pair_options(CLI::App& command, PairOptions& o, char const* witness) {
  command.add_option("--witness", o.witness, witness)->required();
  command.add_option("--target", o.target, "FILE::CHANNEL of strain, or of another disturbed signal")->required();
  command.add_option("--witness-unit", o.witness_unit,
                     "unit, where the file has none: m/s^2; of counts the calibration: \"2e-6 m/s^2\"");
  command.add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  command.add_flag("--displacement", o.displacement, "convert the witness from m/s^2 or m/s to m");
}

void add_couple_outputs(CLI::App& command, DataOptions& o) {
  command
      .add_option("-o,--out", o.out, "file to write, by its ending: .txt .csv .hdf5 .json .png .html; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--format", o.format, "text or json")->check(CLI::IsMember({"text", "json"}));
  command.add_flag("--silent", o.quiet, "results only");
}

ChannelPair read_pair(PairOptions const& o, GpsSpan span) {
  auto both =
      aligned({series_argument(o.witness, o.witness_unit, span), series_argument(o.target, o.target_unit, span)});
  return {std::move(both[0]), std::move(both[1])};
}

StretchArgument parse_stretch(std::string const& text, std::string const& option) {
  StretchArgument a;
  auto const at = text.rfind('@');
  std::string const head = at == text.npos ? text : text.substr(0, at);
  if (at != text.npos) a.span = parse_gps(text.substr(at + 1));
  if (at == text.npos && head.find("..") != head.npos && head.find_first_of("0123456789") == 0) {
    a.span = parse_gps(head);
    return a;
  }
  auto const colons = head.find("::");
  a.file = head.substr(0, colons);
  if (colons != head.npos) a.channel = head.substr(colons + 2);
  if (a.file.empty())
    throw InputError(fmt::format("{}: '{}' is not a stretch", option, text),
                     fmt::format("write {} 1000000000..1000000060, or a file", option));
  return a;
}

TimeSeries channel_in(StretchArgument const& stretch, std::string const& channel, std::string const& unit,
                      std::string const& option) {
  if (channel.find("::") != channel.npos) return series_argument(channel, unit, stretch.span);
  std::string const file = stretch.file.empty() ? channel : stretch.file;
  if (file.empty())
    throw InputError(fmt::format("{} is missing", option), fmt::format("write {} FILE::CHANNEL", option));
  return series_argument(stretch.file.empty() || channel.empty() ? file : file + "::" + channel, unit, stretch.span);
}

void refuse_overlaps(std::vector<FoundStretch> const& all) {
  constexpr double surely_gps = 1e8;  // s; other files count from 0
  std::vector<InputError> errors;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      FoundStretch const &a = all[j], &b = all[i];
      double const from = std::max(a.from, b.from), to = std::min(a.to, b.to);
      if (to <= from || (a.file != b.file && from < surely_gps)) continue;
      errors.emplace_back(
          fmt::format("{} and {} share the time from {} to {}", a.name, b.name, gps_text(from), gps_text(to)),
          "name stretches that do not overlap");
    }
  throw_all(errors);
}

ToMetres to_metres(bool displacement, std::string const& unit) {
  if (!displacement) return {0, 1, unit};
  auto const known = parse_unit(unit);
  return {integrations_to_displacement(unit), known ? known->si : 1, "m"};
}

double factor_at(ToMetres const& m, double hz) { return m.scale / std::pow(2 * pi * hz, m.times); }

void in_metres(ToMetres const& m, std::vector<LinePoint>& points) {
  for (LinePoint& p : points) {
    p.amplitude *= factor_at(m, p.hz);
    p.sigma *= factor_at(m, p.hz);
  }
}

void answer_with_result(DataOptions const& o, CurveSheet const& sheet, std::string const& text,
                        nlohmann::json const& result) {
  if (!o.json()) return write_and_print(o, sheet, text);
  CurveSheet whole = sheet;
  whole.notes.push_back(fmt::format("straytrace {} ({})", build_info::version, build_info::commit));
  nlohmann::json all = nlohmann::json::parse(curve_json(whole));
  all["result"] = result;
  write_and_print(o, sheet, all.dump(1) + '\n');
}

std::vector<CurveColumn> coupling_columns(CouplingFunction const& c, std::string const& prefix) {
  CurveColumn value{prefix + "coupling", c.unit, {}, "points"}, low{prefix + "coupling_low", c.unit, {}, "band-low"},
      high{prefix + "coupling_high", c.unit, {}, "band-high"}, limit{prefix + "upper_limit", c.unit, {}, "upper-limit"},
      wrapped{prefix + "fringe_wrapped", c.unit, {}, "points"};
  std::vector<CurveColumn> seen{{prefix + "witness_ratio", "1", {}, "hidden"},
                                {prefix + "target_ratio", "1", {}, "hidden"},
                                {prefix + "significance", "1", {}, "hidden"},
                                {prefix + "coherence", "1", {}, "hidden"}};
  for (CouplingPoint const& p : c.points) {
    bool const measured = p.flag == CouplingFlag::measured;
    value.values.push_back(measured ? p.factor : not_a_number);
    low.values.push_back(measured && p.factor > p.sigma ? p.factor - p.sigma : not_a_number);
    high.values.push_back(measured ? p.factor + p.sigma : not_a_number);
    limit.values.push_back(p.flag == CouplingFlag::upper_limit ? p.factor : not_a_number);
    wrapped.values.push_back(p.flag == CouplingFlag::not_linear ? p.factor : not_a_number);
    double const also[] = {p.witness_ratio, p.target_ratio, p.significance, p.coherence};
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i].values.push_back(also[i]);
  }
  std::vector<CurveColumn> all{value, low, high, limit, wrapped};
  all.insert(all.end(), seen.begin(), seen.end());
  return all;
}

std::string band_text(BandCoupling const& w, std::string const& unit) {
  std::string const rise = fmt::format("witness x {:.3g}, target x {:.3g}", w.witness_ratio, w.target_ratio);
  if (std::isnan(w.factor)) return rise + ", no clear rise of both";
  std::string text = fmt::format(
      "{} {} (C.13; {}), valid where slow motion of the same surface spreads the noise of fast motion; the quiet "
      "witness explains {:.0f} % of the power of the quiet target",
      plus_minus(w.factor, w.sigma), unit, rise, 100 * w.share);
  if (!w.rises_at_low && !w.rises_at_high) return text;
  return text + fmt::format("; the target rises at {} of the band too: choose a wider band",
                            w.rises_at_low && w.rises_at_high ? "both ends"
                            : w.rises_at_low                  ? "the low end"
                                                              : "the high end");
}

void save_coupling(std::string const& file, CouplingFunction const& c, bool quiet) {
  if (file.empty()) return;
  write_files({{file, coupling_csv(c)}});
  if (!quiet) std::cerr << fmt::format("wrote {}\n", file);
}

nlohmann::json number_or_null(double v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr); }

std::string plus_minus(double value, double sigma) {
  return std::isfinite(sigma) && sigma > 0 ? with_error(value, sigma) : fmt::format("{:.3g}", value);
}

void add_line_options(CLI::App& command, LineOptions& o) {
  add_pair_options(command, o.pair, "FILE::CHANNEL of the drive: motion, force or sound");
  add_band_option(command, o.data, "LOW..HIGH that contains the driven line: \"18 Hz..22 Hz\"");
  command.add_option("--gps", o.data.gps, "stretch A..B in GPS seconds or UTC; default: all");
  command.add_option("--window", o.window, "length of the windows")->default_str(o.window);
  command.add_option("--wavelength", o.wavelength, "of the light")->default_str(o.wavelength);
  command.add_option("--multiplicity", o.multiplicity, "bounces off the moving surface: phase over 4 pi x/lambda")
      ->default_str("1")
      ->check(CLI::Range(1e-3, 1e6));
  command.add_option("--z-max", o.z_max, "largest phase amplitude searched, rad")
      ->default_str("20")
      ->check(CLI::Range(0.1, 1000.0));
}

Driven follow_drive(LineOptions const& o) {
  if (o.data.band.empty())
    throw InputError("--band is missing: it must contain the driven line", "write --band \"18 Hz..22 Hz\"");
  FrequencyBand const band = option_band(o.data.band, "--band");
  Driven d;
  d.window = option_quantity(o.window, dim::time, "--window", "4 s");
  d.wavelength = option_quantity(o.wavelength, dim::length, "--wavelength", "1064 nm");
  d.pair = read_pair(o.pair, span_of(o.data));
  d.drive = track_line(d.pair.witness, {band.low, band.high, d.window});
  d.target = follow_line(d.pair.target, d.drive, d.window);
  ToMetres const metres = to_metres(o.pair.displacement, d.pair.witness.unit);
  in_metres(metres, d.drive);
  d.unit = metres.unit;
  d.coupling_unit = coupling_unit(d.pair.target.unit, d.unit);
  return d;
}

double Driven::frequency() const {
  double sum = 0;
  for (LinePoint const& p : drive) sum += p.hz / double(drive.size());
  return sum;
}

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

}  // namespace straytrace::cli
