// SPDX-License-Identifier: BSD-3-Clause
#include "optics/lobes/deflection_table.hpp"

#include <algorithm>

#include "base/memory/storage.hpp"

namespace straytrace {
namespace {

constexpr int order = DeflectionTable::order, panels = DeflectionTable::panels;
constexpr std::uint32_t most_cells = 4096;  // of a panel
constexpr std::size_t abreast = 8;

// sum of series[l] cos(l theta) at s = sin^2(theta/2), Clenshaw's recurrence in the differences that keep their figures
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

// Without the last terms that move no value by more than a tenth of the tolerance.
void shorten(std::vector<double>& series) {
  constexpr std::size_t steps = 512;
  std::vector<double> s;
  for (std::size_t i = 0; i <= steps; ++i) s.push_back(double(i) / double(steps));
  std::vector<double> const all = sums(series, s);
  double left = 0.1 * DeflectionTable::tolerance * *std::min_element(all.begin(), all.end());
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

}  // namespace straytrace
