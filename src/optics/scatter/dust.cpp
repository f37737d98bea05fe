// SPDX-License-Identifier: BSD-3-Clause
#include "optics/scatter/dust.hpp"

#include <algorithm>
#include <array>

#include "base/memory/storage.hpp"
#include "optics/lobes/lobe_prepare.hpp"
#include "optics/scatter/mie.hpp"

namespace straytrace::optics {
namespace {

constexpr int order = DeflectionTable::order, panels = DeflectionTable::panels;
constexpr std::uint32_t most_cells = 4096;  // of a panel
constexpr std::size_t abreast = 8;

// sum of series[l] cos(l theta) at s = sin^2(theta/2), Clenshaw's recurrence in the differences that stay accurate
// towards theta = 0 (Reinsch).
std::vector<double> sums(std::vector<double> const& series, std::vector<double> const& s) {
  std::vector<double> all(s.size());
  for (std::size_t start = 0; start < s.size(); start += abreast) {
    std::size_t const filled = std::min(abreast, s.size() - start);
    double slope[abreast] = {}, b[abreast] = {}, d[abreast] = {};
    for (std::size_t i = 0; i < filled; ++i) slope[i] = -4 * s[start + i];
    for (std::size_t l = series.size(); l-- > 0;) {
      bool const last = l == 0;
      for (std::size_t i = 0; i < abreast; ++i) {
        d[i] += series[l] + (last ? 0.5 : 1) * slope[i] * b[i];
        b[i] += d[i];
      }
    }
    for (std::size_t i = 0; i < filled; ++i) all[start + i] = d[i];
  }
  return all;
}

// Newton's terms of the polynomial through order + 1 values at 0, 1, ...
void add_terms(double const* values, std::vector<double>& out) {
  double t[order + 1];
  std::copy_n(values, order + 1, t);
  for (int k = 1; k <= order; ++k)
    for (int i = order; i >= k; --i) t[i] = (t[i] - t[i - 1]) / k;
  out.insert(out.end(), t, t + order + 1);
}

double newton(double const* t, double z) {
  double value = t[order];
  for (int k = order - 1; k >= 0; --k) value = t[k] + (z - k) * value;
  return value;
}

// Halves the cells of a panel until their polynomials meet the function between their own points.
std::vector<double> panel_terms(std::vector<double> const& series, int p) {
  auto const at = [&](std::size_t i, std::size_t steps) {
    double const x = (p + double(i) / double(steps)) / panels;
    return x * x / 2;
  };
  std::vector<double> s;
  for (std::size_t i = 0; i <= order; ++i) s.push_back(at(i, order));
  std::vector<double> values = sums(series, s);
  for (std::uint32_t cells = 1;; cells *= 2) {
    std::vector<double> terms;
    for (std::uint32_t c = 0; c < cells; ++c) add_terms(&values[c * order], terms);
    s.clear();
    for (std::size_t i = 0; i < cells * order; ++i) s.push_back(at(2 * i + 1, 2 * cells * order));
    std::vector<double> const between = sums(series, s);
    bool met = true;
    for (std::size_t i = 0; i < between.size() && met; ++i)
      met = std::fabs(newton(&terms[i / order * (order + 1)], double(i % order) + 0.5) - between[i]) <=
            DeflectionTable::tolerance * std::fabs(between[i]);
    if (met || cells == most_cells) return terms;
    std::vector<double> finer;
    for (std::size_t i = 0; i < between.size(); ++i) finer.insert(finer.end(), {values[i], between[i]});
    finer.push_back(values.back());
    values = std::move(finer);
  }
}

// Drops the last terms, which change no value by more than a tenth of the tolerance.
void shorten(std::vector<double>& series) {
  constexpr std::size_t steps = 512;
  std::vector<double> s;
  for (std::size_t i = 0; i <= steps; ++i) s.push_back(double(i) / double(steps));
  std::vector<double> const all = sums(series, s);
  double left = 0.1 * DeflectionTable::tolerance * *std::ranges::min_element(all);
  while (series.size() > 1 && (left -= std::fabs(series.back())) > 0) series.pop_back();
}

}  // namespace

DeflectionTable make_deflection_table(std::vector<double> series, Storage& storage) {
  std::vector<DeflectionTable::Panel> panel;
  std::vector<double> term;
  shorten(series);
  for (bool const behind : {false, true}) {
    if (behind)  // of 180 deg - Theta
      for (std::size_t l = 1; l < series.size(); l += 2) series[l] = -series[l];
    for (int p = 0; p < panels; ++p) {
      std::vector<double> const terms = panel_terms(series, p);
      panel.push_back({std::uint32_t(term.size() / (order + 1)), std::uint32_t(terms.size() / (order + 1))});
      term.insert(term.end(), terms.begin(), terms.end());
    }
  }
  return {storage.keep(std::move(panel)), storage.keep_large(std::move(term))};
}

namespace {

constexpr double ln10 = 2.302585092994046;
double log10_of(double x) { return log_positive(x) / ln10; }

// Extended beyond the level, where the standard ends.
double number_law(Cleanliness const& c, double diameter) {
  double const micrometres = log10_of(diameter / 1e-6), all = log10_of(c.level);
  return 10 * exp_number(ln10 * (c.slope * (all * all - micrometres * micrometres)));
}

}  // namespace

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

// Total scatter of dust, for every incidence. Paths of eq. 3.23 turn the light by Theta_f from the
// specular or by Theta_b from the incident direction of travel; both axes have the same height. With W(chi), the
// integral of lit cos_s over the azimuth of the cone of half-angle chi about an axis of that height, the albedo is the
// integral of (2 R W(Theta) + (1 + R^2) W(180 deg - Theta)) |S|^2/k^2 over cos Theta.

namespace {

// W for one incidence, against r, the smaller of sin(chi/2) and cos(chi/2). The horizon cuts the cones between r = low
// in front and r = low behind. In front of that W is tabled at even x of r = low sin^2(pi x/2), beyond it in either
// half at even x of r = low cosh(k x): in x it varies evenly at grazing too, and its square roots at low are smooth.
class ConeIntegral {
 public:
  ConeIntegral(Dust const& dust, double cos_i) : cos_i_(cos_i), sin_i_(std::sqrt((1 - cos_i) * (1 + cos_i))) {
    low_ = EvenChordRings::cut(cos_i_, sin_i_) / 2;
    range_ = arcosh(std::sqrt(0.5) / low_);
    for (int i = 0; i <= steps; ++i) {
      double const root = sincos_turn(double(i) / (4 * steps)).sin, grown = exp_number(range_ * i / steps);
      double const r = std::fmin(low_ * 0.5 * (grown + 1 / grown), std::sqrt(0.5));
      inner_[std::size_t(i)] = over_azimuth(dust, low_ * root * root);
      front_[std::size_t(i)] = over_azimuth(dust, r);
      behind_[std::size_t(i)] = over_azimuth(dust, std::sqrt(1 - r * r));
    }
  }
  double at(double s) const {  // sin^2(chi/2)
    bool const behind = s > 0.5;
    double const r = std::sqrt(behind ? 1 - s : s);
    if (r >= low_) return range_ > 0 ? between(behind ? behind_ : front_, arcosh(r / low_) / range_) : 0;
    if (behind) return 0;
    double const sine = std::sqrt(r / low_), cosine = std::sqrt((1 - sine) * (1 + sine));
    return between(inner_, cosine > 0 ? 2 / pi * atan_positive(sine / cosine) : 1);
  }

 private:
  static constexpr int steps = 96;
  using Table = std::array<double, steps + 1>;

  static double arcosh(double x) { return x > 1 ? log_positive(x + std::sqrt((x - 1) * (x + 1))) : 0; }
  static double between(Table const& table, double share) {
    int const i = std::clamp(static_cast<int>(share * steps) - 1, 0, steps - 3);
    double const* const t = &table[std::size_t(i)];
    double const y = share * steps - i, a = y - 1, b = y - 2, c = y - 3;
    return -a * b * c / 6 * t[0] + y * b * c / 2 * t[1] - y * a * c / 2 * t[2] + y * a * b / 6 * t[3];
  }
  double over_azimuth(Dust const& dust, double v) const {  // v = sin(chi/2)
    static GaussPoints const gauss(16);
    Vec3 const wi{sin_i_, 0, cos_i_};
    double const half = EvenChordRings::arc(wi, 4 * v * v).half;
    double const up = cos_i_ * (1 - 2 * v * v), side = 2 * sin_i_ * v * std::sqrt(std::fmax(0, 1 - v * v));
    double sum = 0;
    for (std::size_t j = 0; j < gauss.at.size(); ++j) {
      double const y = gauss.at[j], turn = y * y * (3 - 2 * y), rate = 6 * y * (1 - y);
      double const cos_s = up + side * sincos_turn(0.5 * turn * half / pi).cos;
      if (cos_s > 0) sum += gauss.weight[j] * rate * dust.lit(cos_i_, cos_s) * cos_s;
    }
    return 2 * half * sum;
  }

  double cos_i_, sin_i_, low_ = 0, range_ = 0;  // range_: k
  Table inner_ = {}, front_ = {}, behind_ = {};
};

struct ScatterPoint {
  double s, power;  // sin^2(Theta/2); |S|^2/k^2 times the step of cos Theta
};

// Gauss points in the cells of the table, which is a polynomial in each, and in parts of cells too wide for W at the
// horizon.
std::vector<ScatterPoint> points_of(DeflectionTable const& table) {
  GaussPoints const gauss(4);
  std::vector<ScatterPoint> all;
  for (bool const behind : {false, true})
    for (int p = 0; p < DeflectionTable::panels; ++p) {
      std::uint32_t const cells = table.panel[std::size_t(behind ? DeflectionTable::panels + p : p)].cells;
      std::uint32_t const pieces = std::max(cells, 8u);  // both are powers of two
      for (std::uint32_t piece = 0; piece < pieces; ++piece)
        for (std::size_t i = 0; i < gauss.at.size(); ++i) {
          double const x = (p + (piece + gauss.at[i]) / pieces) / DeflectionTable::panels, near = x * x / 2;
          double const s = behind ? 1 - near : near, slope = 2 * x / DeflectionTable::panels;  // of cos Theta
          all.push_back({s, table.at(s) * gauss.weight[i] / pieces * slope});
        }
    }
  return all;
}

}  // namespace

void Dust::prepare() {
  std::vector<ScatterPoint> const points = points_of(scatter);
  for (int i = 0; i < AlbedoTable::size; ++i) {
    double const cos_i = std::fmax(AlbedoTable::cosine(i), lowest_cosine);
    ConeIntegral const cone(*this, cos_i);
    double back = 0, forward = 0;
    for (ScatterPoint const& p : points) {
      forward += p.power * cone.at(p.s);
      back += p.power * cone.at(1 - p.s);
    }
    lobe.albedo.value[i] = grazed(cos_i) * (2 * reflectance * forward + (1 + reflectance * reflectance) * back);
  }
  lobe.prepare_rings(*this, smallest, 0, GaussPoints(16));  // resolves the glory, which is not centred on a ring
}

}  // namespace straytrace::optics
