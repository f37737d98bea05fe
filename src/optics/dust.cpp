// SPDX-License-Identifier: BSD-3-Clause
#include "optics/dust.hpp"

#include "optics/mie.hpp"

namespace straytrace {

namespace {

constexpr double ln10 = 2.302585092994046;
double log10_of(double x) { return log_positive(x) / ln10; }

// Continued beyond the level, where the standard counts no more.
double number_law(Cleanliness const& c, double diameter) {
  double const micrometres = log10_of(diameter / 1e-6), all = log10_of(c.level);
  return 10 * exp_number(ln10 * (c.slope * (all * all - micrometres * micrometres)));
}

}  // namespace

double Cleanliness::more_than(double diameter) const {
  return diameter >= level * 1e-6 ? 0 : number_law(*this, diameter);
}

std::vector<Grain> grains(Cleanliness const& c, int classes) {
  double const last = c.largest > 0 ? c.largest : c.level * 1e-6;
  std::vector<Grain> all;
  for (int i = 0; i < classes; ++i) {
    auto const size = [&](double x) { return c.smallest * power_positive(last / c.smallest, x / classes); };
    double const number = number_law(c, size(i)) - number_law(c, size(i + 1));
    if (number > 0) all.push_back({size(i + 0.5), number});
  }
  return all;
}

double Cleanliness::covered() const {
  double sum = 0;
  for (Grain const& g : grains(*this, 4000)) sum += g.per_area * pi * g.diameter * g.diameter / 4;
  return sum;
}

double Cleanliness::covered_by_fit() const {
  double const all = log10_of(level);
  return 0.01 * exp_number(ln10 * (-7.245 + 0.926 * all * all));
}

void set_grains(Dust& dust, std::vector<Grain> const& all, double wavelength, double index, double extinction,
                Storage& storage) {
  double const k = 2 * pi / wavelength;
  double forward = 0, width = 0;
  std::vector<SphereNumber> spheres;
  dust.optical_depth = 0;
  for (Grain const& g : all) {
    double const x = pi * g.diameter / wavelength;
    MieSphere const sphere = mie(x, {index, extinction}, {1});
    dust.optical_depth += g.per_area * sphere.q_ext * pi * g.diameter * g.diameter / 4;
    spheres.push_back({x, g.per_area / (k * k)});
    forward += g.per_area * sphere.intensity[0];
    width += g.per_area * sphere.intensity[0] / x;
  }
  dust.scatter = make_deflection_table(mie_series(spheres, {index, extinction}), storage);
  if (forward > 0) dust.smallest = std::fmin(1, width / forward);
}

}  // namespace straytrace
