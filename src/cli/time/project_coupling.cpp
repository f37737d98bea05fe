// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/files/text_file.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "cli/time/time_results.hpp"
#include "session/options.hpp"
#include "spectra/files/unit_text.hpp"

namespace straytrace::cli {
namespace {

struct Level {
  std::vector<double> hz, asd, sigma;
};

// ASD by Welch, without the line at zero; sigma_asd = sigma_psd/(2 asd).
Level level_of(TimeSeries const& s, WelchSettings const& settings, std::string& note) {
  WelchSpectrum const w = welch(s.samples, s.rate, settings);
  note = welch_note(settings, s.rate, w.segments, w.effective_averages, w.noise_bandwidth);
  Level level;
  for (std::size_t k = 1; k < w.hz.size(); ++k) {
    level.hz.push_back(w.hz[k]);
    level.asd.push_back(std::sqrt(w.psd[k]));
    level.sigma.push_back(w.psd[k] > 0 ? w.sigma[k] / (2 * level.asd.back()) : 0);
  }
  return level;
}

// The denominator of the unit of the factors: "m" of "1/m", "m/s^2" of "1/(m/s^2)". It must be the unit of the witness,
// otherwise the unit of the projection would be wrong.
std::string unit_below(std::string const& unit, TimeSeries const& witness) {
  auto const stroke = unit.find('/');
  std::string below = stroke == unit.npos ? "1" : unit.substr(stroke + 1);
  if (below.starts_with('(') && below.ends_with(')')) below = below.substr(1, below.size() - 2);
  auto const whole = parse_unit(unit), above = parse_unit(unit.substr(0, stroke)), part = parse_unit(below),
             have = parse_unit(witness.unit);
  bool const split = whole && above && part && times(above->dimension, part->dimension, -1) == whole->dimension;
  if (!split || !have || !(part->dimension == have->dimension))
    throw InputError(
        fmt::format("--coupling-unit: '{}' is not per {}, the unit of '{}'", unit, witness.unit, witness.name),
        fmt::format("write for example {}", ratio_unit("1", witness.unit)));
  return below;
}

// The numerator of "1/m" or "1/(m/s^2)".
std::string target_unit(CouplingFunction const& c) {
  for (std::string const& below : {"/" + c.witness_unit, "/(" + c.witness_unit + ")"})
    if (c.unit.ends_with(below)) return c.unit.substr(0, c.unit.size() - below.size());
  return c.unit;
}

// From the numerator of the unit of the coupling to the unit of the target.
void rescale(ProjectedCoupling& p, std::string const& unit, TimeSeries const& target) {
  auto const have = parse_unit(unit), want = parse_unit(target.unit);
  if (!have || !want || !(have->dimension == want->dimension))
    throw InputError(fmt::format("--target: '{}' is in {}, but the coupling gives {}", target.name, target.unit, unit),
                     "choose the target of the measured coupling");
  for (ProjectedPoint& q : p.points) {
    q.asd *= have->si / want->si;
    q.sigma *= have->si / want->si;
  }
}

CurveSheet sheet_of(ProjectedCoupling const& p, Level const* target, std::string const& unit) {
  CurveSheet sheet;
  sheet.title = fmt::format("{} projected onto {} by a measured coupling", p.witness, p.target);
  sheet.x = {"frequency", "Hz", {}};
  sheet.y = {{"projected", unit, {}}, {"sigma", unit, {}, "hidden"}, {"upper_limit", unit, {}, "upper-limit"}};
  if (target) sheet.y.push_back({"target", unit, target->asd});
  for (ProjectedPoint const& q : p.points) {
    bool const measured = q.flag == CouplingFlag::measured, limit = q.flag == CouplingFlag::upper_limit;
    sheet.x.values.push_back(q.hz);
    sheet.y[0].values.push_back(measured ? q.asd : not_a_number);
    sheet.y[1].values.push_back(measured ? q.sigma : not_a_number);
    sheet.y[2].values.push_back(limit ? q.asd : not_a_number);
  }
  return sheet;
}

std::string point_text(ProjectedPoint const& q, std::string const& unit) {
  if (q.flag == CouplingFlag::measured && std::isnan(q.sigma))
    return fmt::format("{:.3g} {}, error unknown", q.asd, unit);
  if (q.flag == CouplingFlag::measured) return fmt::format("{} {}", with_error(q.asd, q.sigma), unit);
  if (q.flag == CouplingFlag::upper_limit) return fmt::format("< {:.3g} {} (upper limit)", q.asd, unit);
  return fmt::format("unknown ({})", name_of(q.flag));
}

std::string text_of(ProjectedCoupling const& p, Level const* target, std::string const& unit) {
  std::size_t measured = 0, limits = 0;
  for (ProjectedPoint const& q : p.points) {
    measured += q.flag == CouplingFlag::measured;
    limits += q.flag == CouplingFlag::upper_limit;
  }
  std::string text = fmt::format("{}: {} measured, {}, {} unknown\n",
                                 p.points.size() == 1 ? "1 frequency" : fmt::format("{} frequencies", p.points.size()),
                                 measured, counted(limits, "upper limit"), p.points.size() - measured - limits);
  for (double const hz : {10.0, 30.0, 100.0}) {
    ProjectedPoint const* nearest = nullptr;
    for (ProjectedPoint const& q : p.points)
      if (!nearest || std::fabs(q.hz - hz) < std::fabs(nearest->hz - hz)) nearest = &q;
    if (nearest && std::fabs(nearest->hz / hz - 1) < 0.1)
      text += fmt::format("at {:.4g} Hz: {}\n", nearest->hz, point_text(*nearest, unit));
  }
  ProjectedPoint const* worst = nullptr;
  double ratio = 0;
  for (std::size_t i = 0; target && i < p.points.size(); ++i)
    if (p.points[i].flag == CouplingFlag::measured && target->asd[i] > 0 && p.points[i].asd / target->asd[i] > ratio) {
      ratio = p.points[i].asd / target->asd[i];
      worst = &p.points[i];
    }
  if (worst) text += fmt::format("largest share of the target: {:.3g} of its ASD at {:.4g} Hz\n", ratio, worst->hz);
  return text;
}

}  // namespace

int project_measured_coupling(CouplingProjectionOptions const& o) {
  if (!o.asd.empty()) check_curve_ending(o.asd, "--asd");
  TimeSeries const witness = series_of(o.data, o.witness);
  CouplingFunction coupling = parse_coupling(read_text(o.coupling), o.coupling, o.coupling_unit,
                                             o.coupling_unit.empty() ? "" : unit_below(o.coupling_unit, witness));
  if (coupling.witness.empty()) coupling.witness = witness.name;
  if (coupling.target.empty()) coupling.target = "target";
  WelchSettings const settings = welch_of(o.data, witness);
  std::string note;
  Level const quiet = level_of(witness, settings, note);
  ProjectedCoupling p = project_coupling(coupling, {witness.unit, quiet.hz, quiet.asd, quiet.sigma});
  std::string unit;
  Level target;
  if (!o.target.empty()) {
    DataOptions without_unit = o.data;
    without_unit.unit.clear();
    TimeSeries const series = series_of(without_unit, o.target);
    WelchSettings same = settings;
    same.segment = std::size_t(std::lround(double(settings.segment) / witness.rate * series.rate));
    Level const all = level_of(series, same, note);
    for (std::size_t i = 0; i < p.points.size(); ++i)
      target.asd.push_back(i < all.asd.size() ? all.asd[i] : not_a_number);
    unit = asd_unit(series.unit);
    rescale(p, target_unit(coupling), series);
  }
  if (unit.empty()) unit = asd_unit(target_unit(coupling));
  CurveSheet sheet = sheet_of(p, o.target.empty() ? nullptr : &target, unit);
  sheet.notes = {source_note(witness), note};
  if (o.data.json())
    std::cout << curve_json(sheet);
  else
    std::cout << text_of(p, o.target.empty() ? nullptr : &target, unit);
  if (o.asd.empty()) return done;
  write_curves({o.asd}, sheet);
  if (!o.data.quiet) std::cerr << "wrote " << o.asd << '\n';
  return done;
}

}  // namespace straytrace::cli
