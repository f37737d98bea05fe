// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "commission/impulse.hpp"

namespace straytrace {
namespace {

using Complex = std::complex<double>;

// Of c exp(-gamma t + 2 pi i f t) + its conjugate, and a constant. Given frequency and damping rate, the real and
// imaginary parts of c and of the constant follow by linear least squares.
class Mode {
 public:
  Mode(ImpulseResponse const& r, std::size_t from, std::size_t to, double length)
      : length_(length), answer_(2 * Eigen::Index(to - from + 1)) {
    double floor = 0;
    for (std::size_t k = from; k <= to; ++k) floor = std::max(floor, 1e-9 * std::abs(r.response[k]));
    for (std::size_t k = from; k <= to; ++k) {
      hz_.push_back(r.hz[k]);
      weight_.push_back(1 / std::max(r.sigma[k], floor));
      put(answer_, k - from, r.response[k]);
    }
  }

  struct Fit {
    Eigen::Vector4d linear;
    double chi;
  };
  Fit fit(double hz, double gamma) const {
    Eigen::MatrixXd const a = columns(hz, gamma);
    Eigen::Vector4d const x = (a.transpose() * a).ldlt().solve(a.transpose() * answer_);
    return {x, (answer_ - a * x).squaredNorm()};
  }

  // Of Re c, Im c, the constant, frequency and ln gamma.
  Eigen::MatrixXd covariance(double hz, double gamma, Eigen::Vector4d const& x) const {
    double const df = 1e-3 * gamma, dg = 1e-3;
    Eigen::MatrixXd slopes(answer_.size(), 6);
    slopes << columns(hz, gamma), (columns(hz + df, gamma) - columns(hz - df, gamma)) * x / (2 * df),
        (columns(hz, gamma * std::exp(dg)) - columns(hz, gamma * std::exp(-dg))) * x / (2 * dg);
    Eigen::VectorXd const scale = slopes.colwise().norm().cwiseInverse();
    Eigen::MatrixXd const unit = slopes * scale.asDiagonal();
    return scale.asDiagonal() * (unit.transpose() * unit).inverse() * scale.asDiagonal();
  }

  int degrees() const { return int(answer_.size()) - 6; }

 private:
  // Transform of exp(-gamma t + 2 pi i f t) from 0 to the end of the stretch, `away` from f.
  Complex ring(double away, double gamma) const {
    Complex const s(gamma, 2 * pi * away);
    return (1.0 - (std::isfinite(length_) ? std::exp(-s * length_) : Complex(0))) / s;
  }

  Eigen::MatrixXd columns(double hz, double gamma) const {
    Eigen::MatrixXd a(answer_.size(), 4);
    for (std::size_t k = 0; k < hz_.size(); ++k) {
      Complex const above = ring(hz_[k] - hz, gamma), below = ring(hz_[k] + hz, gamma);
      put(a.col(0), k, above + below);
      put(a.col(1), k, Complex(0, 1) * (above - below));
      put(a.col(2), k, 1);
      put(a.col(3), k, Complex(0, 1));
    }
    return a;
  }

  template <class Column>
  void put(Column&& column, std::size_t k, Complex value) const {
    column[2 * Eigen::Index(k)] = weight_[k] * value.real();
    column[2 * Eigen::Index(k) + 1] = weight_[k] * value.imag();
  }

  double length_;
  std::vector<double> hz_, weight_;  // 1/sigma
  Eigen::VectorXd answer_;           // real and imaginary parts over sigma
};

}  // namespace

RingDown fit_ring_down(ImpulseResponse const& r, std::size_t from, std::size_t to, double length) {
  Mode const mode(r, from, to, length);
  double const bin = r.hz[1];
  // Coarse: frequencies around the highest bin and all damping rates that the bins can show; then Newton on both.
  std::size_t top = from;
  for (std::size_t k = from; k <= to; ++k)
    if (std::abs(r.response[k]) > std::abs(r.response[top])) top = k;
  double hz = 0, rate = 0, best = infinity;
  for (std::size_t k = 4 * top - 4; k <= 4 * top + 4; ++k)
    for (double g = 0.1 * bin; g < 4 * pi * bin * double(to - from); g *= 1.6)
      if (double const c = mode.fit(double(k) * bin / 4, g).chi; c < best) best = c, hz = double(k) * bin / 4, rate = g;
  auto const f = [&](Eigen::Vector2d const& p) { return mode.fit(p[0], std::exp(p[1])).chi; };
  Eigen::Vector2d at(hz, std::log(rate));
  Eigen::Matrix2d curvature;
  double step_f = 1e-2 * std::min(bin, rate), step_g = 1e-2;
  for (int i = 0; i < 30; ++i) {
    Eigen::Vector2d const u(step_f, 0), v(0, step_g);
    double const here = f(at), fu = f(at + u), bu = f(at - u), fv = f(at + v), bv = f(at - v);
    double const mixed = (f(at + u + v) - f(at + u - v) - f(at - u + v) + f(at - u - v)) / (4 * step_f * step_g);
    curvature << (fu - 2 * here + bu) / (step_f * step_f), mixed, mixed, (fv - 2 * here + bv) / (step_g * step_g);
    Eigen::Vector2d const slope((fu - bu) / (2 * step_f), (fv - bv) / (2 * step_g));
    Eigen::Vector2d move = -curvature.fullPivLu().solve(slope);
    while (f(at + move) > here && move.norm() > 1e-14) move /= 2;
    at += move;
    if (std::fabs(move[0]) < 1e-6 * bin && std::fabs(move[1]) < 1e-6) break;
  }
  Mode::Fit const best_fit = mode.fit(at[0], std::exp(at[1]));
  RingDown out;
  out.chi_square = best_fit.chi;
  out.degrees = mode.degrees();
  // What the bins scatter around the mode is their error: the noise may be less, where the knock before still rings, or
  // another mode more.
  Eigen::MatrixXd const covariance =
      mode.covariance(at[0], std::exp(at[1]), best_fit.linear) * out.chi_square / out.degrees;
  out.hz = at[0];
  out.hz_sigma = std::sqrt(covariance(4, 4));
  out.tau = std::exp(-at[1]);
  out.quality = pi * out.hz * out.tau;
  out.quality_sigma = out.quality * std::sqrt(covariance(5, 5));
  // a cos(..) holds half of a at positive frequencies.
  Eigen::Vector2d const c = best_fit.linear.head<2>(), along = c.normalized();
  out.amplitude = 2 * c.norm();
  out.phase = std::atan2(c[1], c[0]);
  out.amplitude_sigma = 2 * std::sqrt(along.dot(covariance.topLeftCorner<2, 2>() * along));
  return out;
}

}  // namespace straytrace
