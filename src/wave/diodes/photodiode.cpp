// SPDX-License-Identifier: BSD-3-Clause
#include "wave/diodes/photodiode.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"
#include "base/math/gauss_points.hpp"
#include "wave/sampler.hpp"

namespace straytrace::wave {
namespace {

// Of Gauss and Legendre for an integrand without structure below `finest`: a wave of 2 pi/finest over a length takes
// half its phase and some more.
GaussPoints gauss_over(double length, double finest) {
  return GaussPoints(std::clamp(int(std::ceil(pi * length / finest / 2)) + 4, 4, 400));
}

}  // namespace

double Photodiode::area() const {
  switch (shape) {
    case DiodeShape::square:
      return size * size;
    case DiodeShape::round:
      return pi * size * size / 4;
    case DiodeShape::sector:
      return width * radius * size;
  }
  return 0;
}

double Photodiode::farthest() const {
  double const half = size / 2;
  double const own = shape == DiodeShape::square ? std::hypot(radius + half, half) : radius + half;
  return own + std::hypot(x, y);
}

std::vector<DiodePoint> points_of(Photodiode const& d, double finest) {
  std::vector<DiodePoint> points;
  double const cosine = std::cos(d.azimuth), sine = std::sin(d.azimuth);
  auto const add = [&](double along, double across, double weight) {  // along the radius, from the centre of the ring
    points.push_back({d.x + along * cosine - across * sine, d.y + along * sine + across * cosine, weight});
  };
  GaussPoints const radial = gauss_over(d.size, finest);
  std::size_t const n = radial.at.size();
  if (d.shape == DiodeShape::square)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        add(d.radius + d.size * (radial.at[i] - 0.5), d.size * (radial.at[j] - 0.5),
            d.size * d.size * radial.weight[i] * radial.weight[j]);
  if (d.shape == DiodeShape::round) {
    std::size_t const turns = 2 * n;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < turns; ++j) {
        double const r = d.size / 2 * radial.at[i], turn = 2 * pi * (double(j) + 0.5) / double(turns);
        add(d.radius + r * std::cos(turn), r * std::sin(turn),
            d.size / 2 * radial.weight[i] * r * 2 * pi / double(turns));
      }
  }
  if (d.shape == DiodeShape::sector) {
    GaussPoints const around = gauss_over((d.radius + d.size / 2) * d.width, finest);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < around.at.size(); ++j) {
        double const r = d.radius + d.size * (radial.at[i] - 0.5), turn = d.width * (around.at[j] - 0.5);
        add(r * std::cos(turn), r * std::sin(turn), d.size * radial.weight[i] * r * d.width * around.weight[j]);
      }
  }
  return points;
}

double DiodeLight::power() const {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) sum += points[i].weight * std::norm(field[i]);
  return sum;
}

// |psi|^2 holds twice the frequencies of psi, whose largest is 0.7 of Nyquist's.
DiodeMeter::DiodeMeter(CavityWaves const& waves, std::vector<Photodiode> const& diodes, double finest)
    : diodes_(diodes) {
  double const of_grid = waves.cavity().grid.pitch() / 0.7;
  for (Photodiode const& d : diodes) light_.push_back({points_of(d, std::fmax(finest, of_grid)), {}});
}

void DiodeMeter::operator()(Arrival const& arrival) {
  auto const meets = [&](Photodiode const& d) { return d.plane == arrival.plane && d.travel == arrival.travel; };
  if (std::ranges::none_of(diodes_, meets)) return;
  Sampler const field(arrival.field);
  for (std::size_t i = 0; i < diodes_.size(); ++i) {
    if (!meets(diodes_[i])) continue;
    light_[i].field.clear();
    for (DiodePoint const& p : light_[i].points) light_[i].field.push_back(field.at(p.x, p.y).value);
  }
}

}  // namespace straytrace::wave
