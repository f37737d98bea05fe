// SPDX-License-Identifier: BSD-3-Clause
#include "beams/clipping.hpp"

#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <algorithm>
#include <vector>

#include "beams/mode.hpp"
#include "beams/overlap.hpp"

namespace straytrace {

namespace {

constexpr double far = 20;          // beam radii: exp(-2 far^2) is zero in double precision
constexpr double accuracy = 1e-11;  // relative, of an elliptic beam

// Share of a Gaussian of radius w beyond a straight edge at distance x from its middle.
double beyond_edge(double x, double w) { return 0.5 * std::erfc(std::sqrt(2.0) * x / w); }

// Angles where the integrand over x = a sin(angle) has features: where the rim is, in units of w, near the middle of
// the beam in x or in y.
std::vector<double> interesting_angles(double a, std::array<double, 2> w, std::array<double, 2> d) {
  std::vector<double> angles{-pi / 2, pi / 2};
  for (double side : {-far, -5.0, -1.0, 0.0, 1.0, 5.0, far}) {
    double const x = (d[0] + side * w[0]) / a, y = (std::fabs(d[1]) + side * w[1]) / a;
    if (std::fabs(x) < 1) angles.push_back(std::asin(x));
    if (0 < y && y < 1) angles.insert(angles.end(), {std::acos(y), -std::acos(y)});
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace

double clipped_share(double aperture, double w) { return std::exp(-2 * aperture * aperture / (w * w)); }

double clipped_share(double aperture, double w, double offset) {
  double const d = std::fabs(offset);
  if (d == 0 || aperture == 0) return clipped_share(aperture, w);
  if (aperture - d > far * w) return 0;
  if (d - aperture > far * w) return 1;
  // Marcum's Q_1(2d/w, 2a/w) is the survival function of a noncentral chi-squared variable of 2 degrees of freedom.
  boost::math::non_central_chi_squared const radius2(2, 4 * d * d / (w * w));
  return boost::math::cdf(boost::math::complement(radius2, 4 * aperture * aperture / (w * w)));
}

double clipped_share(double aperture, std::array<double, 2> w, std::array<double, 2> offset) {
  double const a = aperture;
  // Strip by strip along y, only what is outside is summed: no difference of large numbers.
  auto const outside = [&](double angle) {
    double const x = a * std::sin(angle) - offset[0], half = a * std::cos(angle);
    double const density = std::sqrt(2 / pi) / w[0] * std::exp(-2 * x * x / (w[0] * w[0]));
    return half * density * (beyond_edge(half - offset[1], w[1]) + beyond_edge(half + offset[1], w[1]));
  };
  using Rule = boost::math::quadrature::gauss_kronrod<double, 31>;
  double loss = beyond_edge(a - offset[0], w[0]) + beyond_edge(a + offset[0], w[0]);
  struct Piece {
    double from, to, value, error;
  };
  std::vector<Piece> pieces;
  auto const angles = interesting_angles(a, w, offset);
  for (std::size_t i = 1; i < angles.size(); ++i) {
    Piece piece{angles[i - 1], angles[i], 0, 0};
    if (piece.to > piece.from) piece.value = Rule::integrate(outside, piece.from, piece.to, 0, 0, &piece.error);
    loss += piece.value;
    pieces.push_back(piece);
  }
  // Once more where the error counts in the sum.
  double const allowed = accuracy * loss / static_cast<double>(pieces.size());
  for (Piece const& piece : pieces)
    if (piece.error > allowed)
      loss += Rule::integrate(outside, piece.from, piece.to, 12, std::min(allowed / piece.value, 1e-3)) - piece.value;
  return std::min(loss, 1.0);
}

double clipped_share(Aperture const& hole, Mode const& mode) {
  Vec3 const normal = dot(hole.normal, mode.travel) < 0 ? -hole.normal : hole.normal, t1 = any_normal(normal);
  PlaneField const f = on_plane(mode, {hole.centre, t1, cross(normal, t1)});
  Eigen::Matrix2d const size = f.q.imag();  // |.|^2 ~ exp(-k d.size d)
  auto const s = eigenvalues(size(0, 0), size(0, 1), size(1, 1));
  std::array const w{std::sqrt(2 / (f.k * s[0])), std::sqrt(2 / (f.k * s[1]))};
  if (std::fabs(w[0] / w[1] - 1) < 1e-7) return clipped_share(hole.radius, std::sqrt(w[0] * w[1]), f.centre.norm());
  // Principal axes of the spot; the one of w[0] is the nearer to t1.
  double const larger = larger_axis(size(0, 0), size(0, 1), size(1, 1)),
               angle = s[0] >= s[1] ? larger : larger + pi / 2;
  double const x = std::cos(angle) * f.centre(0) + std::sin(angle) * f.centre(1);
  double const y = -std::sin(angle) * f.centre(0) + std::cos(angle) * f.centre(1);
  return clipped_share(hole.radius, w, {x, y});
}

}  // namespace straytrace
