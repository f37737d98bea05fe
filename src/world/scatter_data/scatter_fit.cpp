// SPDX-License-Identifier: BSD-3-Clause
#include "world/scatter_data/scatter_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"

namespace straytrace::world {
namespace {

constexpr double huber = 2.5;

enum class Model { abg, harvey, k_correlation };
constexpr std::array<char const*, 3> names{"abg", "harvey", "k-correlation"};

// ln(BSDF) of the lobe: p = ln of height, ln of width, exponent. Widths are offsets; of abg the offset where A/B
// halves.
double log_lobe(Model model, double const* p, double x, double log_cosines) {
  double const ratio = x > 0 ? std::log(x) - p[1] : -700;
  double const g = p[2];
  if (model == Model::abg) return p[0] - std::log1p(std::exp(std::min(g * ratio, 700.0)));
  double const bend = std::log1p(std::exp(std::min(2 * ratio, 700.0)));
  return model == Model::harvey ? p[0] - g / 2 * bend : p[0] - g / 2 * bend + log_cosines;
}

// With the constant that a fourth number is the ln of.
double log_value(Model model, double const* p, Eigen::Index count, double x, double log_cosines) {
  double const lobe = log_lobe(model, p, x, log_cosines);
  if (count < 4) return lobe;
  double const high = std::max(lobe, p[3]), low = std::min(lobe, p[3]);
  return high + std::log1p(std::exp(low - high));
}

// ln of the probability that a normal deviate lies below z.
double log_below(double z) {
  if (z > -6) return std::log(0.5 * std::erfc(-z / std::sqrt(2.0)));
  return -z * z / 2 - std::log(-z * std::sqrt(2 * pi)) - 1 / (z * z);
}

struct Datum {
  double x, log_cosines, log_value, sigma;
  bool limit;
};

double plain_residual(Model model, Eigen::VectorXd const& p, Datum const& d) {
  double const z = (d.log_value - log_value(model, p.data(), p.size(), d.x, d.log_cosines)) / d.sigma;
  return d.limit ? std::sqrt(std::max(0.0, -2 * log_below(z))) : z;
}

// `count` parameters: 3, or 4 with a floor.
LeastSquaresProblem problem_of(Model model, std::vector<Datum> const& data, Eigen::Index count) {
  return {count, Eigen::Index(data.size()), [model, &data](Eigen::VectorXd const& p, Eigen::VectorXd& out) {
            for (std::size_t i = 0; i < data.size(); ++i) {
              double const r = plain_residual(model, p, data[i]), size = std::fabs(r);
              out[Eigen::Index(i)] =
                  size <= huber || data[i].limit ? r : std::copysign(std::sqrt(huber * (2 * size - huber)), r);
            }
          }};
}

std::vector<Datum> data_of(ScatterFile const& file) {
  std::vector<Datum> all;
  double const floor = std::max(0.0, file.declared.noise_floor);
  for (ScatterPoint const& p : file.points) {
    double const relative = p.error > 0 ? p.error / p.value : assumed_scatter_error;
    double const noise = p.limit || p.error > 0 ? 0 : floor / p.value;
    all.push_back({std::max(p.offset, 1e-9), std::log(std::cos(p.theta_i) * std::cos(p.theta_s)), std::log(p.value),
                   std::hypot(relative, noise), p.limit});
  }
  return all;
}

// From several widths within the measured offsets; the best of them, or one without parameters.
LeastSquaresMinimum best_start(Model model, std::vector<Datum> const& data, int count) {
  double low = 1e9, high = 0, top = -1e9, bottom = 1e9;
  for (Datum const& d : data) {
    low = std::min(low, d.x);
    high = std::max(high, d.x);
    top = std::max(top, d.log_value);
    bottom = std::min(bottom, d.log_value);
  }
  low = std::max(low, 1e-6);
  LeastSquaresMinimum best{{}, infinity};
  for (int i = 0; i < 5; ++i)
    for (double const slope : {1.0, 2.5}) {
      Eigen::VectorXd p(4);
      p << top, std::log(low) + i * std::log(high / low) / 5, slope, bottom;
      p.conservativeResize(count);
      LeastSquaresMinimum const found = minimise(problem_of(model, data, count), std::move(p));
      if (std::isfinite(found.cost) && found.at.allFinite() && found.cost < best.cost * (1 - 1e-9)) best = found;
    }
  return best;
}

// With a floor where it reduces the residuals by more than chance does in one case of a thousand (F test).
LeastSquaresMinimum best_of(Model model, std::vector<Datum> const& data, std::size_t measured) {
  constexpr double one_in_a_thousand = 11;
  LeastSquaresMinimum const plain = best_start(model, data, 3);
  if (measured < 8 || plain.cost < 1e-6 * double(measured)) return plain;
  LeastSquaresMinimum const floored = best_start(model, data, 4);
  double const spare = floored.cost / double(measured - 4);
  return floored.at.size() == 4 && plain.cost - floored.cost > one_in_a_thousand * spare ? floored : plain;
}

// Covariance of the parameters; huge along directions that the data do not determine.
Eigen::MatrixXd covariance(Model model, std::vector<Datum> const& data, Eigen::VectorXd const& p) {
  Eigen::Index const n = p.size();
  Eigen::MatrixXd const slope = derivatives(problem_of(model, data, n), p);
  Eigen::MatrixXd const information = slope.transpose() * slope;
  auto const [strength, vectors] = symmetric_modes(information);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    double const variance = strength[k] > 1e-10 * strength[n - 1] ? 1 / strength[k] : 1e12;
    out += variance * vectors.col(k) * vectors.col(k).transpose();
  }
  return out;
}

// Errors below one part in one: beyond, a logarithm is not resolved.
FitParameter from_log(char const* name, char const* unit, double log_size, double variance) {
  double const error = std::sqrt(variance), value = std::exp(log_size);
  return {name, unit, value, error < 1 ? value * error : infinity};
}

void name_parameters(Model model, Eigen::VectorXd const& p, Eigen::MatrixXd const& c, double wavelength,
                     ScatterFit& fit) {
  auto const exponent = [&](char const* name, double value) {
    double const error = std::sqrt(c(2, 2));
    return FitParameter{name, "", value, error < 10 ? error : infinity};
  };
  if (model == Model::abg) {
    // A/B = height, B = width^g: ln B = g ln w, ln A = ln height + ln B.
    Eigen::RowVector3d const log_b(0, p[2], p[1]), log_a(1, p[2], p[1]);
    Eigen::Matrix3d const lobe = c.topLeftCorner(3, 3);
    fit.parameters = {from_log("a", "/sr", p[0] + p[2] * p[1], log_a * lobe * log_a.transpose()),
                      from_log("b", "", p[2] * p[1], log_b * lobe * log_b.transpose()), exponent("g", p[2])};
  } else if (model == Model::harvey) {
    fit.parameters = {from_log("b0", "/sr", p[0], c(0, 0)), from_log("l", "", p[1], c(1, 1)), exponent("s", -p[2])};
  } else {
    double const scale = std::log(std::pow(wavelength, 4) / (16 * pi * pi));
    fit.parameters = {from_log("a", "m^4", p[0] + scale, c(0, 0)),
                      from_log("b", "m", std::log(wavelength) - p[1], c(1, 1)), exponent("c", p[2] - 1)};
  }
  if (p.size() > 3) fit.parameters.push_back(from_log("floor", "/sr", p[3], c(3, 3)));
}

// Ranges that the reader of the model accepts (world/build/read_laws.cpp).
std::string outside_of_law(ScatterFit const& fit) {
  auto const out = [&](std::size_t i, double low, double high) {
    return !(fit.parameters[i].value >= low && fit.parameters[i].value <= high);
  };
  bool const bad = fit.model == "abg"      ? out(0, 0, 1e6) || out(1, 1e-12, 1e6) || out(2, 0, 8)
                   : fit.model == "harvey" ? out(0, 0, 1e9) || out(1, 1e-7, 10) || out(2, -8, 0)
                                           : out(0, 0, 1) || out(1, 1e-9, 100) || out(2, 1e-3, 20);
  if (!bad && !(fit.parameters.size() > 3 && out(3, 0, 1 / pi))) return {};
  return fmt::format("the best parameters are unphysical: {} = {:.3g}, {} = {:.3g}, {} = {:.3g}",
                     fit.parameters[0].name, fit.parameters[0].value, fit.parameters[1].name, fit.parameters[1].value,
                     fit.parameters[2].name, fit.parameters[2].value);
}

std::string yaml_of(ScatterFit const& fit, double wavelength, std::string const& source) {
  std::string const from = fmt::format("wavelength: {:g} nm, source: \"fit to {}\"", wavelength * 1e9, source);
  std::string out = fmt::format("{{model: {}", fit.model);
  for (std::size_t i = 0; i < 3; ++i) {
    FitParameter const& p = fit.parameters[i];
    out += fmt::format(", {}: {:.5g}{}{}", p.name, p.value, p.unit.empty() ? "" : " ", p.unit);
  }
  out += fmt::format(", {}}}", from);
  if (fit.parameters.size() < 4) return out;
  return fmt::format("[{},\n            {{model: lambertian, brdf: {:.5g} /sr, {}}}]", out, fit.parameters[3].value,
                     from);
}

// 2 pi times the integral of BSDF cos over the angle, at normal incidence: midpoints in ln of the offset.
double tis_of(ScatterFit const& fit) {
  constexpr int steps = 4000;
  double sum = 0;
  double const step = std::log(1e9) / steps;
  for (int i = 0; i < steps; ++i) {
    double const x = 1e-9 * std::exp((i + 0.5) * step);
    sum += 2 * pi * x * x * step * fit.at(x, 1, std::sqrt(1 - x * x));
  }
  return sum;
}

ScatterFit fit_of(Model model, ScatterFile const& file, std::vector<Datum> const& data, std::string const& source) {
  ScatterFit fit;
  fit.model = names[std::size_t(model)];
  auto const limits = std::size_t(std::ranges::count_if(data, [](Datum const& d) { return d.limit; }));
  if (data.size() - limits < 6) fit.why = "fewer than six points above the noise floor";
  bool const directed = std::ranges::all_of(data, [](Datum const& d) { return std::isfinite(d.log_cosines); });
  if (model == Model::k_correlation && !directed) fit.why = "the model needs angles, but the file gives offsets";
  if (!fit.why.empty()) return fit;
  Eigen::VectorXd const p = best_of(model, data, data.size() - limits).at;
  int const count = int(p.size());
  if (count == 0) {
    fit.why = "no minimum was found";
    return fit;
  }
  double squares = 0;
  for (Datum const& d : data) {
    double const r = plain_residual(model, p, d), fitted = log_value(model, p.data(), count, d.x, d.log_cosines);
    fit.chi2 += r * r;
    fit.fitted.push_back(std::exp(fitted));
    if (!d.limit) squares += std::pow((d.log_value - fitted) / std::log(10.0), 2);
    fit.outliers += !d.limit && std::fabs(r) > huber;
  }
  fit.freedom = data.size() - limits - std::size_t(count);
  fit.rms = std::sqrt(squares / double(data.size() - limits));
  Eigen::MatrixXd c = covariance(model, data, p);
  bool const stated = std::ranges::any_of(file.points, [](auto const& q) { return q.error > 0; });
  fit.scaled = !stated || fit.chi2 > double(fit.freedom);
  if (fit.scaled) c *= fit.chi2 / double(fit.freedom);
  fit.raw.assign(p.data(), p.data() + count);
  name_parameters(model, p, c, file.declared.wavelength, fit);
  fit.why = outside_of_law(fit);
  fit.tis = tis_of(fit);
  fit.yaml = yaml_of(fit, file.declared.wavelength, source);
  return fit;
}

}  // namespace

double ScatterFit::at(double offset, double cos_i, double cos_s) const {
  Model const kind = model == names[0] ? Model::abg : model == names[1] ? Model::harvey : Model::k_correlation;
  return std::exp(
      log_value(kind, raw.data(), Eigen::Index(raw.size()), offset, std::log(std::max(cos_i * cos_s, 1e-300))));
}

std::vector<ScatterFit> fit_scatter(ScatterFile const& file, std::string const& source) {
  std::vector<Datum> const data = data_of(file);
  std::vector<ScatterFit> out;
  for (Model const m : {Model::abg, Model::harvey, Model::k_correlation}) out.push_back(fit_of(m, file, data, source));
  return out;
}

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
  std::ranges::sort(sorted, [](auto const& a, auto const& b) { return a.offset < b.offset; });
  for (std::size_t i = 0; i < sorted.size(); ++i)
    if (i % 2 == 0 || i + 1 == sorted.size()) half.push_back(sorted[i]);
  IncidenceAudit out;
  out.theta_i = points[0].theta_i;
  out.points = points.size();
  out.limits = std::size_t(std::ranges::count_if(points, [](auto const& p) { return p.limit; }));
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
  std::ranges::sort(sorted, less);
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

}  // namespace straytrace::world
