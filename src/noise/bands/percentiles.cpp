// SPDX-License-Identifier: BSD-3-Clause
#include "noise/bands/percentiles.hpp"

#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace {
namespace {

// Root of x^(d+1) = x + 1: the steps 1/x, 1/x^2, ... of a set that fills the unit cube of d dimensions evenly.
double golden(int dimensions) {
  double x = 2;
  for (int i = 0; i < 60; ++i) x = std::pow(1 + x, 1.0 / (dimensions + 1));
  return x;
}

// Two dimensions first: a single speckle needs them alone, and few dimensions are filled better.
double step(int dimension) {
  return dimension < 2 ? std::pow(golden(2), -(dimension + 1)) : std::pow(golden(Draws::most - 2), -(dimension - 1));
}

}  // namespace

Draws::Draws() {
  for (int d = 0; d < most; ++d) {
    normal_.emplace_back(count);
    squared_.emplace_back(count);
    turn_.emplace_back(count);
    double const by = step(d);
    for (int i = 0; i < count; ++i) {
      double const u = std::fmod(0.5 + (i + 1) * by, 1.0);
      turn_[d][i] = u;
      normal_[d][i] = std::sqrt(2.0) * boost::math::erf_inv(2 * std::clamp(u, 1e-9, 1 - 1e-9) - 1);
      squared_[d][i] = normal_[d][i] * normal_[d][i];
    }
  }
}

std::array<double, 3> Draws::read_off(std::vector<double>& values) const {
  std::array<double, 3> out{};
  constexpr double below[] = {0.05, 0.5, 0.95};
  auto from = values.begin();
  for (int k = 0; k < 3; ++k) {
    auto const at = values.begin() + std::ptrdiff_t(below[k] * count);
    std::nth_element(from, at, values.end());
    out[k] = *at;
    from = at;
  }
  return out;
}

std::array<double, 3> Draws::percentiles(std::vector<double> weights, int copies) const {
  std::sort(weights.begin(), weights.end(), std::greater<>());
  double constant = 0;
  std::vector<double> used;
  for (std::size_t m = 0; m < weights.size(); ++m) {
    bool const counts = weights[m] > 1e-4 * weights.front() && used.size() + copies <= std::size_t(most);
    if (!counts) constant += copies * weights[m];
    for (int c = 0; c < copies && counts; ++c) used.push_back(weights[m]);
  }
  std::vector<double> values(count, constant);
  for (std::size_t d = 0; d < used.size(); ++d)
    for (int i = 0; i < count; ++i) values[i] += used[d] * squared_[d][i];
  return read_off(values);
}

std::array<double, 3> Draws::percentiles(RandomVector const& v, int copies) const {
  std::size_t const size = !v.gaussian.empty() ? v.gaussian.front().size() : v.phasors.front().first.size();
  std::vector<double> values(count);
  int direction = 0;
  auto const next = [&] { return direction++ % most; };
  for (int c = 0; c < copies; ++c) {
    std::vector<std::vector<double>> sum(size, std::vector<double>(count));
    for (auto const& [first, second] : v.phasors) {
      int const d = next();
      for (int i = 0; i < count; ++i) {
        double const cosine = std::cos(2 * pi * turn_[d][i]), sine = std::sin(2 * pi * turn_[d][i]);
        for (std::size_t k = 0; k < size; ++k) sum[k][i] += first[k] * cosine + second[k] * sine;
      }
    }
    for (std::vector<double> const& column : v.gaussian) {
      int const d = next();
      for (std::size_t k = 0; k < size; ++k)
        for (int i = 0; i < count && column[k] != 0; ++i) sum[k][i] += column[k] * normal_[d][i];
    }
    for (std::vector<double> const& row : sum)
      for (int i = 0; i < count; ++i) values[i] += row[i] * row[i];
  }
  return read_off(values);
}

}  // namespace straytrace
