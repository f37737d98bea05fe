// SPDX-License-Identifier: BSD-3-Clause
// straytrace couple noise: injection against quiet stretch -> coupling function.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/errors.hpp"
#include "cli/couple/couple.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"
#include "spectra/welch.hpp"

namespace straytrace::cli {
namespace {

struct NoiseCoupling {
  DataOptions data;
  std::vector<std::string> witness, injection;
  std::string target, quiet, witness_unit, target_unit, save;
  bool displacement = false, accept_incoherent = false;
  CouplingThresholds thresholds;
  std::size_t show = 12;
};

struct Coupled : InjectionCoupling {
  std::vector<std::string> notes;
};

struct Spectra : StretchSpectra {
  std::vector<std::string> notes;
  FoundStretch found;
};

// InputError where the stretch names a file that no channel is read from.
StretchArgument stretch_of(NoiseCoupling const& o, std::string const& witness, std::string const& stretch,
                           std::string const& option) {
  StretchArgument const where = parse_stretch(stretch, option);
  auto const elsewhere = [&](std::string const& channel) {
    std::size_t const colons = channel.find("::");
    std::error_code unknown;
    return colons != channel.npos && !std::filesystem::equivalent(channel.substr(0, colons), where.file, unknown);
  };
  if (!where.file.empty() && elsewhere(witness) && elsewhere(o.target))
    throw InputError(
        fmt::format("{} {}: --witness {} and --target {} are in other files", option, stretch, witness, o.target),
        fmt::format("write {} A..B, or --witness and --target without a file", option));
  return where;
}

Spectra spectra_of(NoiseCoupling const& o, std::string const& witness, std::string const& stretch, char const* option) {
  StretchArgument const where = stretch_of(o, witness, stretch, option);
  auto const both = averaged_records(o.data,
                                     {{argument_in(where, witness, "--witness"), o.witness_unit},
                                      {argument_in(where, o.target, "--target"), o.target_unit}},
                                     where.span);
  WelchSettings const w = welch_of(o.data, both[0]);
  Spectra s{{cross_spectra(both[0], both[1], w), both[0].name, both[1].name, both[0].unit, both[1].unit, w}, {}, {}};
  s.found = {fmt::format("{} {}", option, stretch),
             where.file.empty() ? witness.substr(0, witness.find("::")) : where.file, both[0].start, both[0].end()};
  s.notes = {fmt::format("{}: {}", option + 2, source_note(both[0])),
             fmt::format("{}: {}", option + 2, source_note(both[1])), welch_note(w, both[0].rate, s.cross)};
  if (!o.data.segments.empty()) s.notes.push_back(fmt::format("{}: {}", option + 2, active_note(o.data, both[0])));
  return s;
}

// Without --segment, one length for all stretches: that of the shortest.
void settle_segment(NoiseCoupling& o, std::vector<std::string> const& witnesses) {
  if (!o.data.segment.empty()) return;
  double shortest = infinity;
  std::vector<std::string> stretches = o.injection;
  stretches.push_back(o.quiet);
  for (std::string const& s : stretches) {
    StretchArgument const where = stretch_of(o, witnesses.front(), s, s == o.quiet ? "--quiet" : "--injection");
    NamedRecord const record{argument_in(where, witnesses.front(), "--witness"), o.witness_unit};
    shortest = std::min(shortest, averaged_records(o.data, {record}, where.span)[0].duration());
  }
  o.data.segment = fmt::format("{} s", std::min(8.0, shortest / 16));
}

Coupled couple_one(NoiseCoupling const& o, std::string const& witness, FrequencyBand const& band) {
  Spectra const quiet = spectra_of(o, witness, o.quiet, "--quiet");
  std::vector<std::string> notes = quiet.notes;
  std::vector<StretchSpectra> injections;
  std::vector<FoundStretch> stretches{quiet.found};
  for (std::string const& stretch : o.injection) {
    Spectra s = spectra_of(o, witness, stretch, "--injection");
    stretches.push_back(s.found);
    notes.insert(notes.end(), s.notes.begin(), s.notes.end());
    injections.push_back(std::move(s));
  }
  refuse_overlaps(stretches);
  return {couple_injections(quiet, injections, o.displacement, o.thresholds, band.low, band.high), std::move(notes)};
}

struct CouplingRow {
  Coupled const* from;
  CouplingPoint const* point;
};

// Strongest results: peaks of the share of the quiet witness in the target.
std::vector<CouplingRow> peaks(std::vector<Coupled> const& all) {
  std::vector<CouplingRow> rows;
  for (Coupled const& c : all) {
    std::vector<double> heights;
    for (CouplingPoint const& p : c.coupling.points)
      heights.push_back(p.flag == CouplingFlag::measured || p.flag == CouplingFlag::not_linear ? c.share(p) : 0);
    for (std::size_t const i : peaks_of(heights)) rows.push_back({&c, &c.coupling.points[i]});
  }
  std::stable_sort(rows.begin(), rows.end(), [](CouplingRow const& a, CouplingRow const& b) {
    return a.from->share(*a.point) > b.from->share(*b.point);
  });
  return rows;
}

std::string count_line(CouplingFunction const& c) {
  std::array<std::size_t, 5> n{};
  for (CouplingPoint const& p : c.points) ++n[std::size_t(p.flag)];
  return fmt::format(
      "{}: of {} frequencies {} measured, {} upper limits, {} below the thresholds, {} without data, {} "
      "not linear\n",
      c.witness, c.points.size(), n[0], n[1], n[2], n[3], n[4]);
}

// Where single lines are "fringe wrapped": the coupling of all lines together.
std::string band_line(Coupled const& c) {
  if (!c.whole) return "";
  return fmt::format("{}, {:g} to {:g} Hz together: {}\n", c.coupling.witness, c.coupling.points.front().hz,
                     c.coupling.points.back().hz, band_text(*c.whole, c.coupling.unit));
}

std::string text_of(NoiseCoupling const& o, std::vector<Coupled> const& all) {
  std::string text;
  for (Coupled const& c : all) text += count_line(c.coupling);
  std::vector<CouplingRow> const rows = peaks(all);
  if (rows.empty()) return text + "no excess in the target\n";
  Columns table{{"frequency", "witness", "coupling [" + all.front().coupling.unit + "]", "witness x", "target x",
                 "significance", "coherence", "of the quiet target", ""},
                {false, true, true},
                {}};
  for (std::size_t i = 0; i < std::min(rows.size(), o.show); ++i) {
    CouplingPoint const& p = *rows[i].point;
    table.rows.push_back({fmt::format("{:g} Hz", p.hz), rows[i].from->coupling.witness, plus_minus(p.factor, p.sigma),
                          fmt::format("{:.3g}", p.witness_ratio), fmt::format("{:.3g}", p.target_ratio),
                          fmt::format("{:.1f}", p.significance), fmt::format("{:.2f}", p.coherence),
                          fmt::format("{:.2g} %", 100 * rows[i].from->share(p)),
                          p.flag == CouplingFlag::not_linear ? "fringe wrapped" : ""});
  }
  text += aligned(table);
  if (rows.size() > o.show) text += fmt::format("and {} more peaks: --show {}\n", rows.size() - o.show, rows.size());
  for (Coupled const& c : all) text += band_line(c);
  return text;
}

CurveSheet sheet_of(std::vector<Coupled> const& all) {
  CurveSheet sheet;
  sheet.title = fmt::format("coupling to {}", all.front().coupling.target);
  sheet.x = {"frequency", "Hz", {}};
  for (CouplingPoint const& p : all.front().coupling.points) sheet.x.values.push_back(p.hz);
  for (Coupled const& c : all) {
    std::string const prefix = all.size() > 1 ? c.coupling.witness + "_" : "";
    for (CurveColumn& column : coupling_columns(c.coupling, prefix)) sheet.y.push_back(std::move(column));
    CurveColumn h{prefix + "h1", c.coupling.unit, {}, "hidden"},
        sigma{prefix + "h1_sigma", c.coupling.unit, {}, "hidden"};
    for (CouplingPoint const& p : c.coupling.points) {
      h.values.push_back(std::abs(c.linear.value[c.line_at(p.hz)]));
      sigma.values.push_back(c.linear.modulus_sigma[c.line_at(p.hz)]);
    }
    sheet.y.push_back(std::move(h));
    sheet.y.push_back(std::move(sigma));
    sheet.notes.insert(sheet.notes.end(), c.notes.begin(), c.notes.end());
    if (std::string line = band_line(c); !line.empty()) {
      line.pop_back();
      sheet.notes.insert(sheet.notes.begin(), line);
    }
  }
  sheet.notes.emplace_back(
      "coupling = sqrt((target_inj^2 - target_quiet^2)/(witness_inj^2 - witness_quiet^2)); upper "
      "limits: 95 %");
  return sheet;
}

int run_noise(NoiseCoupling o) {
  check_outputs(o.data);
  o.thresholds.check_linear = !o.accept_incoherent;
  o.thresholds.confidence = each_of(o.injection.size(), o.thresholds.confidence);
  std::vector<std::string> const witnesses =
      o.witness.empty() ? std::vector{parse_stretch(o.injection.front(), "--injection").channel} : o.witness;
  if (!o.save.empty() && witnesses.size() > 1)
    throw InputError("--save writes one coupling, but there are several witnesses", "name one --witness");
  if (o.data.average == "median") throw InputError("--average median: a coupling needs means", "remove the option");
  settle_segment(o, witnesses);
  FrequencyBand const band = o.data.band.empty() ? any_band : option_band(o.data.band, "--band");
  std::vector<Coupled> all;
  std::vector<InputError> errors;
  for (std::string const& w : witnesses) try {
      all.push_back(couple_one(o, w, band));
    } catch (InputError const& e) {
      errors.push_back(e);
    }
  throw_all(errors);
  if (all.front().coupling.points.empty())
    throw InputError("--band: it contains no frequency of the spectra", "choose a wider band, or a longer --segment");
  for (Coupled const& c : all)
    if (c.coupling.points.size() != all.front().coupling.points.size())
      throw InputError("the witnesses have different frequencies", "choose --segment, and a --band covered by all");
  answer(o.data, sheet_of(all), text_of(o, all));
  save_coupling(o.save, all.front().coupling, o.data.quiet);
  return 0;
}

}  // namespace

void add_couple_noise(CLI::App& couple, int& exit_code) {
  auto* const command =
      couple.add_subcommand("noise", "Measure a coupling function from an injection and a quiet stretch.");
  auto const options = std::make_shared<NoiseCoupling>();
  NoiseCoupling& o = *options;
  command->add_option("--witness", o.witness, "FILE::CHANNEL, or CHANNEL of the file of the stretch; may be repeated")
      ->check(is_record("--witness", true))
      ->allow_extra_args(false);
  command->add_option("--target", o.target, "the same for strain, or another disturbed signal")
      ->required()
      ->check(is_record("--target", true));
  command->add_option("--injection", o.injection, "A..B in GPS or UTC, FILE or FILE@A..B; may be repeated")
      ->required()
      ->check(readable([](std::string const& text) { parse_stretch(text, "--injection"); }))
      ->allow_extra_args(false);
  command->add_option("--quiet", o.quiet, "the same, without injection")
      ->required()
      ->check(readable([](std::string const& text) { parse_stretch(text, "--quiet"); }))
      ->group("Data");
  command->add_option("--witness-unit", o.witness_unit,
                      "unit, where the file has none: m/s^2; of counts the calibration: \"2e-6 m/s^2\"");
  command->add_option("--target-unit", o.target_unit, "unit, where the file has none: 1 for strain");
  command->add_flag("--displacement", o.displacement, "convert the witness from m/s^2 or m/s to m");
  add_ratio_option(*command, "--witness-ratio", o.thresholds.witness, "amplitude of the witness over quiet");
  add_ratio_option(*command, "--target-ratio", o.thresholds.target, "amplitude of the target over quiet");
  add_significance_option(*command, o.thresholds.significance, "of both, standard deviations");
  command->add_flag("--accept-incoherent", o.accept_incoherent,
                    "skip the check for fringe wrapping: the witness need not sense all that reaches the target");
  add_band_option(*command, o.data, "LOW..HIGH of the result: \"20 Hz..400 Hz\"");
  command
      ->add_option("--segments", o.data.segments,
                   "FILE or FILE::FLAG of data quality: use data only where it is active, in all stretches")
      ->check(is_record("--segments"));
  add_welch_options(*command, o.data);
  command->add_option("--show", o.show, "rows of the table")->default_str("12")->check(whole_between(1, 1e6, "20"));
  mark_output(*command, *command->add_option("--save", o.save, "CSV of pemcoupling, for straytrace project"));
  add_output_options(*command, o.data, "--silent");  // --quiet names a stretch
  command->footer(
      "Examples:\n"
      "  straytrace couple noise --witness examples/data/shaken.csv::ACC --target examples/data/shaken.csv::H "
      "--injection 24..48 --quiet 0..24 --segment \"1 s\"\n"
      "  straytrace couple noise --injection examples/data/shaken.csv::ACC@24..48 --target H "
      "--quiet examples/data/shaken.csv@0..24 --displacement --save acc.csv -o acc.png");
  command->callback([options, &exit_code] { exit_code = run_noise(*options); });
}

}  // namespace straytrace::cli
