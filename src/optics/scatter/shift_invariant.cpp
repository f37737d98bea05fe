// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/shift_invariant.hpp"

#include <cmath>

#include "optics/lobes/lobe_prepare.hpp"
#include "optics/scatter/model_keys.hpp"

namespace straytrace::optics {

ModelKeys<Abg> Abg::keys() {
  static constexpr ModelKey<Abg> numbers[] = {
      {"a", &Abg::a, dim::brdf, required, 0, 1e6, "A"},
      {"b", &Abg::b, dim::plain, required, 1e-12, 1e6, "B, above 0; the knee is at B^(1/g)"},
      {"g", &Abg::g, dim::plain, required, 0, 8, "slope, 0 to 8"},
  };
  return {numbers};
}

void Abg::prepare() { lobe.prepare(*this, b > 0 ? power_positive(b, 1 / std::fmax(g, 0.1)) : 1e-6); }

ModelKeys<Gaussian> Gaussian::keys() {
  static constexpr ModelKey<Gaussian> numbers[] = {
      {"width", &Gaussian::width, dim::plain, required, 1e-7, 10,
       "w, standard deviation along one axis, in direction cosines"},
  };
  auto const of_total = [](Gaussian const& model, double tis) {
    double const square = 2 * model.width * model.width;
    return tis / (-pi * square * std::expm1(-1 / square));
  };
  return {numbers,
          {&Gaussian::peak,
           {"peak", dim::brdf, 0, 1e12, "β₀"},
           {"tis", dim::plain, 0, 1, "instead of 'peak': total at normal incidence", of_total}}};
}

void Gaussian::prepare() { lobe.prepare(*this, width); }

ModelKeys<Harvey> Harvey::keys() {
  static constexpr ModelKey<Harvey> numbers[] = {
      {"l", &Harvey::width, dim::plain, required, 1e-7, 10, "knee, in direction cosines"},
      {"s", &Harvey::slope, dim::plain, required, -8, 0, "slope beyond the knee, −8 to 0"},
      {"l_across", &Harvey::across, dim::plain, optional, 1e-7, 10,
       "second width, across the plane of propagation, within a factor 4 of 'l'"},
  };
  auto const of_total = [](Harvey const& model, double tis) {
    Harvey unit = model;
    unit.b0 = 1;
    return tis / unit.tis();
  };
  return {numbers,
          {&Harvey::b0,
           {"b0", dim::brdf, 0, 1e9, "value in the specular direction"},
           {"tis", dim::plain, 0, 1, "instead of 'b0': total at normal incidence", of_total}}};
}

ModelComplaint Harvey::impossible() const {
  if (across > 0 && (across > 4 * width || across < width / 4))
    return {"", "'l_across' differs from 'l' by more than a factor 4", "use two models, or a factor of 4 at most"};
  return {};
}

void Harvey::prepare() { lobe.prepare(*this, across > 0 ? std::fmin(width, across) : width); }

double Harvey::tis() const {
  double const l2 = width * width;
  if (std::fabs(slope + 2) < 1e-9) return pi * b0 * l2 * std::log1p(1 / l2);
  return 2 * pi * b0 * l2 * std::expm1((slope + 2) / 2 * std::log1p(1 / l2)) / (slope + 2);
}

ModelKeys<PowerLaw> PowerLaw::keys() {
  static constexpr ModelKey<PowerLaw> numbers[] = {
      {"exponent", &PowerLaw::exponent, dim::plain, 2, 0, 8, "n, 0 to 8"},
      {"above", &PowerLaw::above, dim::angle, required, 1e-9, 1.5,
       "minimum scatter angle: light closer to the specular direction belongs to the modes"},
  };
  auto const of_total = [](PowerLaw const& model, double tis) {
    return model.exponent == 2 ? tis * statistical_kappa(model.above) / (2 * pi) : not_a_number;
  };
  return {numbers,
          {&PowerLaw::kappa,
           {"tis", dim::plain, 0, 1,
            "instead of 'kappa', with exponent 2 only: fraction scattered between 'above' and 90 deg at normal "
            "incidence, normalised by eq. 3.19",
            of_total},
           {"kappa", dim::brdf, 0, 1e3, "κ, the BSDF extrapolated to 1 rad"}}};
}

ModelComplaint PowerLaw::impossible() const {
  if (std::isnan(kappa))  // of a total
    return {"", "a total is defined for exponent 2 only (docs/theory/surfaces.md, eq. 3.19)", "give 'kappa'"};
  return {};
}

void PowerLaw::prepare() { lobe.prepare(*this, above, 2 * sincos_turn(above / (4 * pi)).sin * (1 - 1e-12)); }

namespace {

// Ci(t) - gamma - ln(t) as its power series, for t up to pi.
double cosine_integral_series(double t) {
  double term = 1, sum = 0;
  for (int n = 2; n <= 40; n += 2) {
    term *= -t * t / ((n - 1) * n);
    sum += term / n;
  }
  return sum;
}

}  // namespace

double statistical_integral(double a, double b) {
  return std::sin(a) / a - std::sin(b) / b + std::log(b / a) + cosine_integral_series(b) - cosine_integral_series(a);
}

double statistical_kappa(double above) { return 1 / statistical_integral(above, pi / 2); }

}  // namespace straytrace::optics
