// SPDX-License-Identifier: BSD-3-Clause
#include "beams/overlap.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "base/math/distributions.hpp"

namespace straytrace::beams {

namespace {

void require_one_medium(Mode const& u, Mode const& v) {
  if (std::fabs(u.wavelength / v.wavelength - 1) > 1e-9)
    throw NumericalError(fmt::format(
        "beams of {:.9g} m and {:.9g} m have no overlap: they must be in the same medium, of one wavelength",
        u.wavelength, v.wavelength));
}

// Halfway between both directions.
Plane plane_across(Mode const& u, Mode const& v) {
  Vec3 const normal = unit(u.travel + v.travel), t1 = any_normal(normal);
  return {0.5 * (u.origin + v.origin), t1, cross(normal, t1)};
}

std::complex<double> log_overlap(Mode const& u, Mode const& v) {
  require_one_medium(u, v);
  if (!(dot(u.travel, v.travel) > 0)) return -infinity;
  Plane const plane = plane_across(u, v);
  return product(on_plane(u, plane), on_plane(v, plane)).log_integral();
}

}  // namespace

std::complex<double> overlap(Mode const& u, Mode const& v) { return std::exp(log_overlap(u, v)); }
double power_overlap(Mode const& u, Mode const& v) { return std::exp(log_power_overlap(u, v)); }
double log_power_overlap(Mode const& u, Mode const& v) { return 2 * log_overlap(u, v).real(); }

// On the plane u = exp ik[slope.t + t.q t/2], t from its chief ray. A ray moved by c on the plane and by `slope` of its
// direction changes ln u by ik (slope.t - c.q t) about the phase that it has there, and ln of the integral by the same
// with the mean of t, weighted by u conj(v).
OverlapSlope overlap_slope(Mode const& u, Mode const& v) {
  require_one_medium(u, v);
  if (!(dot(u.travel, v.travel) > 0)) return {};
  Plane const plane = plane_across(u, v);
  PlaneField const moving = on_plane(u, plane), fixed = on_plane(v, plane);
  FieldProduct const p = product(moving, fixed);
  Eigen::Vector2cd const mean = -(p.s.inverse() * p.g) - (moving.centre - fixed.centre).cast<std::complex<double>>();
  Eigen::Vector2cd const bent = moving.q * mean;
  std::complex<double> const ik(0, p.k);
  Vec3 const normal = plane.normal();
  double const cosine = dot(u.travel, normal), z = dot(plane.point - u.origin, normal) / cosine;
  auto const at = [](Vec3 a, int i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; };
  // Along the ray onto the plane.
  std::complex<double> const along = (bent(0) * dot(plane.t1, u.travel) + bent(1) * dot(plane.t2, u.travel)) / cosine;
  OverlapSlope slope;
  for (int i = 0; i < 3; ++i) {
    auto const part = std::size_t(i);
    slope.shift[part] = -ik * (bent(0) * at(plane.t1, i) + bent(1) * at(plane.t2, i) - along * at(normal, i));
    slope.turn[part] = ik * (mean(0) * at(plane.t1, i) + mean(1) * at(plane.t2, i)) + z * slope.shift[part];
  }
  return slope;
}

PlaneField on_plane(Mode const& m, Plane const& plane) {
  double const cosine = dot(m.travel, plane.normal());
  double const z = dot(plane.point - m.origin, plane.normal()) / cosine;
  Mode const here = propagated(m, z);
  Vec3 const middle = here.origin - plane.point;
  Eigen::Matrix2d across;  // of points of the plane, in the frame of the beam
  across << dot(m.e1, plane.t1), dot(m.e1, plane.t2), dot(m.e2, plane.t1), dot(m.e2, plane.t2);
  Eigen::Matrix2cd q;
  q << here.q11, here.q12, here.q12, here.q22;

  PlaneField f;
  f.k = m.wave_number();
  f.centre = {dot(middle, plane.t1), dot(middle, plane.t2)};
  f.slope = {dot(m.travel, plane.t1), dot(m.travel, plane.t2)};
  f.q = across.transpose() * q * across;
  double const size = f.q.imag().determinant();  // (k/pi)^2 times it is the square of the peak of |.|^2
  f.log_amplitude = {0.5 * std::log(f.k / pi * std::sqrt(size)), f.k * z - gouy(m, z)};
  return f;
}

FieldProduct product(PlaneField const& u, PlaneField const& v) {
  Eigen::Vector2d const d = u.centre - v.centre;
  Eigen::Vector2cd const bent = u.q * d;
  std::complex<double> const i{0, 1};
  FieldProduct p;
  p.k = u.k;
  p.s = u.q - v.q.conjugate();
  p.g = (u.slope - v.slope).cast<std::complex<double>>() - bent;
  std::complex<double> const at_zero = -u.slope.dot(d) + 0.5 * (bent(0) * d(0) + bent(1) * d(1));
  p.log_amplitude = u.log_amplitude + std::conj(v.log_amplitude) + i * u.k * at_zero;
  return p;
}

std::complex<double> FieldProduct::log_integral() const {
  // -i S has a positive definite real part: the roots of its eigenvalues are the principal ones.
  std::complex<double> const i{0, 1};
  auto const part = eigenvalues<std::complex<double>>(-i * s(0, 0), -i * s(0, 1), -i * s(1, 1));
  Eigen::Vector2cd const x = s.inverse() * g;
  std::complex<double> const exponent = log_amplitude - 0.5 * i * k * (g(0) * x(0) + g(1) * x(1));
  return exponent + std::log(2 * pi / k) - 0.5 * (std::log(part[0]) + std::log(part[1]));
}

namespace {

void refuse_turned(Mode const& basis) {
  if (std::abs(basis.q12) > 1e-9 * std::sqrt(basis.q11.imag() * basis.q22.imag()))
    throw NumericalError(
        "Hermite-Gauss modes need a beam whose principal axes are those of its frame (q12 = 0); this one is turned or "
        "twisted");
}

}  // namespace

double hermite_function(int n, double x) {
  double before = 0, value = std::exp(-0.5 * x * x) / std::sqrt(std::sqrt(pi));
  for (int i = 0; i < n; ++i) {
    double const next = std::sqrt(2.0 / (i + 1)) * x * value - std::sqrt(double(i) / (i + 1)) * before;
    before = value;
    value = next;
  }
  return value;
}

ModeCoefficients::ModeCoefficients(int order)
    : order_(order), values_(static_cast<std::size_t>((order + 1) * (order + 2) / 2)) {}

double ModeCoefficients::power() const {
  double sum = 0;
  for (auto c : values_) sum += std::norm(c);
  return sum;
}

namespace {

// sum over a, b of c(a, b) s^a t^b / sqrt(a! b!) = c(0, 0) exp((s, t).bend (s, t)/2 + tilt.(s, t)).
struct GeneratingGaussian {
  std::complex<double> middle;  // c(0, 0)
  Eigen::Matrix2cd bend;
  Eigen::Vector2cd tilt;
};
// Overlap of `beam` with the Hermite-Gauss modes of `basis`, whose principal axes must be e1 and e2.
GeneratingGaussian generating_gaussian(Mode const& beam, Mode const& basis) {
  Plane const plane{basis.origin, basis.e1, basis.e2};
  FieldProduct const p = product(on_plane(beam, plane), on_plane(basis, plane));
  // sum of u_ab s^a t^b / sqrt(a! b!) = u_00 exp(2 (x s/w1 + y t/w2) - (s^2 + t^2)/2): one more Gaussian integral.
  double const scale = basis.wavelength / pi;
  Eigen::Vector2cd const per_w{std::sqrt(basis.q11.imag() / scale), std::sqrt(basis.q22.imag() / scale)};
  Eigen::Matrix2cd const width = p.s.inverse();
  std::complex<double> const i{0, 1};
  GeneratingGaussian series;
  series.middle = std::exp(p.log_integral());
  series.bend = (4.0 * i / p.k) * per_w.asDiagonal() * width * per_w.asDiagonal();
  series.bend -= Eigen::Matrix2cd::Identity();
  series.tilt = -2.0 * per_w.cwiseProduct(width * p.g);
  return series;
}

ModeCoefficients coefficients(GeneratingGaussian const& series, int order) {
  ModeCoefficients c(order);
  c(0, 0) = series.middle;
  auto const& r = series.bend;
  for (int total = 1; total <= order; ++total)
    for (int b = 0; b <= total; ++b) {
      // One step down along the longer index, by the derivative of the generating function along it.
      int const a = total - b;
      bool const along_a = a >= b;
      int const n = along_a ? a - 1 : b - 1, m = along_a ? b : a;
      int const one = along_a ? 0 : 1, two = 1 - one;
      auto const at = [&](int i, int j) { return along_a ? c(i, j) : c(j, i); };
      std::complex<double> sum = series.tilt(one) * at(n, m);
      if (n > 0) sum += r(one, one) * std::sqrt(double(n)) * at(n - 1, m);
      if (m > 0) sum += r(one, two) * std::sqrt(double(m)) * at(n, m - 1);
      c(a, b) = sum / std::sqrt(n + 1.0);
    }
  return c;
}

}  // namespace

ModeCoefficients hermite_coefficients(Mode const& beam, Mode const& basis, int order) {
  refuse_turned(basis);
  return coefficients(generating_gaussian(beam, basis), order);
}

double laguerre_function(int p, int l, double x) {
  double before = 0, value = std::exp(-0.5 * x);
  for (int i = 1; i <= l; ++i) value *= std::sqrt(x / i);
  for (int i = 0; i < p; ++i) {
    double const up = std::sqrt((i + 1.0) * (i + 1 + l)), down = std::sqrt(double(i) * (i + l));
    double const next = ((2 * i + 1 + l - x) * value - down * before) / up;
    before = value;
    value = next;
  }
  return value;
}

namespace {

// One quantum more along x (`y` false) or along y, in terms of those that turn with +phi and -phi: amplitudes of
// 0, 1, ... quanta turning with +phi. `quanta`: those along this axis afterwards.
std::vector<std::complex<double>> raised(std::vector<std::complex<double>> const& state, bool y, int quanta) {
  std::complex<double> const forward = y ? std::complex<double>{0, -1} : 1, backward = std::conj(forward);
  auto const total = state.size();
  std::vector<std::complex<double>> next(total + 1);
  for (std::size_t a = 0; a <= total; ++a) {
    if (a > 0) next[a] += forward * std::sqrt(double(a)) * state[a - 1];
    if (a < total) next[a] += backward * std::sqrt(double(total - a)) * state[a];
    next[a] /= std::sqrt(2.0 * quanta);
  }
  return next;
}

}  // namespace

LaguerreCoefficients::LaguerreCoefficients(ModeCoefficients const& hermite) : circular_(hermite.order()) {
  std::vector<std::complex<double>> along_x{1};
  for (int n = 0; n <= hermite.order(); ++n) {
    std::vector<std::complex<double>> state = along_x;
    for (int m = 0; n + m <= hermite.order(); ++m) {
      for (int a = 0; a <= n + m; ++a) circular_(a, n + m - a) += hermite(n, m) * state[std::size_t(a)];
      state = raised(state, true, m + 1);
    }
    along_x = raised(along_x, false, n + 1);
  }
}

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
  std::ranges::sort(angles);
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
  return off_centre_chi_squared_tail(2, 4 * d * d / (w * w), 4 * aperture * aperture / (w * w));
}

double clipped_share(double aperture, std::array<double, 2> w, std::array<double, 2> offset) {
  double const a = aperture;
  // Only the part outside is summed, in strips along y: no difference of large numbers.
  auto const outside = [&](double angle) {
    double const x = a * std::sin(angle) - offset[0], half = a * std::cos(angle);
    double const density = std::sqrt(2 / pi) / w[0] * std::exp(-2 * x * x / (w[0] * w[0]));
    return half * density * (beyond_edge(half - offset[1], w[1]) + beyond_edge(half + offset[1], w[1]));
  };
  using Kronrod = boost::math::quadrature::gauss_kronrod<double, 31>;
  double loss = beyond_edge(a - offset[0], w[0]) + beyond_edge(a + offset[0], w[0]);
  struct Piece {
    double from, to, value, error;
  };
  std::vector<Piece> pieces;
  auto const angles = interesting_angles(a, w, offset);
  for (std::size_t i = 1; i < angles.size(); ++i) {
    Piece piece{angles[i - 1], angles[i], 0, 0};
    if (piece.to > piece.from) piece.value = Kronrod::integrate(outside, piece.from, piece.to, 0, 0, &piece.error);
    loss += piece.value;
    pieces.push_back(piece);
  }
  // Refines the pieces whose error matters in the sum.
  double const allowed = accuracy * loss / static_cast<double>(pieces.size());
  for (Piece const& piece : pieces)
    if (piece.error > allowed)
      loss +=
          Kronrod::integrate(outside, piece.from, piece.to, 12, std::min(allowed / piece.value, 1e-3)) - piece.value;
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

namespace {

using Complex128 = std::complex<double>;
constexpr Complex128 imaginary{0, 1};
using Rule = boost::math::quadrature::gauss<double, 20>;
constexpr double wanted = 1e-10, accepted = 1e-3;  // relative errors
constexpr unsigned most_points = 1u << 23;

// exp(constant - gamma s), s = (x - cx)^2 + (y - cy)^2 about a complex point, from the centre of the opening.
struct Integrand {
  Complex128 gamma, cx, cy, constant;
  double distance() const { return std::sqrt(std::norm(cx) + std::norm(cy)); }
};

double inner(Opening const& a) { return std::max(0.0, a.radius - 0.5 * a.tooth_height); }
double outer(Opening const& a) { return a.radius + 0.5 * a.tooth_height; }

// (e^c - e^(c - z))/z, entire.
Complex128 decline(Complex128 c, Complex128 z) {
  if (std::norm(z) > 1e-2) return (std::exp(c) - std::exp(c - z)) / z;
  Complex128 term = 1, sum = 1;
  for (int n = 2; n < 12; ++n) sum += term *= -z / double(n);
  return std::exp(c) * sum;
}

// The integrand is the divergence of (r - c) (1 - exp(-gamma s))/(2 gamma s), so the integral over an opening is that
// of the flow through its rim r(angle): one integral of a smooth function, without a pole.
Complex128 flow(Integrand const& f, double angle, double r, double slope) {
  double const c = std::cos(angle), s = std::sin(angle);
  Complex128 const x = r * c - f.cx, y = r * s - f.cy;
  Complex128 const through = x * (slope * s + r * c) + y * (r * s - slope * c);
  return 0.5 * through * decline(f.constant, f.gamma * (x * x + y * y));
}

// Sum over a rim, and how much the last refinement changed it.
struct Estimate {
  Complex128 value;
  double change = infinity;
  bool good(double part) const { return change <= part * std::abs(value); }
};

// Harmonics that exp(x cos angle) holds: they fall faster than exponentially beyond the order x.
double orders_of(double x) { return x + 5 * std::cbrt(x) + 20; }

// Round rim: an even sum over the angle has the integral but for harmonics beyond the number of points. Half of the
// points hold all of them already.
Estimate around_circle(Integrand const& f, double r) {
  double const orders = orders_of(2 * r * std::abs(f.gamma) * f.distance());
  Estimate sum;
  for (double half = std::ceil(orders); half < most_points; half *= 2) {
    Complex128 even = 0, odd = 0;
    for (double j = 0; j < half; ++j) {
      even += flow(f, 2 * pi * j / half, r, 0);
      odd += flow(f, 2 * pi * (j + 0.5) / half, r, 0);
    }
    sum.value = pi / half * (even + odd);
    sum.change = pi / half * std::abs(even - odd);
    if (sum.good(wanted)) break;
  }
  return sum;
}

// Triangular teeth, edge by edge.
Estimate around_teeth(Integrand const& f, Opening const& a) {
  double const half = pi / a.teeth, slope = a.tooth_height / half;
  double const edge = std::hypot(a.tooth_height, a.radius * half);
  double const turns = 2 * (outer(a) + f.distance()) * std::abs(f.gamma) * edge / pi;
  Estimate sum;
  for (double panels = std::ceil(turns) + 1; panels * 2 * a.teeth * 20 < most_points; panels *= 2) {
    Complex128 value = 0;
    for (unsigned tooth = 0; tooth < a.teeth; ++tooth)
      for (int side : {-1, 1})
        for (double p = 0; p < panels; ++p)
          value += Rule::integrate(
              [&](double along) {  // from the tip
                return flow(f, a.phase + (2.0 * tooth) * half + side * along, inner(a) + slope * along, side * slope);
              },
              half * p / panels, half * (p + 1) / panels);
    sum.change = std::abs(value - sum.value);
    sum.value = value;
    if (sum.good(wanted)) break;
  }
  return sum;
}

// Teeth of random height: the mean over round rims between tips and valleys.
Estimate around_random(Integrand const& f, Opening const& a) {
  double const low = inner(a), high = outer(a);
  double const turns = (high + f.distance()) * 2 * std::abs(f.gamma) * (high - low) / pi;
  Estimate sum;
  for (double panels = std::ceil(turns) + 1; panels < 4e4; panels *= 2) {
    Complex128 value = 0;
    for (double p = 0; p < panels; ++p)
      value += Rule::integrate([&](double r) { return around_circle(f, r).value; }, low + (high - low) * p / panels,
                               low + (high - low) * (p + 1) / panels);
    value /= high - low;
    sum.change = std::abs(value - sum.value);
    sum.value = value;
    if (sum.good(1e-7)) break;
  }
  return sum;
}

Complex128 integral(Integrand const& f, Opening const& a, double scale) {
  Estimate const sum = a.tooth_height == 0 ? around_circle(f, a.radius)
                       : a.teeth > 0       ? around_teeth(f, a)
                                           : around_random(f, a);
  if (!(sum.change <= accepted * std::max(std::abs(sum.value), 1e-3 * scale)))
    throw NumericalError("the field so close behind an aperture cannot be integrated: go farther away");
  return sum.value;
}

double wave_number(BeamInPlane const& beam) { return 2 * pi / beam.wavelength; }
Complex128 decay(BeamInPlane const& beam) {
  return 1 / (beam.w * beam.w) - 0.5 * imaginary * wave_number(beam) * beam.curvature;
}

}  // namespace

double clipped_share(BeamInPlane const& beam, Opening const& a) {
  double const offset = std::hypot(a.x, a.y);
  if (a.tooth_height == 0) return clipped_share(a.radius, beam.w, offset);
  auto const at = [&](double r) { return clipped_share(r, beam.w, offset); };
  return Rule::integrate(at, inner(a), outer(a)) / (outer(a) - inner(a));
}

Complex128 field_behind(BeamInPlane const& beam, Opening const& a, double z, double x, double y) {
  double const k = wave_number(beam), dx = x - a.x, dy = y - a.y;
  Complex128 const g = decay(beam), lens = 0.5 * imaginary * k / z, gamma = g - lens;
  // -g |r + a|^2 + lens |r - d|^2 = constant - gamma |r - c|^2
  Complex128 const cx = -(g * a.x + lens * dx) / gamma, cy = -(g * a.y + lens * dy) / gamma;
  Complex128 const constant = -g * (a.x * a.x + a.y * a.y) + lens * (dx * dx + dy * dy) + gamma * (cx * cx + cy * cy);
  Complex128 const before = k / (2 * pi * imaginary * z);
  return before * integral({gamma, cx, cy, constant}, a, std::abs(free_field(beam, z, 0, 0) / before));
}

Complex128 free_field(BeamInPlane const& beam, double z, double x, double y) {
  double const k = wave_number(beam);
  Complex128 const q = 2.0 * imaginary * decay(beam) / k, spread = 1.0 + z * q;  // q: complex curvature Q
  return std::exp(0.5 * imaginary * k * (q / spread) * (x * x + y * y)) / spread;
}

}  // namespace straytrace::beams
