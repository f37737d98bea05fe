// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple: from injections to coupling functions.
#include "cli/couple/couple.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iostream>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/results.hpp"
#include "session/build_info.hpp"
#include "spectra/files/series_file.hpp"

namespace straytrace::cli {

void add_pair_options(CLI::App& command, PairOptions& o, char const* witness) {
  command.add_option("--witness", o.witness, witness)->required();
  command.add_option("--target", o.target, "FILE::CHANNEL of strain, or of another disturbed signal")->required();
  command.add_option("--witness-unit", o.witness_unit,
                     "unit, where the file has none: m/s^2; of counts the calibration: \"2e-6 m/s^2\"");
  command.add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  command.add_flag("--displacement", o.displacement, "convert the witness from m/s^2 or m/s to m");
}

void add_ratio_option(CLI::App& command, std::string const& name, double& ratio, std::string const& help) {
  std::string const usual = fmt::format("{:g}", ratio);
  command.add_option(name, ratio, help)->default_str(usual)->check(number_between(1, 1e9, usual));
}

void add_significance_option(CLI::App& command, double& significance, std::string const& help) {
  std::string const usual = fmt::format("{:g}", significance);
  command.add_option("--significance", significance, help)->default_str(usual)->check(number_between(0, 37, usual));
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
  std::error_code unknown;
  if (!a.file.starts_with("nds2://") && !std::filesystem::exists(a.file, unknown))
    throw InputError(fmt::format("{}: '{}' is neither a stretch A..B nor a readable file", option, text),
                     fmt::format("write {} 1000000000..1000000060, or check the name of the file", option));
  return a;
}

std::string argument_in(StretchArgument const& stretch, std::string const& channel, std::string const& option) {
  if (channel.find("::") != channel.npos) return channel;
  std::string const file = stretch.file.empty() ? channel : stretch.file;
  if (file.empty())
    throw InputError(fmt::format("{} is missing", option), fmt::format("write {} FILE::CHANNEL", option));
  return stretch.file.empty() || channel.empty() ? file : file + "::" + channel;
}

void answer_with_result(DataOptions const& o, CurveSheet const& sheet, std::string const& text,
                        nlohmann::json const& result) {
  if (!o.json()) return write_and_print(o, sheet, text);
  CurveSheet whole = sheet;
  whole.notes.push_back(fmt::format("straytrace {} ({})", build_info::version, build_info::commit));
  nlohmann::json all = read_json(curve_json(whole));
  all["result"] = result;
  write_and_print(o, sheet, json_text(all, 1) + '\n');
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

void add_couple(CLI::App& app, int& exit_code) {
  auto* const command = app.add_subcommand(
      "couple", "Measure coupling functions from injections, taps and shakers, or predict them from a run.");
  command->require_subcommand(1);
  for (auto* add : {add_couple_noise, add_couple_taps, add_couple_lines, add_couple_ramp, add_couple_sweep,
                    add_couple_impulse, add_couple_events, add_couple_predict})
    add(*command, exit_code);
  command->footer(
      "Examples:\n"
      "  straytrace couple noise --witness examples/data/shaken.csv::ACC --target examples/data/shaken.csv::H "
      "--injection 24..48 --quiet 0..24 --segment \"1 s\"\n"
      "  straytrace couple predict demo/run.h5 --body tube --axis z");
}

}  // namespace straytrace::cli
