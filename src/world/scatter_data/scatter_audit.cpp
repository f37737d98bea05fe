// SPDX-License-Identifier: BSD-3-Clause
#include "world/scatter_data/scatter_audit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "world/scatter_data/scatter_file.hpp"

namespace straytrace {
namespace {

using Points = std::vector<ScatterPoint>;

struct Total {
  double all = 0, inside = 0, outside = 0;
};

// BSDF cos dOmega = BSDF d^2 alpha: rings of the offset r, of which the arc 2 acos(...) lies above the horizon.
Total total_of(Points const& points, std::string_view beyond, double nearest, double farthest) {
  MeasuredSummary unused;
  Measured const law = law_of_points(points, beyond, unused);
  double const sin_i = std::sin(points[0].theta_i), last = 1 + sin_i, first = 1e-8;
  constexpr int steps = 8000;
  double const step = std::log(last / first) / steps;
  Total t;
  for (int i = 0; i < steps; ++i) {
    double const r = first * std::exp((i + 0.5) * step);
    double const cosine = sin_i * r > 0 ? (1 - sin_i * sin_i - r * r) / (2 * sin_i * r) : r < 1 ? 1 : -1;
    double const arc = 2 * (cosine >= 1 ? pi : cosine <= -1 ? 0 : pi - std::acos(cosine));
    double const power = law.one_way(sin_i, r) * arc * r * r * step;
    t.all += power;
    if (r < nearest) t.inside += power;
    if (r > farthest) t.outside += power;
  }
  return t;
}

IncidenceAudit audit_of(Points const& points, std::string_view beyond) {
  Points sorted = points, half;
  std::sort(sorted.begin(), sorted.end(), [](auto const& a, auto const& b) { return a.offset < b.offset; });
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if (i % 2 == 0 || i + 1 == sorted.size()) half.push_back(sorted[i]);
  IncidenceAudit out;
  out.theta_i = points[0].theta_i;
  out.points = points.size();
  out.limits = std::size_t(std::count_if(points.begin(), points.end(), [](auto const& p) { return p.limit; }));
  out.nearest = sorted.front().offset;
  out.farthest = sorted.back().offset;
  Total const t = total_of(sorted, beyond, out.nearest, out.farthest);
  out.tis = t.all;
  out.inside = t.inside;
  out.outside = t.outside;
  out.sampling = std::fabs(total_of(half, beyond, out.nearest, out.farthest).all - t.all);
  return out;
}

// ln of the BSDF in the plane of incidence at a signed angle of scatter, between two points of one incidence.
std::optional<double> in_plane(Points const& points, double theta_s) {
  ScatterPoint const *below = nullptr, *above = nullptr;
  auto const angle = [](ScatterPoint const& p) { return std::cos(p.phi) > 0 ? p.theta_s : -p.theta_s; };
  for (ScatterPoint const& p : points) {
    if (!(std::fabs(std::sin(p.theta_s) * std::sin(p.phi)) < 1e-6) || p.limit) continue;
    double const a = angle(p);
    if (a <= theta_s + 1e-9 && (!below || a > angle(*below))) below = &p;
    if (a >= theta_s - 1e-9 && (!above || a < angle(*above))) above = &p;
  }
  constexpr double widest = 10 * pi / 180;
  if (!below || !above || angle(*above) - angle(*below) > widest) return {};
  double const width = angle(*above) - angle(*below), share = width > 0 ? (theta_s - angle(*below)) / width : 0;
  return std::log(below->value) + share * (std::log(above->value) - std::log(below->value));
}

void reciprocity(std::vector<Points> const& groups, ScatterAudit& out) {
  double sum = 0;
  for (std::size_t i = 0; i < groups.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      for (double const side : {1.0, -1.0}) {
        auto const there = in_plane(groups[i], side * groups[k][0].theta_i),
                   back = in_plane(groups[k], side * groups[i][0].theta_i);
        if (!there || !back) continue;
        double const ratio = std::fabs(*there - *back);
        ++out.pairs;
        sum += ratio * ratio;
        out.worst_reciprocity = std::max(out.worst_reciprocity, ratio);
      }
  if (out.pairs > 0) out.rms_reciprocity = std::sqrt(sum / double(out.pairs));
}

void order(Points const& points, ScatterAudit& out) {
  double direction = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    double const step = points[i].theta_s - points[i - 1].theta_s;
    if (points[i].phi == points[i - 1].phi && step * direction < 0) ++out.turns;
    if (step != 0) direction = points[i].phi == points[i - 1].phi ? step : 0;
  }
  Points sorted = points;
  auto const less = [](ScatterPoint const& a, ScatterPoint const& b) {
    return std::pair(a.phi, a.theta_s) < std::pair(b.phi, b.theta_s);
  };
  std::sort(sorted.begin(), sorted.end(), less);
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (std::fabs(sorted[i].theta_s - sorted[i - 1].theta_s) < 1e-9 &&
        std::fabs(sorted[i].phi - sorted[i - 1].phi) < 1e-9 && sorted[i].theta_s > 1e-9)
      ++out.duplicates;
}

}  // namespace

ScatterAudit audit_scatter(ScatterFile const& file, std::string_view beyond) {
  ScatterAudit out;
  auto const groups = by_incidence(file.points);
  for (Points const& points : groups) {
    out.incidences.push_back(audit_of(points, beyond));
    IncidenceAudit& last = out.incidences.back();
    for (StatedTis const& t : file.stated)
      if (std::fabs(t.theta_i - last.theta_i) < 1e-6) {
        last.stated = t.stated;
        last.integral = t.integral;
      }
    out.points += last.points;
    out.limits += last.limits;
    if (points[0].theta_s == points[0].theta_s && file.stated.empty()) order(points, out);
  }
  reciprocity(groups, out);
  MeasuredSummary summary;
  law_of_points(file.points, beyond, summary);
  out.spread = summary.spread;
  return out;
}

}  // namespace straytrace
