// SPDX-License-Identifier: BSD-3-Clause
#include "app/inspect_scatter.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "app/scatter_text.hpp"
#include "base/constants.hpp"
#include "base/csv_cells.hpp"
#include "base/document.hpp"
#include "base/file_bytes.hpp"
#include "base/message.hpp"
#include "report/picture.hpp"
#include "report/report.hpp"
#include "world/measured/scatter_file.hpp"

namespace straytrace {
namespace {

// "1064 nm" of the command line.
double length_of(std::string const& text) {
  std::size_t const blank = text.find(' ');
  auto const unit = blank == text.npos ? std::nullopt : parse_unit(without_blanks(text.substr(blank)));
  auto const value = unit && unit->dimension == dim::length ? csv_number(text.substr(0, blank), *unit) : std::nullopt;
  if (!value || !(*value > 1e-8 && *value < 1e-3))
    throw InputError(fmt::format("error: '{}' is no wavelength\n  write --wavelength \"1064 nm\"", text));
  return *value;
}

ScatterFile read(ScatterRequest const& r) {
  auto const [text, why] = bytes_of_file(r.file);
  if (!why.empty()) throw InputError(fmt::format("error: cannot read '{}': {}\n  name a file", r.file, why));
  ScatterDeclared given;
  given.angles = r.angles;
  given.entry = r.entry;
  if (!r.wavelength.empty()) given.wavelength = length_of(r.wavelength);
  std::vector<Problem> problems;
  ScatterFile file = read_scatter_file(text, given, problems);
  if (problems.empty()) check_scatter_points(file.points, problems);
  if (problems.empty()) return file;
  std::string said;
  for (Problem const& p : problems)
    said +=
        fmt::format("{}{}: error: {}\n  {}\n", r.file,
                    p.place.line > 0 ? fmt::format(":{}:{}", p.place.line, p.place.column) : "", p.what, p.suggestion);
  throw InputError(problems, said, {r.file});
}

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

nlohmann::json as_json(std::string const& name, ScatterFile const& file, ScatterAudit const& audit,
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

void draw(nlohmann::json const& data, std::string const& png) {
  std::string message;
  std::string const picture = picture_of(data.dump(), draw_scatter_picture, message);
  if (picture.empty()) throw InputError(fmt::format("error: {}\n  or leave --plot out", message));
  write_file(png, picture);
}

}  // namespace

int inspect_scatter(ScatterRequest const& r, Options const& options) {
  ScatterFile const file = read(r);
  std::string const name = std::filesystem::path(r.file).filename().string();
  ScatterAudit const audit = audit_scatter(file, r.beyond);
  std::vector<ScatterFit> const fits = fit_scatter(file, name);
  std::string ssdd, why;
  if (!r.write.empty()) {
    if (!r.write.ends_with(".ssdd"))
      throw InputError(fmt::format("error: '{}' is no SSDD file\n  write --write NAME.ssdd", r.write));
    ssdd = ssdd_text(file, r.beyond, why);
    if (!why.empty())
      throw InputError(fmt::format("error: '{}' cannot become SSDD: {}\n  leave --write out", name, why));
  }
  nlohmann::json const data = as_json(name, file, audit, fits);
  if (!r.plot.empty()) draw(data, r.plot);
  if (!r.write.empty()) write_file(r.write, ssdd);
  if (options.json()) {
    std::cout << data.dump() << '\n';
    return done;
  }
  std::cout << scatter_text(name, file, audit, fits, r.beyond);
  if (!r.plot.empty()) std::cout << "\npicture: " << r.plot << '\n';
  if (!r.write.empty()) std::cout << "written: " << r.write << '\n';
  return done;
}

}  // namespace straytrace
