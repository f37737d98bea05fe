// SPDX-License-Identifier: BSD-3-Clause
// The fit against the part of the record that it has not seen, and the verdict (docs/theory/fit.md).
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "commission/fringe_search.hpp"

namespace straytrace {
namespace {

constexpr double sure = 3;  // standard deviations by which a right fit would have been confirmed

std::vector<double> psd_at(FringeProblem const& fitted, std::vector<double> const& hz) {
  std::vector<double> const& known = fitted.stretch.hz();
  std::vector<double> out;
  for (double const f : hz) {
    auto const next = std::lower_bound(known.begin(), known.end(), f) - known.begin();
    out.push_back(fitted.psd[std::size_t(std::min(next, std::ptrdiff_t(known.size()) - 1))]);
  }
  return out;
}

// Columns B with B B^T = J C J^T: what the errors of the fit may do to the model in the rest.
Eigen::MatrixXd spread_of_model(Eigen::MatrixXd const& slope, Eigen::MatrixXd const& covariance) {
  Eigen::VectorXd const sigma = covariance.diagonal().cwiseSqrt();
  Eigen::MatrixXd const correlation =
      sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  return slope * sigma.asDiagonal() * Eigen::MatrixXd(correlation.llt().matrixL());
}

// ln of N(h; m, 1 + B B^T) over N(h; 0, 1), by the small matrix 1 + B^T B.
void weigh(OutOfSample& out, Eigen::VectorXd const& h, Eigen::VectorXd const& m, Eigen::MatrixXd const& b) {
  Eigen::MatrixXd const own = b.transpose() * b;
  Eigen::LLT<Eigen::MatrixXd> const llt(Eigen::MatrixXd::Identity(own.rows(), own.cols()) + own);
  double const ln_det = 2 * llt.matrixLLT().diagonal().array().log().sum();
  Eigen::VectorXd const rest = b.transpose() * (h - m);
  double const square = m.squaredNorm(), of_fit = (b.transpose() * m).squaredNorm();
  out.ln_odds = (h.squaredNorm() - (h - m).squaredNorm() + rest.dot(llt.solve(rest)) - ln_det) / 2;
  out.ln_odds_expected = {(square + own.trace() - ln_det) / 2, std::sqrt(square + of_fit)};
  out.scale = {h.dot(m) / square, std::sqrt(square + of_fit) / square};
}

bool ends_a_range(FringeFit const& fit) {
  return fit.ratio.at_end || std::any_of(fit.paths.begin(), fit.paths.end(), [](FittedPath const& p) {
           return p.multiplicity.at_end || p.delay.at_end || p.drift.at_end;
         });
}

}  // namespace

OutOfSample out_of_sample(FringeProblem const& fitted, RefinedFit const& fit, FringeStretch const& rest) {
  FringeFitSettings settings = fitted.settings;
  settings.method = FitMethod::frequency;
  FringeProblem problem{rest, settings, {}, psd_at(fitted, rest.hz())};
  for (FringePath const& p : settings.paths) problem.responses.push_back(rest.response(p.phase, p.amplitude));
  Eigen::VectorXd const h = problem.features(rest.target());
  Eigen::VectorXd const m = problem.features(problem.model(fit.place, fit.fit.linear));
  OutOfSample out;
  out.seconds = rest.duration();
  out.without = h.squaredNorm();
  out.with = (h - m).squaredNorm();
  out.degrees = rest.degrees();
  weigh(out, h, m, spread_of_model(jacobian(problem, fit.place, fit.fit.linear), fit.covariance));
  out.reduction = {1 - out.with / out.without, 2 * m.norm() / out.without};
  return out;
}

FitVerdict verdict_of(FringeFit const& fit, double false_alarm) {
  if (fit.clock.doubtful) return FitVerdict::clock;
  if (fit.ln_false_alarm >= std::log(false_alarm)) return FitVerdict::none;
  if (ends_a_range(fit)) return FitVerdict::at_end;
  if (fit.test.seconds == 0) return FitVerdict::untested;
  double const needed = -std::log(false_alarm);
  if (fit.test.ln_odds >= needed) return FitVerdict::found;
  Fitted const& expected = fit.test.ln_odds_expected;
  return expected.value - sure * expected.sigma < needed ? FitVerdict::untested : FitVerdict::not_general;
}

}  // namespace straytrace
