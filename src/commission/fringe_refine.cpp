// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/message.hpp"
#include "commission/fringe_search.hpp"

namespace straytrace {
namespace {

using Kind = FreeParameter::Kind;

constexpr std::size_t candidates = 3;  // of a scan, refined

// A step that turns the phase by about a milliradian somewhere.
double small_step(FringeProblem const& problem, FringePlace const& place, FreeParameter const& p) {
  double const k2 = 4 * pi / problem.settings.wavelength, turn = 1e-3;
  double const span = std::max(problem.stretch.span(place.ratio), 1e-30);
  switch (p.kind) {
    case Kind::multiplicity:
      return turn / (k2 * span);
    case Kind::delay:
      return turn / (2 * pi * problem.settings.high);
    case Kind::drift:
      return turn / problem.stretch.duration();
    case Kind::ratio:
      break;
  }
  double largest = 1e-3;
  for (FringeShape const& s : place.shapes) largest = std::max(largest, std::fabs(s.multiplicity));
  return turn / (k2 * largest * (problem.stretch.span(0) + problem.stretch.span(1)));
}

// Moves the free ones by `step`, inside their ranges.
FringePlace moved(FringeProblem const& problem, FringePlace place, std::vector<FreeParameter> const& free,
                  Eigen::VectorXd const& step) {
  for (std::size_t i = 0; i < free.size(); ++i) {
    SearchRange const& range = range_of(problem.settings, free[i]);
    double& v = value_of(place, free[i]);
    v = std::clamp(v + step[Eigen::Index(i)], range.low, range.high);
  }
  return place;
}

// Noise level from what the fit leaves, which is short of one degree of freedom for each parameter.
void learn_noise(FringeProblem& problem, RefinedFit const& fit) {
  problem.psd = problem.stretch.psd(problem.stretch.target() - problem.model(fit.place, fit.fit.linear));
  double const degrees = problem.stretch.degrees();
  for (double& s : problem.psd) s *= degrees / (degrees - double(fit.covariance.rows()));
}

bool at_end(SearchRange const& r, double value) {
  return r.free() && (value - r.low < 1e-6 * (r.high - r.low) || r.high - value < 1e-6 * (r.high - r.low));
}

}  // namespace

std::vector<FreeParameter> free_parameters(FringeFitSettings const& s, std::size_t paths) {
  std::vector<FreeParameter> free;
  for (std::size_t p = 0; p < paths; ++p) {
    if (s.paths[p].multiplicity.free()) free.push_back({Kind::multiplicity, p});
    if (s.paths[p].delay.free()) free.push_back({Kind::delay, p});
    if (s.paths[p].drift.free()) free.push_back({Kind::drift, p});
  }
  if (s.ratio.free()) free.push_back({Kind::ratio, 0});
  return free;
}

double& value_of(FringePlace& place, FreeParameter const& p) {
  if (p.kind == Kind::ratio) return place.ratio;
  FringeShape& shape = place.shapes[p.path];
  return p.kind == Kind::multiplicity ? shape.multiplicity : p.kind == Kind::delay ? shape.delay : shape.drift;
}

SearchRange const& range_of(FringeFitSettings const& s, FreeParameter const& p) {
  if (p.kind == Kind::ratio) return s.ratio;
  FringePath const& path = s.paths[p.path];
  return p.kind == Kind::multiplicity ? path.multiplicity : p.kind == Kind::delay ? path.delay : path.drift;
}

Eigen::MatrixXd jacobian(FringeProblem const& problem, FringePlace const& place, Eigen::VectorXd const& linear) {
  std::vector<FreeParameter> const free = free_parameters(problem.settings, place.shapes.size());
  Eigen::MatrixXd const columns = problem.columns(place);
  Eigen::MatrixXd out(columns.rows(), columns.cols() + Eigen::Index(free.size()));
  out.leftCols(columns.cols()) = columns;
  for (std::size_t i = 0; i < free.size(); ++i) {
    double const step = small_step(problem, place, free[i]);
    FringePlace up = place, down = place;
    value_of(up, free[i]) += step;
    value_of(down, free[i]) -= step;
    out.col(columns.cols() + Eigen::Index(i)) =
        (problem.features(problem.model(up, linear)) - problem.features(problem.model(down, linear))) / (2 * step);
  }
  return out;
}

RefinedFit refine(FringeProblem const& problem, FringePlace const& from) {
  std::vector<FreeParameter> const free = free_parameters(problem.settings, from.shapes.size());
  Eigen::VectorXd const target = problem.features(problem.stretch.target());
  RefinedFit out{from, {}, {}};
  out.fit = linear_fit(problem.columns(from), target);
  double damping = 1e-3;
  Eigen::MatrixXd slope = jacobian(problem, out.place, out.fit.linear);
  auto const residual = [&]() -> Eigen::VectorXd {
    return target - slope.leftCols(out.fit.linear.size()) * out.fit.linear;
  };
  for (int i = 0; i < 40 && !free.empty(); ++i) {
    Eigen::MatrixXd damped = slope.transpose() * slope;
    damped.diagonal() *= 1 + damping;
    Eigen::VectorXd const step = damped.ldlt().solve(slope.transpose() * residual()).tail(Eigen::Index(free.size()));
    FringePlace const next = moved(problem, out.place, free, step);
    LinearFit const fit = linear_fit(problem.columns(next), target);
    if (!(fit.chi2 <= out.fit.chi2)) {
      damping *= 10;
      if (damping > 1e8) break;
      continue;
    }
    bool const settled = out.fit.chi2 - fit.chi2 < 1e-6;
    out.place = next;
    out.fit = fit;
    slope = jacobian(problem, out.place, out.fit.linear);
    damping = std::max(damping / 10, 1e-12);
    if (settled) break;
  }
  Eigen::MatrixXd const curvature = slope.transpose() * slope;
  // Scaled, so that parameters of very different size invert well.
  Eigen::VectorXd const scale = curvature.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  Eigen::MatrixXd const unit = scale.asDiagonal() * curvature * scale.asDiagonal();
  Eigen::FullPivLU<Eigen::MatrixXd> const lu(unit);
  if (!lu.isInvertible() || !unit.allFinite())
    throw NumericalError("the fit cannot tell its parameters apart; fix some of them");
  out.covariance = scale.asDiagonal() * lu.inverse() * scale.asDiagonal();
  return out;
}

RefinedFit fit_all(FringeProblem& problem) {
  RefinedFit best;
  FringePlace place{{}, problem.settings.ratio.low};
  for (std::size_t p = 0; p < problem.settings.paths.size(); ++p) {
    best.fit.chi2 = infinity;
    for (FringePlace const& from : scan(problem, place, p, candidates))
      if (RefinedFit const fit = refine(problem, from); fit.fit.chi2 < best.fit.chi2) best = fit;
    for (int i = 0; i < 2; ++i) {
      learn_noise(problem, best);
      best = refine(problem, best.place);
    }
    place = best.place;
  }
  return best;
}

// Amplitude and phase instead of cosine and sine; then the free ones.
void report_parameters(FringeFit& out, FringeProblem const& problem, RefinedFit const& fit) {
  auto const free = free_parameters(problem.settings, fit.place.shapes.size());
  std::size_t const paths = fit.place.shapes.size(), n = 2 * paths + free.size();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(Eigen::Index(n), Eigen::Index(n));
  out.paths.resize(paths);
  for (std::size_t p = 0; p < paths; ++p) {
    auto const i = Eigen::Index(2 * p);
    double const a = fit.fit.linear[i], b = fit.fit.linear[i + 1], r = std::hypot(a, b);
    turn.block<2, 2>(i, i) << a / r, b / r, -b / (r * r), a / (r * r);
    FringeShape const& shape = fit.place.shapes[p];
    out.paths[p] = {problem.settings.paths[p].name,
                    {r},
                    {std::atan2(b, a)},
                    {shape.multiplicity},
                    {shape.delay},
                    {shape.drift},
                    0,
                    0};
    out.names.push_back(fmt::format("amplitude {}", p + 1));
    out.names.push_back(fmt::format("phase {}", p + 1));
  }
  out.ratio = {fit.place.ratio};
  Eigen::MatrixXd const covariance = turn * fit.covariance * turn.transpose();
  std::vector<Fitted*> all;
  for (FittedPath& p : out.paths) all.insert(all.end(), {&p.amplitude, &p.phase});
  for (FreeParameter const& f : free) {
    FittedPath& p = out.paths[f.path];
    bool const ratio = f.kind == FreeParameter::Kind::ratio;
    bool const w = f.kind == FreeParameter::Kind::multiplicity, d = f.kind == FreeParameter::Kind::delay;
    all.push_back(ratio ? &out.ratio : w ? &p.multiplicity : d ? &p.delay : &p.drift);
    all.back()->at_end = at_end(range_of(problem.settings, f), all.back()->value);
    std::string const name = w ? "multiplicity" : d ? "delay" : "drift";
    out.names.push_back(ratio ? "ratio" : fmt::format("{} {}", name, f.path + 1));
  }
  for (Eigen::Index i = 0; i < Eigen::Index(n); ++i) {
    all[std::size_t(i)]->sigma = std::sqrt(covariance(i, i));
    for (Eigen::Index j = 0; j < Eigen::Index(n); ++j)
      out.correlation.push_back(covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j)));
  }
}

}  // namespace straytrace
