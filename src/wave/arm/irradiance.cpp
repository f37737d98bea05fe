// SPDX-License-Identifier: BSD-3-Clause
#include "wave/arm/irradiance.hpp"

#include <algorithm>
#include <cmath>

#include "base/math/constants.hpp"

namespace straytrace::wave {
namespace {

constexpr int sectors = 32;

}  // namespace

double PolarIrradiance::azimuth(int sector) const { return (sector + 0.5) * 2 * pi / sectors; }

double PolarIrradiance::cell_area(int ring) const { return 2 * pi * radius(ring) * step / sectors; }

double PolarIrradiance::ring_mean(double radius) const {
  int const ring = int(radius / step);
  if (!(radius >= 0) || ring >= rings) return 0;
  double sum = 0;
  for (int s = 0; s < sectors; ++s) sum += double(mean[std::size_t(ring * sectors + s)]);
  return sum / sectors;
}

double PolarIrradiance::power(double from, double to) const {
  double sum = 0;
  for (int ring = 0; ring < rings; ++ring) {
    double const low = std::fmax(from, ring * step), high = std::fmin(to, (ring + 1) * step);
    if (!(high > low)) continue;
    sum += pi * (high * high - low * low) * ring_mean(radius(ring));
  }
  return sum;
}

std::vector<double> PolarIrradiance::beyond(RoundHole const& hole) const {
  std::vector<double> shares;
  for (int s = 0; s < sectors; ++s) {
    double const x = std::cos(azimuth(s)), y = std::sin(azimuth(s));
    double const across = hole.x * y - hole.y * x;
    double const edge = hole.x * x + hole.y * y + std::sqrt(std::fmax(0, hole.radius * hole.radius - across * across));
    double sum = 0;
    for (int ring = 0; ring < rings; ++ring) {
      double const low = std::fmax(edge, ring * step), high = (ring + 1) * step;
      if (high > low) sum += pi * (high * high - low * low) / sectors * double(mean[std::size_t(ring * sectors + s)]);
    }
    shares.push_back(sum);
  }
  return shares;
}

PolarIrradiance const& PlaneIrradiance::of(int plane, Travel travel) const {
  return (travel == Travel::towards_mirror2 ? towards_mirror2 : towards_mirror1)[std::size_t(plane)];
}

IrradianceMeter::IrradianceMeter(Grid const& grid, std::size_t planes)
    : step_(grid.pitch()), rings_(grid.points / 2), cell_(grid.size(), -1), points_(std::size_t(rings_ * sectors)) {
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column) {
      double const x = grid.at(column), y = grid.at(row);
      int const ring = int(std::hypot(x, y) / step_);
      if (ring >= rings_) continue;
      double const turn = std::atan2(y, x) / (2 * pi);
      int const sector = std::min(sectors - 1, int((turn < 0 ? turn + 1 : turn) * sectors));
      std::int32_t const cell = ring * sectors + sector;
      cell_[std::size_t(row) * std::size_t(grid.points) + std::size_t(column)] = cell;
      ++points_[std::size_t(cell)];
    }
  result_.towards_mirror2.resize(planes);
  result_.towards_mirror1.resize(planes);
}

void IrradianceMeter::operator()(Arrival const& arrival) {
  std::size_t const cells = points_.size();
  std::vector<double> mean(cells), square(cells);
  for (std::size_t i = 0; i < cell_.size(); ++i) {
    if (cell_[i] < 0) continue;
    double const irradiance = std::norm(arrival.field.values[i]);
    mean[std::size_t(cell_[i])] += irradiance;
    square[std::size_t(cell_[i])] += irradiance * irradiance;
  }
  auto& side = arrival.travel == Travel::towards_mirror2 ? result_.towards_mirror2 : result_.towards_mirror1;
  PolarIrradiance& out = side[std::size_t(arrival.plane)];
  if (out.mean.empty()) out = {step_, rings_, sectors, std::vector<float>(cells), std::vector<float>(cells)};
  if (arrival.plane == 0) ++round_trips_;
  for (int ring = 0; ring < rings_; ++ring) {
    std::size_t const first = std::size_t(ring * sectors), last = first + sectors;
    bool const sparse = std::any_of(points_.begin() + std::ptrdiff_t(first), points_.begin() + std::ptrdiff_t(last),
                                    [](std::int32_t n) { return n == 0; });
    double all = 0, all_square = 0, points = 0;
    for (std::size_t i = first; i < last; ++i) {
      all += mean[i];
      all_square += square[i];
      points += points_[i];
    }
    for (std::size_t i = first; i < last; ++i) {
      out.mean[i] += float(sparse ? all / points : mean[i] / points_[i]);
      out.square[i] += float(sparse ? all_square / points : square[i] / points_[i]);
    }
  }
}

PlaneIrradiance IrradianceMeter::result() && {
  for (auto* const side : {&result_.towards_mirror2, &result_.towards_mirror1})
    for (PolarIrradiance& plane : *side)
      for (auto* const values : {&plane.mean, &plane.square})
        for (float& x : *values) x /= float(round_trips_);
  return std::move(result_);
}

}  // namespace straytrace::wave
