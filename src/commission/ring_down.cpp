// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "commission/impulse.hpp"

namespace straytrace {
namespace {

using Complex = std::complex<double>;

// Given frequency and damping rate, amplitude and background follow by linear least squares.
class Mode {
 public:
  Mode(ImpulseResponse const& r, std::size_t from, std::size_t to, double length)
      : r_(r), from_(from), to_(to), length_(length) {
    for (std::size_t k = from; k <= to; ++k) floor_ = std::max(floor_, 1e-9 * std::abs(r.response[k]));
  }

  // Transform of exp(-gamma t + 2 pi i f t) from 0 to the end of the stretch.
  Complex shape(std::size_t k, double hz, double gamma) const {
    Complex const s(gamma, 2 * pi * (r_.hz[k] - hz));
    return (1.0 - (std::isfinite(length_) ? std::exp(-s * length_) : Complex(0))) / s;
  }

  double chi(double hz, double gamma, Complex* amplitude = nullptr, double* amplitude_sigma = nullptr) const {
    Eigen::Matrix2cd normal = Eigen::Matrix2cd::Zero();
    Eigen::Vector2cd right = Eigen::Vector2cd::Zero();
    for (std::size_t k = from_; k <= to_; ++k) {
      Eigen::Vector2cd const row(shape(k, hz, gamma), 1);
      normal += weight(k) * row.conjugate() * row.transpose();
      right += weight(k) * row.conjugate() * r_.response[k];
    }
    Eigen::Vector2cd const x = normal.fullPivLu().solve(right);
    double sum = 0;
    for (std::size_t k = from_; k <= to_; ++k)
      sum += weight(k) * std::norm(r_.response[k] - x[0] * shape(k, hz, gamma) - x[1]);
    if (amplitude) *amplitude = x[0];
    if (amplitude_sigma) *amplitude_sigma = std::sqrt(normal.inverse()(0, 0).real());
    return sum;
  }

  int degrees() const { return int(2 * (to_ - from_ + 1)) - 6; }

 private:
  double weight(std::size_t k) const { return 1 / std::pow(std::max(r_.sigma[k], floor_), 2); }

  ImpulseResponse const& r_;
  std::size_t from_, to_;
  double length_, floor_ = 0;
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
      if (double const c = mode.chi(double(k) * bin / 4, g); c < best) best = c, hz = double(k) * bin / 4, rate = g;
  auto const f = [&](Eigen::Vector2d const& p) { return mode.chi(p[0], std::exp(p[1])); };
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
  Eigen::Matrix2d const covariance = 2 * curvature.inverse();  // chi^2 + 1
  RingDown out;
  Complex amplitude;
  double sigma = 0;
  out.chi_square = mode.chi(at[0], std::exp(at[1]), &amplitude, &sigma);
  out.degrees = mode.degrees();
  out.hz = at[0];
  out.hz_sigma = std::sqrt(std::max(0.0, covariance(0, 0)));
  out.tau = std::exp(-at[1]);
  out.quality = pi * out.hz * out.tau;
  out.quality_sigma = out.quality * std::sqrt(std::max(0.0, covariance(1, 1)));
  // a cos(..) holds half of a at positive frequencies. The amplitude moves with the damping rate, about in proportion.
  out.amplitude = 2 * std::abs(amplitude);
  out.amplitude_sigma = out.amplitude * std::hypot(sigma / std::abs(amplitude), out.quality_sigma / out.quality);
  return out;
}

}  // namespace straytrace
