// SPDX-License-Identifier: BSD-3-Clause
#include "spectra/spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::spectra {
namespace {

// Integral of f^n from a to b, divided by a^n: exact for every n, smooth through n = -1.
double power_law_integral(double a, double b, double n) {
  double const span = std::log(b / a), x = (n + 1) * span;
  return a * span * (std::fabs(x) < 1e-8 ? 1 + x / 2 : std::expm1(x) / x);
}

std::size_t interval_of(std::vector<double> const& knots, double hz) {
  auto const after = std::ranges::upper_bound(knots, hz) - knots.begin();
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - 1, 0, std::ssize(knots) - 2));
}

}  // namespace

Spectrum::Spectrum(std::vector<double> hz, std::vector<double> psd) {
  if (hz.size() < 2) return;
  Table t{std::move(hz), std::move(psd), {}};
  t.slope.resize(t.hz.size() - 1);
  for (std::size_t i = 0; i < t.slope.size(); ++i) {
    bool const positive = t.psd[i] > 0 && t.psd[i + 1] > 0;
    t.slope[i] = positive ? std::log(t.psd[i + 1] / t.psd[i]) / std::log(t.hz[i + 1] / t.hz[i]) : not_a_number;
  }
  tables_.push_back(std::move(t));
}

double Spectrum::at(Table const& t, double hz) {
  if (!(hz >= t.hz.front() && hz <= t.hz.back())) return 0;
  std::size_t const i = interval_of(t.hz, hz);
  if (!std::isnan(t.slope[i])) return t.psd[i] * std::pow(hz / t.hz[i], t.slope[i]);
  return t.psd[i] + (t.psd[i + 1] - t.psd[i]) * (hz - t.hz[i]) / (t.hz[i + 1] - t.hz[i]);
}

double Spectrum::moment(Table const& t, double low, double high, int order) {
  low = std::max(low, t.hz.front());
  high = std::min(high, t.hz.back());
  double sum = 0;
  if (!(low < high)) return sum;
  for (std::size_t i = interval_of(t.hz, low); i < t.slope.size() && t.hz[i] < high; ++i) {
    double const a = std::max(low, t.hz[i]), b = std::min(high, t.hz[i + 1]);
    if (!(a < b)) continue;
    double const n = t.slope[i];
    if (!std::isnan(n)) {
      double const s = t.psd[i] * std::pow(a / t.hz[i], n) * std::pow(a, order);
      sum += s * power_law_integral(a, b, n + order);
      continue;
    }
    auto const value = [&](double f) {
      return std::pow(f, order) * (t.psd[i] + (t.psd[i + 1] - t.psd[i]) * (f - t.hz[i]) / (t.hz[i + 1] - t.hz[i]));
    };
    sum += (b - a) / 6 * (value(a) + 4 * value((a + b) / 2) + value(b));  // Simpson: exact up to cubic, order <= 2
  }
  return sum;
}

double Spectrum::at(double hz) const {
  double sum = 0;
  for (Table const& t : tables_) sum += at(t, hz);
  return sum;
}

double Spectrum::power(double low, double high) const {
  double sum = 0;
  for (Table const& t : tables_) sum += moment(t, low, high, 0);
  return sum;
}

double Spectrum::total() const { return power(0, infinity); }

double Spectrum::lowest() const {
  double f = tables_.empty() ? 0 : infinity;
  for (Table const& t : tables_) f = std::min(f, t.hz.front());
  return f;
}

double Spectrum::highest() const {
  double f = 0;
  for (Table const& t : tables_) f = std::max(f, t.hz.back());
  return f;
}

double Spectrum::rate_power(double high) const {
  double sum = 0;
  for (Table const& t : tables_) sum += moment(t, 0, high, 2);
  return 4 * pi * pi * sum;
}

Spectrum Spectrum::scaled(double factor) const {
  Spectrum s = *this;
  for (Table& t : s.tables_)
    for (double& p : t.psd) p *= factor;
  return s;
}

Spectrum Spectrum::multiplied(std::function<double(double)> const& factor, std::span<double const> extra) const {
  Spectrum product;
  for (Table const& t : tables_) {
    std::vector<double> hz = t.hz;
    for (double f : extra)
      if (f > t.hz.front() && f < t.hz.back()) hz.push_back(f);
    std::ranges::sort(hz);
    hz.erase(std::unique(hz.begin(), hz.end()), hz.end());
    std::vector<double> psd;
    for (double f : hz) psd.push_back(at(t, f) * factor(f));
    product = product + Spectrum(std::move(hz), std::move(psd));
  }
  return product;
}

std::vector<double> Spectrum::hz() const {
  std::vector<double> knots;
  for (Table const& t : tables_) knots.insert(knots.end(), t.hz.begin(), t.hz.end());
  std::ranges::sort(knots);
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  return knots;
}

std::vector<double> Spectrum::psd() const {
  std::vector<double> values = hz();
  for (double& v : values) v = at(v);
  return values;
}

Spectrum operator+(Spectrum const& a, Spectrum const& b) {
  Spectrum sum = a;
  sum.tables_.insert(sum.tables_.end(), b.tables_.begin(), b.tables_.end());
  return sum;
}

bool same_shape(Spectrum const& a, Spectrum const& b) {
  constexpr double tolerance = 1e-6;
  auto const near = [](double x, double y) { return std::fabs(x - y) <= tolerance * std::max(x, y); };
  if (!near(a.lowest(), b.lowest()) || !near(a.highest(), b.highest())) return false;
  double const ratio = a.total() / b.total();
  auto const agree = [&](std::vector<double> const& knots) {  // ends apart: they may differ in the last digit
    for (std::size_t i = 1; i + 1 < knots.size(); ++i)
      if (!near(a.at(knots[i]), ratio * b.at(knots[i]))) return false;
    return true;
  };
  double const middle = std::sqrt(a.lowest() * a.highest());
  return near(a.at(middle), ratio * b.at(middle)) && agree(a.hz()) && agree(b.hz());
}

}  // namespace straytrace::spectra
