// SPDX-License-Identifier: BSD-3-Clause
#include "cli/couple/overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/coupling/coupling.hpp"
#include "base/errors.hpp"
#include "base/files/text_file.hpp"
#include "base/text/words.hpp"
#include "base/units/quantity.hpp"
#include "cli/couple/couple_data.hpp"
#include "results/results.hpp"
#include "results/text/columns.hpp"

namespace straytrace::cli {
namespace {

std::size_t bin_of(FrequencyGrid const& grid, double hz) {
  auto const edge = std::upper_bound(grid.edges.begin(), grid.edges.end(), hz);
  return edge == grid.edges.begin() || edge == grid.edges.end() ? grid.size()
                                                                : std::size_t(edge - grid.edges.begin()) - 1;
}

double scale_to(CouplingFunction const& c, std::string const& unit) {
  auto const have = parse_unit(c.unit), want = parse_unit(unit);
  if (!have || !want || !(have->dimension == want->dimension))
    throw InputError(fmt::format("--measured: the coupling is in {}, the prediction in {}", c.unit, unit),
                     "measure strain against displacement: couple noise --displacement");
  return have->si / want->si;
}

bool has_factor(CouplingPoint const& p) {
  return p.flag == CouplingFlag::measured || p.flag == CouplingFlag::upper_limit;
}

OverlayPoint compared(CouplingPoint const& m, double factor, double sigma) {
  OverlayPoint p{m, factor, sigma, m.factor / factor, 0, 0};
  bool const measured = m.flag == CouplingFlag::measured;
  if (!measured || std::isfinite(m.sigma)) p.error = std::hypot(measured ? m.sigma / m.factor : 0, sigma / factor);
  double const log = std::log(p.ratio);
  p.significance = p.error > 0 ? log / p.error : not_a_number;
  if (!measured) p.significance = log < 0 && p.error > 0 ? -log / p.error : 0;
  return p;
}

bool counts(OverlayPoint const& p) { return p.measured.flag == CouplingFlag::measured && p.error > 0; }

}  // namespace

CouplingFunction read_coupling(std::string const& file, std::string const& unit, std::string const& witness_unit) {
  return parse_coupling(read_text(file), file, unit, witness_unit);
}

Overlay overlay_of(CouplingFunction const& c, PredictedCoupling const& p, std::string const& unit) {
  double const scale = scale_to(c, unit);
  Overlay out;
  out.unit = unit;
  double weight = 0;
  for (CouplingPoint m : c.points) {
    std::size_t const i = bin_of(p.grid, m.hz);
    if (i == p.grid.size() || !has_factor(m) || !(p.factor[i] > 0)) continue;
    m.factor *= scale;
    m.sigma *= scale;
    OverlayPoint const point = compared(m, p.factor[i], p.sigma[i]);
    out.points.push_back(point);
    out.above_limit += m.flag == CouplingFlag::upper_limit && point.significance > 3;
    if (!counts(point)) continue;
    weight += 1 / (point.error * point.error);
    out.mean_ratio += std::log(point.ratio) / (point.error * point.error);
    ++out.measured;
  }
  if (out.points.empty())
    throw InputError("--measured: no measured factor or limit is inside the band of the prediction", "choose --band");
  if (out.measured > 0) out.mean_ratio /= weight;
  for (OverlayPoint const& q : out.points)
    if (counts(q)) out.chi_square += std::pow((std::log(q.ratio) - out.mean_ratio) / q.error, 2);
  double const spread = out.measured > 1 ? std::max(1.0, out.chi_square / double(out.measured - 1)) : 1;
  out.mean_sigma = out.measured > 0 ? std::sqrt(spread / weight) : not_a_number;
  return out;
}

std::string overlay_text(Overlay const& o, std::size_t show) {
  Columns table{{"frequency", "measured [" + o.unit + "]", "predicted", "measured/predicted", "significance"}, {}, {}};
  std::size_t const step = std::max<std::size_t>(1, (o.points.size() + show - 1) / std::max<std::size_t>(1, show));
  for (std::size_t i = 0; i < o.points.size(); i += step) {
    OverlayPoint const& p = o.points[i];
    bool const limit = p.measured.flag == CouplingFlag::upper_limit;
    table.rows.push_back(
        {fmt::format("{:g} Hz", p.measured.hz),
         limit ? fmt::format("<= {:.3g}", p.measured.factor) : plus_minus(p.measured.factor, p.measured.sigma),
         plus_minus(p.predicted, p.predicted_sigma), fmt::format("{}{:.3g}", limit ? "<= " : "", p.ratio),
         std::isfinite(p.significance) ? fmt::format("{:.1f}", p.significance) : "unknown"});
  }
  std::string text = aligned(table);
  if (o.measured > 0)
    text += fmt::format("measured over predicted: {} from {}, chi^2 {:.1f} of {}\n",
                        plus_minus(std::exp(o.mean_ratio), std::exp(o.mean_ratio) * o.mean_sigma),
                        counted(o.measured, "point"), o.chi_square, o.measured - 1);
  if (o.above_limit > 0)
    text += fmt::format("the prediction exceeds {} by three sigma\n", counted(o.above_limit, "measured limit"));
  return text;
}

nlohmann::json overlay_json(Overlay const& o) {
  nlohmann::json points = nlohmann::json::array();
  for (OverlayPoint const& p : o.points)
    points.push_back({{"frequency", p.measured.hz},
                      {"measured", p.measured.factor},
                      {"measured_sigma", number_or_null(p.measured.sigma)},
                      {"flag", name_of(p.measured.flag)},
                      {"predicted", p.predicted},
                      {"predicted_sigma", p.predicted_sigma},
                      {"ratio", p.ratio},
                      {"significance", number_or_null(p.significance)}});
  return {{"points", points},
          {"unit", o.unit},
          {"mean_ratio", number_or_null(o.measured > 0 ? std::exp(o.mean_ratio) : not_a_number)},
          {"mean_ratio_sigma", number_or_null(std::exp(o.mean_ratio) * o.mean_sigma)},
          {"chi_square", o.chi_square},
          {"measured", o.measured},
          {"above_limit", o.above_limit}};
}

void add_overlay(CurveSheet& sheet, Overlay const& o) {
  std::size_t const n = sheet.x.values.size();
  CurveColumn value{"measured", o.unit, std::vector<double>(n, not_a_number), "points"}, limit = value, sigma = value;
  limit.name = "measured_limit";
  limit.style = "upper-limit";
  sigma.name = "measured_sigma";
  sigma.style = "hidden";
  std::vector<double> sure(n, -1);
  for (OverlayPoint const& p : o.points) {
    auto const near = std::min_element(sheet.x.values.begin(), sheet.x.values.end(), [&](double a, double b) {
      return std::fabs(std::log(a / p.measured.hz)) < std::fabs(std::log(b / p.measured.hz));
    });
    auto const i = std::size_t(near - sheet.x.values.begin());
    double const rank = p.measured.flag == CouplingFlag::measured
                            ? 1 + (std::isfinite(p.measured.sigma) ? p.measured.factor / p.measured.sigma : 0)
                            : 0;
    if (rank <= sure[i]) continue;
    sure[i] = rank;
    bool const measured = p.measured.flag == CouplingFlag::measured;
    value.values[i] = measured ? p.measured.factor : not_a_number;
    sigma.values[i] = measured ? p.measured.sigma : not_a_number;
    limit.values[i] = measured ? not_a_number : p.measured.factor;
  }
  for (CurveColumn const& c : {value, limit, sigma}) sheet.y.push_back(c);
}

}  // namespace straytrace::cli
