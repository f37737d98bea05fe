// SPDX-License-Identifier: BSD-3-Clause
#include "beams/diffraction.hpp"

#include <boost/math/quadrature/gauss.hpp>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "beams/clipping.hpp"

namespace straytrace {
namespace {

using Complex = std::complex<double>;
constexpr Complex i{0, 1};
using Rule = boost::math::quadrature::gauss<double, 20>;
constexpr double wanted = 1e-10, accepted = 1e-3;  // relative errors
constexpr unsigned most_points = 1u << 23;

// exp(constant - gamma s), s = (x - cx)^2 + (y - cy)^2 about a complex point, from the centre of the opening.
struct Integrand {
  Complex gamma, cx, cy, constant;
  double distance() const { return std::sqrt(std::norm(cx) + std::norm(cy)); }
};

double inner(Opening const& a) { return std::max(0.0, a.radius - 0.5 * a.tooth_height); }
double outer(Opening const& a) { return a.radius + 0.5 * a.tooth_height; }

// (e^c - e^(c - z))/z, entire.
Complex decline(Complex c, Complex z) {
  if (std::norm(z) > 1e-2) return (std::exp(c) - std::exp(c - z)) / z;
  Complex term = 1, sum = 1;
  for (int n = 2; n < 12; ++n) sum += term *= -z / double(n);
  return std::exp(c) * sum;
}

// The integrand is the divergence of (r - c) (1 - exp(-gamma s))/(2 gamma s), so the integral over an opening is that
// of the flow through its rim r(angle): one integral of a smooth function, without a pole.
Complex flow(Integrand const& f, double angle, double r, double slope) {
  double const c = std::cos(angle), s = std::sin(angle);
  Complex const x = r * c - f.cx, y = r * s - f.cy;
  Complex const through = x * (slope * s + r * c) + y * (r * s - slope * c);
  return 0.5 * through * decline(f.constant, f.gamma * (x * x + y * y));
}

// Sum over a rim, and how much the last refinement changed it.
struct Estimate {
  Complex value;
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
    Complex even = 0, odd = 0;
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
    Complex value = 0;
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
    Complex value = 0;
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

Complex integral(Integrand const& f, Opening const& a, double scale) {
  Estimate const sum = a.tooth_height == 0 ? around_circle(f, a.radius)
                       : a.teeth > 0       ? around_teeth(f, a)
                                           : around_random(f, a);
  if (!(sum.change <= accepted * std::max(std::abs(sum.value), 1e-3 * scale)))
    throw NumericalError("the field so close behind an aperture cannot be integrated: go farther away");
  return sum.value;
}

double wave_number(BeamInPlane const& beam) { return 2 * pi / beam.wavelength; }
Complex decay(BeamInPlane const& beam) { return 1 / (beam.w * beam.w) - 0.5 * i * wave_number(beam) * beam.curvature; }

}  // namespace

double clipped_share(BeamInPlane const& beam, Opening const& a) {
  double const offset = std::hypot(a.x, a.y);
  if (a.tooth_height == 0) return clipped_share(a.radius, beam.w, offset);
  auto const at = [&](double r) { return clipped_share(r, beam.w, offset); };
  return Rule::integrate(at, inner(a), outer(a)) / (outer(a) - inner(a));
}

Complex field_behind(BeamInPlane const& beam, Opening const& a, double z, double x, double y) {
  double const k = wave_number(beam), dx = x - a.x, dy = y - a.y;
  Complex const g = decay(beam), lens = 0.5 * i * k / z, gamma = g - lens;
  // -g |r + a|^2 + lens |r - d|^2 = constant - gamma |r - c|^2
  Complex const cx = -(g * a.x + lens * dx) / gamma, cy = -(g * a.y + lens * dy) / gamma;
  Complex const constant = -g * (a.x * a.x + a.y * a.y) + lens * (dx * dx + dy * dy) + gamma * (cx * cx + cy * cy);
  Complex const before = k / (2 * pi * i * z);
  return before * integral({gamma, cx, cy, constant}, a, std::abs(free_field(beam, z, 0, 0) / before));
}

Complex free_field(BeamInPlane const& beam, double z, double x, double y) {
  double const k = wave_number(beam);
  Complex const q = 2.0 * i * decay(beam) / k, spread = 1.0 + z * q;  // q: complex curvature Q
  return std::exp(0.5 * i * k * (q / spread) * (x * x + y * y)) / spread;
}

double axis_factor(BeamInPlane const& beam, Opening const& a, double z) {
  return std::norm(field_behind(beam, a, z, 0, 0) / free_field(beam, z, 0, 0));
}

double far_axis_factor(BeamInPlane const& beam, Opening const& a) {
  double const g = 1 / (beam.w * beam.w);
  return std::norm(g / pi * integral({g, -a.x, -a.y, 0}, a, pi / g));
}

double axis_ripple(BeamInPlane const& beam, Opening const& a) {
  constexpr int points = 256;
  double sum = 0;
  for (int j = 0; j < points; ++j) {
    double const angle = 2 * pi * j / points;
    double const x = a.x + inner(a) * std::cos(angle), y = a.y + inner(a) * std::sin(angle);
    sum += std::exp(-(x * x + y * y) / (beam.w * beam.w));
  }
  return 2 * sum / points;
}

}  // namespace straytrace
