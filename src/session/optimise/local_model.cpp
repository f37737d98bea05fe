// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlopt.h>

#include "base/errors.hpp"
#include "base/math/linear_algebra.hpp"
#include "session/optimise/search.hpp"

namespace straytrace::session {
namespace {

using Vector = Eigen::VectorXd;

// The subproblem in units in which steps and changes of the functions are about 1. A point of the solver: the step,
// then the slack.
struct Scaled {
  Subproblem const& problem;
  double step = 1, change = 1;
  struct Limit {
    Scaled const* self;
    Quadratic const* model;
  };
  std::vector<Limit> limits{};

  explicit Scaled(Subproblem const& p) : problem(p), step(0.5 * (p.high - p.low).maxCoeff()) {
    if (!(step > 0)) step = 1;
    auto const range = [&](Quadratic const& q) { return step * q.slope.norm() + step * step * q.curvature.norm(); };
    change = range(p.objective);
    for (Quadratic const& limit : p.limits) {
      change = std::max(change, range(limit));
      limits.push_back({this, &limit});
    }
    if (!(change > 0)) change = 1;
  }
  Scaled(Scaled const&) = delete;
  Scaled& operator=(Scaled const&) = delete;

  Vector step_at(unsigned n, double const* x) const { return step * Eigen::Map<Vector const>(x, n - 1); }

  static double objective(unsigned n, double const* x, double* gradient, void* data) {
    Scaled const& self = *static_cast<Scaled*>(data);
    Quadratic const& model = self.problem.objective;
    Vector const s = self.step_at(n, x);
    if (gradient) {
      Eigen::Map<Vector>(gradient, n - 1) = self.step / self.change * model.gradient(s);
      gradient[n - 1] = self.problem.penalty;
    }
    return (model.at(s) - model.value) / self.change + self.problem.penalty * x[n - 1];
  }

  static double limit(unsigned n, double const* x, double* gradient, void* data) {
    auto const& [self, model] = *static_cast<Limit*>(data);
    Vector const s = self->step_at(n, x);
    if (gradient) {
      Eigen::Map<Vector>(gradient, n - 1) = self->step / self->change * model->gradient(s);
      gradient[n - 1] = -1;
    }
    return model->at(s) / self->change - x[n - 1];
  }
};

// The step that NLopt finds from the smallest one that is allowed; empty when it fails.
Vector solved(Subproblem const& p, nlopt_algorithm algorithm) {
  auto const n = static_cast<unsigned>(p.low.size());
  std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> const solver(nlopt_create(algorithm, n + 1), nlopt_destroy);
  Scaled scaled(p);
  std::vector<double> x, low, high;
  for (Eigen::Index i = 0; i < p.low.size(); ++i) {
    low.push_back(p.low[i] / scaled.step);
    high.push_back(p.high[i] / scaled.step);
    x.push_back(std::clamp(0.0, low.back(), high.back()));
  }
  x.push_back(0);
  for (Quadratic const& limit : p.limits)
    x.back() = std::max(x.back(), limit.at(scaled.step_at(n + 1, x.data())) / scaled.change);
  low.push_back(0);
  high.push_back(HUGE_VAL);
  nlopt_set_lower_bounds(solver.get(), low.data());
  nlopt_set_upper_bounds(solver.get(), high.data());
  nlopt_set_initial_step1(solver.get(), 0.5);
  nlopt_set_min_objective(solver.get(), Scaled::objective, &scaled);
  for (Scaled::Limit& limit : scaled.limits)
    nlopt_add_inequality_constraint(solver.get(), Scaled::limit, &limit, 1e-10);
  nlopt_set_xtol_abs1(solver.get(), 1e-9);
  nlopt_set_maxeval(solver.get(), 2000);
  double found = 0;
  nlopt_optimize(solver.get(), x.data(), &found);  // also of a failure the point may be better than none
  Vector const step = scaled.step_at(n + 1, x.data());
  return step.allFinite() ? Vector(step.cwiseMax(p.low).cwiseMin(p.high)) : Vector();
}

}  // namespace

double Quadratic::at(Vector const& step) const { return value + slope.dot(step) + 0.5 * step.dot(curvature * step); }

Quadratic fitted(std::vector<Vector> const& steps, std::vector<double> const& values, double radius) {
  constexpr double nearest = 1e-3;  // limits the weight of the centre
  constexpr double mixed = 0.5;     // weight of products of two coordinates: undetermined ones stay small
  Eigen::Index const n = steps.front().size();
  auto const rows = static_cast<Eigen::Index>(steps.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(rows, 1 + n + n * (n + 1) / 2);
  Vector right = Vector::Zero(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    double const value = values[std::size_t(i)];
    if (!std::isfinite(value)) continue;
    Vector const s = steps[std::size_t(i)] / radius;
    matrix(i, 0) = 1;
    matrix.row(i).segment(1, n) = s.transpose();
    Eigen::Index column = n;
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index k = j; k < n; ++k) matrix(i, ++column) = (j == k ? 0.5 : mixed) * s[j] * s[k];
    double const weight = 1 / (nearest + std::pow(s.lpNorm<Eigen::Infinity>(), 3));
    matrix.row(i) *= weight;
    right[i] = weight * value;
  }
  Vector const found = least_norm_solution(matrix, right, 1e-12);
  Quadratic out{found[0], found.segment(1, n) / radius, Eigen::MatrixXd(n, n)};
  Eigen::Index column = n;
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index k = j; k < n; ++k)
      out.curvature(j, k) = out.curvature(k, j) = (j == k ? 1 : mixed) * found[++column] / (radius * radius);
  return out;
}

double Subproblem::slack(Vector const& step) const {
  double largest = 0;
  for (Quadratic const& limit : limits) largest = std::max(largest, limit.at(step));
  return largest;
}

double Subproblem::merit(Vector const& step) const { return objective.at(step) + penalty * slack(step); }

Vector Subproblem::least() const {
  Vector best = Vector::Zero(low.size()).cwiseMax(low).cwiseMin(high);
  double const start = merit(best);
  for (nlopt_algorithm const algorithm : {NLOPT_LD_SLSQP, NLOPT_LN_COBYLA}) {
    Vector const found = solved(*this, algorithm);
    if (found.size() > 0 && merit(found) < merit(best)) best = found;
    if (merit(best) < start) break;
  }
  return best;
}

}  // namespace straytrace::session
