// SPDX-License-Identifier: BSD-3-Clause
#include "beams/diffraction.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.hpp"
#include "base/message.hpp"
#include "beams/clipping.hpp"

namespace straytrace {
namespace {

using Complex = std::complex<double>;
constexpr Complex i{0, 1};
using Rule = boost::math::quadrature::gauss<double, 20>;  // on panels of about half a period

// exp(-gamma r^2 + r (bx cos a + by sin a) + constant) in polar coordinates r, a about the centre of the aperture.
struct Integrand {
  Complex gamma, bx, by, constant;
  double size() const { return std::sqrt(std::norm(bx) + std::norm(by)); }
  bool centred() const { return bx.real() == 0 && by.real() == 0; }  // a plane wave on top of a centred Gaussian
};

double inner(Opening const& a) { return std::max(0.0, a.radius - 0.5 * a.tooth_height); }
double outer(Opening const& a) { return a.radius + 0.5 * a.tooth_height; }

// Open share of the circle of radius r.
double open_share(Opening const& a, double r) {
  if (r <= inner(a)) return 1;
  return r >= outer(a) ? 0 : (outer(a) - r) / a.tooth_height;
}

// Terms in azimuth that exp(r b cos a) still holds: J_n(x) falls faster than exponentially beyond n = x.
unsigned orders_of(double x) { return unsigned(x + 5 * std::cbrt(x) + 20); }

// Integral over the azimuth at radius r. The rim enters by its Fourier series: harmonic m of `teeth` equal teeth of
// open share T is 2 sin(pi m T)/(pi m), and those beyond the orders of the exponential integrate to nothing.
Complex around(Integrand const& f, Opening const& a, double r) {
  double const share = open_share(a, r), size = f.size();
  unsigned const orders = orders_of(r * size);
  unsigned const harmonics = a.teeth > 0 && share < 1 ? orders / a.teeth : 0;
  if (f.centred() && harmonics == 0)
    return 2 * pi * share * std::exp(f.constant - f.gamma * r * r) * boost::math::cyl_bessel_j(0, r * size);
  unsigned const points = 2 * orders + 2;
  Complex sum = 0;
  for (unsigned j = 0; j < points; ++j) {
    double const angle = 2 * pi * j / points;
    double open = share;
    for (unsigned m = 1; m <= harmonics; ++m)
      open += 2 * std::sin(pi * m * share) / (pi * m) * std::cos(m * (a.teeth * (angle - a.phase) - pi));
    sum += open * std::exp(f.constant - f.gamma * r * r + r * (f.bx * std::cos(angle) + f.by * std::sin(angle)));
  }
  return 2 * pi / points * sum;
}

Complex integral(Integrand const& f, Opening const& a) {
  constexpr double most_panels = 2e5;
  std::array<double, 3> const edges = {0, inner(a), outer(a)};
  Complex sum = 0;
  for (std::size_t part = 0; part < 2; ++part) {
    double const low = edges[part], high = edges[part + 1];
    if (!(high > low)) continue;
    double const turns = (std::abs(f.gamma) * (high * high - low * low) + f.size() * (high - low)) / pi;
    if (!(turns < most_panels))
      throw NumericalError("the field so close behind an aperture cannot be integrated: go farther away");
    double const panels = std::ceil(turns) + 1, step = (high * high - low * low) / panels;
    for (double p = 0; p < panels; ++p)  // equal steps of r^2: r dr = d(r^2)/2
      sum += Rule::integrate([&](double s) { return 0.5 * around(f, a, std::sqrt(s)); }, low * low + p * step,
                             low * low + (p + 1) * step);
  }
  return sum;
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
  Complex const g = decay(beam), lens = i * k / z;
  Integrand const f{g - 0.5 * lens, -2.0 * g * a.x - lens * dx, -2.0 * g * a.y - lens * dy,
                    -g * (a.x * a.x + a.y * a.y) + 0.5 * lens * (dx * dx + dy * dy)};
  return k / (2 * pi * i * z) * integral(f, a);
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
  Integrand const f{g, -2 * g * a.x, -2 * g * a.y, -g * (a.x * a.x + a.y * a.y)};
  return std::norm(g / pi * integral(f, a));
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
