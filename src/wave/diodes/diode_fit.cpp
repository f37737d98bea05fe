// SPDX-License-Identifier: BSD-3-Clause
#include "wave/diodes/diode_fit.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/distributions.hpp"
#include "base/math/linear_algebra.hpp"

namespace straytrace::wave {
namespace {

constexpr int most_rounds = 6;
constexpr double settled = 0.03;    // standard deviations between two rounds
constexpr double step = 0.02;       // of a derivative, in half ranges
constexpr double large_part = 0.1;  // of a parameter in a combination
constexpr double tolerance = 1e-5;  // of chi^2

// In units of half ranges about their middles.
class ScaledFit {
 public:
  explicit ScaledFit(DiodeFitProblem const& p)
      : problem_(p), at_(Eigen::VectorXd::Zero(Eigen::Index(p.ranges.size()))) {}

  DiodeFit run() {
    for (int round = 0; round < most_rounds; ++round) {
      weigh();
      if (basis_.cols() == 0) break;
      if (improve() < settled || speckle_.isZero()) break;  // else the weights change
    }
    weigh();
    return result();
  }

 private:
  Eigen::VectorXd inside(Eigen::VectorXd const& scaled) const { return scaled.cwiseMax(-1).cwiseMin(1); }
  Eigen::VectorXd own_units(Eigen::VectorXd const& scaled) const {
    Eigen::VectorXd out(scaled.size());
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      FitRange const& r = problem_.ranges[std::size_t(i)];
      out[i] = 0.5 * (r.low + r.high) + 0.5 * (r.high - r.low) * scaled[i];
    }
    return out;
  }
  Eigen::VectorXd residuals(Eigen::VectorXd const& scaled) const {
    Eigen::VectorXd const mean = problem_.mean(own_units(inside(scaled)));
    return root_.matrixL().solve(mean - problem_.measured);
  }
  // By differences towards the middle of the ranges, which stay inside.
  Eigen::MatrixXd slopes(Eigen::VectorXd const& at, Eigen::VectorXd const& here, Eigen::MatrixXd const& along) const {
    Eigen::MatrixXd out(here.size(), along.cols());
    for (Eigen::Index i = 0; i < along.cols(); ++i) {
      double const side = at.dot(along.col(i)) > 0 ? -step : step;
      out.col(i) = (residuals(at + side * along.col(i)) - here) / side;
    }
    return out;
  }

  // The weights at the present parameters, and the combinations that the data determine with them: to better than half
  // a range.
  void weigh() {
    Eigen::MatrixXd covariance = problem_.covariance(own_units(at_));
    speckle_ = covariance.diagonal();
    covariance.diagonal() += problem_.error.cwiseAbs2();
    if (!covariance.allFinite()) throw NumericalError("the covariance of the photodiodes is not finite");
    variance_ = covariance.diagonal();
    root_.compute(covariance);
    if (root_.info() !=
        Eigen::Success) {  // rounding, where speckle is the same on diodes that nothing else tells apart
      covariance.diagonal() *= 1 + 1e-6;
      root_.compute(covariance);
    }
    here_ = residuals(at_);
    Eigen::Index const n = at_.size();
    Eigen::MatrixXd const slope = slopes(at_, here_, Eigen::MatrixXd::Identity(n, n));
    modes_ = symmetric_modes(slope.transpose() * slope);
    Eigen::Index const unknown = (modes_.values.array() < 1).count();  // ascending
    basis_ = modes_.vectors.rightCols(n - unknown);
  }
  // Returns the largest change, in standard deviations.
  double improve() {
    Eigen::VectorXd const before = at_;
    auto const place = [&](Eigen::VectorXd const& c) -> Eigen::VectorXd { return before + basis_ * c; };
    Eigen::VectorXd last_at, last;  // the derivatives are taken where the residuals were
    LeastSquaresProblem const least{basis_.cols(), here_.size(),
                                    [&](Eigen::VectorXd const& c, Eigen::VectorXd& out) {
                                      last_at = c;
                                      out = last = residuals(place(c));
                                    },
                                    [&](Eigen::VectorXd const& c, Eigen::MatrixXd& out) {
                                      Eigen::VectorXd const here = c == last_at ? last : residuals(place(c));
                                      out = slopes(place(c), here, basis_);
                                    }};
    Eigen::VectorXd const found = minimise(least, Eigen::VectorXd::Zero(basis_.cols()), 40, tolerance).at;
    at_ = inside(place(found));
    Eigen::VectorXd const size = modes_.values.tail(basis_.cols()).cwiseSqrt();
    return (basis_.transpose() * (at_ - before)).cwiseProduct(size).cwiseAbs().maxCoeff();
  }

  DiodeFit result() const {
    DiodeFit fit;
    Eigen::Index const n = at_.size(), known = basis_.cols(), unknown = n - known;
    Eigen::VectorXd const inverse = modes_.values.tail(known).cwiseInverse();
    Eigen::MatrixXd const covariance = basis_ * inverse.asDiagonal() * basis_.transpose();
    for (Eigen::Index i = 0; i < unknown; ++i) fit.undetermined.push_back(modes_.vectors.col(i));
    Eigen::VectorXd const values = own_units(at_);
    for (Eigen::Index i = 0; i < n; ++i) {
      double const half = 0.5 * (problem_.ranges[std::size_t(i)].high - problem_.ranges[std::size_t(i)].low);
      bool const free =
          std::ranges::any_of(fit.undetermined, [&](Eigen::VectorXd const& v) { return std::fabs(v[i]) > large_part; });
      fit.parameters.push_back({values[i], half * std::sqrt(covariance(i, i)), !free, std::fabs(at_[i]) > 1 - 1e-6});
    }
    fit.correlation = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j)
        if (i != j) {
          bool const both = fit.parameters[std::size_t(i)].determined && fit.parameters[std::size_t(j)].determined;
          fit.correlation(i, j) = both ? covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j)) : 0;
        }
    fit.mean = problem_.mean(values);
    fit.sigma = variance_.cwiseSqrt();
    fit.chi2 = here_.squaredNorm();
    fit.degrees = int(here_.size() - known);
    judge(fit);
    return fit;
  }
  // A power with the gamma distribution of speckle, variance over squared mean 1/M, has the excess kurtosis 6/M, and
  // its square deviation the variance 2 + 6/M of its own variance.
  void judge(DiodeFit& fit) const {
    Eigen::ArrayXd const share = speckle_.array() / variance_.array();
    double const wider =
        3 * (share.square() * speckle_.array() / fit.mean.array().square().max(speckle_.array())).mean();
    fit.effective_degrees = fit.degrees / (1 + wider);
    fit.probability =
        fit.degrees > 0 ? gamma_q(fit.effective_degrees / 2, fit.chi2 * fit.effective_degrees / fit.degrees / 2) : 1;
  }

  DiodeFitProblem const& problem_;
  Eigen::VectorXd at_, here_;
  Eigen::VectorXd speckle_, variance_;  // W^2
  Eigen::LLT<Eigen::MatrixXd> root_;
  SymmetricModes modes_;   // of the information, in half ranges
  Eigen::MatrixXd basis_;  // of what the data determine
};

}  // namespace

DiodeFit fit_diodes(DiodeFitProblem const& problem) { return ScaledFit(problem).run(); }

}  // namespace straytrace::wave
