// SPDX-License-Identifier: BSD-3-Clause
// Low orders, holes and resampling of height maps.
#include "wave/heights/height_map.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "wave/transform.hpp"

namespace straytrace::wave {
namespace {

using Orders = Eigen::Matrix<double, 6, 1>;

// Surfaces of the six low orders at a point, with the radius of the beam as the unit of length.
Orders order_values(double x, double y) { return Orders{1, x, y, (x * x + y * y) / 2, (x * x - y * y) / 2, x * y}; }

// Of a disc that tapers to zero over the outer 5 % of its radius.
double taper(double share) {
  constexpr double width = 0.05;
  if (share <= 1 - width) return 1;
  return share >= 1 ? 0 : 0.5 + 0.5 * std::cos(pi * (share - 1 + width) / width);
}

// Points of a map inside a disc, for work(index into the heights, x, y).
template <class Work>
void for_points_in(HeightMap const& map, MeasuredDisc const& disc, Work const& work) {
  for (std::size_t row = 0; row < map.y.size(); ++row)
    for (std::size_t column = 0; column < map.x.size(); ++column)
      if (std::hypot(map.x[column] - disc.x, map.y[row] - disc.y) <= disc.radius * (1 + 1e-9))
        work(row * map.x.size() + column, map.x[column], map.y[row]);
}

// A plane with a map in its corner and free values around it and in its holes.
class Continuation {
 public:
  explicit Continuation(HeightMap const& map)
      : map_(map), plane_(room_for(map)), transform_(plane_.grid.points, 0), known_(plane_.values.size()) {
    double sum = 0, count = 0;
    for (double h : map.height)
      if (std::isfinite(h)) sum += h, ++count;
    std::ranges::fill(plane_.values, sum / count);
    for (std::size_t i = 0; i < map.height.size(); ++i)
      if (std::isfinite(map.height[i])) known_[place(i)] = true, plane_.values[place(i)] = map.height[i];
  }

  // Gives the free values the content of the plane below a frequency, which doubles: broad features come first.
  void run() {
    constexpr int repeats = 8;
    for (int band = 2; band <= plane_.grid.points / 4; band *= 2)
      for (int i = 0; i < repeats; ++i) improve(band);
  }
  double at(std::size_t i) const { return plane_.values[place(i)].real(); }

 private:
  static Grid room_for(HeightMap const& map) {
    int const needed = int(std::max(map.x.size(), map.y.size()));
    return {(needed + needed / 4 + 31) / 32 * 32, 1};
  }
  std::size_t place(std::size_t i) const {
    return i / map_.x.size() * std::size_t(plane_.grid.points) + i % map_.x.size();
  }

  void improve(int band) {
    int const n = plane_.grid.points;
    Field smooth = plane_;
    transform_.forward(smooth, n, 2 * band + 2);
    for_rows(0, n, 0, [&](int row) {
      for (int column = 0; column < n; ++column)
        if (std::hypot(plane_.grid.frequency(row), plane_.grid.frequency(column)) > band) smooth(row, column) = 0;
    });
    transform_.inverse(smooth, 2 * band + 2, n);
    for (std::size_t i = 0; i < known_.size(); ++i)
      if (!known_[i]) plane_.values[i] = smooth.values[i].real();
  }

  HeightMap const& map_;
  Field plane_;
  Transform transform_;
  std::vector<bool> known_;
};

struct Holes {
  std::vector<std::size_t> places;  // indices into the heights
  double share = 1;                 // of the points of the measured disc
};
Holes holes_of(HeightMap const& map) {
  Holes holes;
  std::size_t inside = 0;
  for_points_in(map, measured_disc(map), [&](std::size_t i, double, double) {
    ++inside;
    if (!std::isfinite(map.height[i])) holes.places.push_back(i);
  });
  if (inside > 0) holes.share = double(holes.places.size()) / double(inside);
  return holes;
}

// exp(-2 pi i n x/window), a row for each n from `first` to `last`.
Eigen::MatrixXcd waves_along(std::vector<double> const& x, double window, int first, int last) {
  Eigen::MatrixXcd out(last - first + 1, Eigen::Index(x.size()));
  for (std::size_t j = 0; j < x.size(); ++j)
    for (int n = first; n <= last; ++n) out(n - first, Eigen::Index(j)) = turned(-n * (x[j] / window));
  return out;
}

using Heights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Heights tapered(HeightMap const& map, MeasuredDisc const& disc) {
  Heights out = Heights::Zero(Eigen::Index(map.y.size()), Eigen::Index(map.x.size()));
  for_points_in(map, disc, [&](std::size_t i, double x, double y) {
    double const factor = taper(std::hypot(x - disc.x, y - disc.y) / disc.radius);
    if (factor > 0) out.data()[i] = factor * map.height[i];
  });
  return out;
}

}  // namespace

double HeightMap::nyquist(double cosine) const { return 0.5 / std::max(cosine * pitch_x(), pitch_y()); }

MeasuredDisc measured_disc(HeightMap const& map) {
  std::array<double, 2> low{infinity, infinity}, high{-infinity, -infinity};
  for (std::size_t i = 0; i < map.height.size(); ++i)
    if (std::isfinite(map.height[i])) {
      double const place[2] = {map.x[i % map.x.size()], map.y[i / map.x.size()]};
      for (int k : {0, 1}) low[k] = std::min(low[k], place[k]), high[k] = std::max(high[k], place[k]);
    }
  return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, std::min(high[0] - low[0], high[1] - low[1]) / 2};
}

LowOrders fit_low_orders(HeightMap const& map, LightOnMirror const& light) {
  auto const [rx, ry] = light.on_mirror();
  double const w = std::sqrt(rx * ry);
  Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Orders right = Orders::Zero();
  for (std::size_t i = 0; i < map.height.size(); ++i) {
    if (!std::isfinite(map.height[i])) continue;
    double const x = map.x[i % map.x.size()] - light.centre[0], y = map.y[i / map.x.size()] - light.centre[1];
    double const u = x / rx, v = y / ry;
    Orders const values = order_values(x / w, y / w), weighted = std::exp(-2 * (u * u + v * v)) * values;
    matrix += weighted * values.transpose();
    right += map.height[i] * weighted;
  }
  Eigen::FullPivLU<Eigen::Matrix<double, 6, 6>> solver(matrix);
  solver.setThreshold(1e-10);
  if (!solver.isInvertible())
    throw InputError(fmt::format("the height map has too few points within the beam of {:g} m radius", w),
                     "give a map that covers the beam, with the axis of the cavity at x = y = 0");
  Orders const fit = solver.solve(right);
  return {fit[0], fit[1] / w, fit[2] / w, fit[3] / (w * w), fit[4] / (w * w), fit[5] / (w * w)};
}

void remove(HeightMap& map, LowOrders const& orders, RemovedOrders const& removed, std::array<double, 2> centre) {
  Orders amount{orders.piston,    orders.tilt_x,       orders.tilt_y,
                orders.curvature, orders.astigmatism0, orders.astigmatism45};
  if (!removed.piston) amount[0] = 0;
  if (!removed.tilt) amount[1] = amount[2] = 0;
  if (!removed.curvature) amount[3] = 0;
  if (!removed.astigmatism) amount[4] = amount[5] = 0;
  for (std::size_t i = 0; i < map.height.size(); ++i)
    map.height[i] -= amount.dot(order_values(map.x[i % map.x.size()] - centre[0], map.y[i / map.x.size()] - centre[1]));
}

void refuse_large_holes(HeightMap const& map) {
  constexpr double most = 0.1;
  Holes const holes = holes_of(map);
  if (holes.share > most)
    throw InputError(fmt::format("{:.0f} % of the points of the height map, in a disc of {:.4g} m radius, have no data",
                                 100 * holes.share, measured_disc(map).radius),
                     "give a map with data in 90 % of its disc, or cut stray points off its edge");
}

double fill_holes(HeightMap& map) {
  Holes const holes = holes_of(map);
  if (holes.places.empty()) return 0;
  Continuation continued(map);
  continued.run();
  for (std::size_t i : holes.places) map.height[i] = continued.at(i);
  return holes.share;
}

std::vector<double> resample(HeightMap const& map, Grid const& grid, double largest_frequency,
                             LightOnMirror const& light) {
  MeasuredDisc disc = measured_disc(map);
  disc.radius = std::min(disc.radius, grid.window / 2);
  double const highest = std::min(largest_frequency, map.nyquist(light.cosine));
  int const most = std::min(grid.points / 2 - 1, int(periods_across(highest, grid)));
  Heights const heights = tapered(map, disc);
  std::vector<double> x = map.x, y = map.y;  // across the light
  for (double& place : x) place = light.cosine * (place - light.centre[0]);
  for (double& place : y) place -= light.centre[1];
  Eigen::MatrixXcd const along_x = waves_along(x, grid.window, 0, most);
  Eigen::MatrixXcd along = Eigen::MatrixXcd(heights.rows(), most + 1);
  along.real() = heights * along_x.real().transpose();
  along.imag() = heights * along_x.imag().transpose();
  Eigen::MatrixXcd const spectrum = waves_along(y, grid.window, -most, most) * along;

  Field field(grid);
  // The inverse transform divides by the number of points; signs put the axis into the middle of the grid.
  double const scale = double(grid.size()) * light.cosine * map.pitch_x() * map.pitch_y() / (grid.window * grid.window);
  for (int m = 0; m <= most; ++m)
    for (int n = -most; n <= most; ++n) {
      if (std::hypot(n, m) > periods_across(highest, grid)) continue;
      Complex const value = ((n + m) % 2 == 0 ? scale : -scale) * spectrum(n + most, m);
      field((n + grid.points) % grid.points, m) = value;
      if (m > 0) field((grid.points - n) % grid.points, grid.points - m) = std::conj(value);
    }
  Transform(grid.points, 0).inverse(field, 2 * most + 2, grid.points);
  std::vector<double> out;
  out.reserve(grid.size());
  for (Complex const v : field.values) out.push_back(v.real());
  return out;
}

void shift(std::vector<double>& heights, Grid const& grid, std::array<double, 2> distance) {
  if (heights.empty() || (distance[0] == 0 && distance[1] == 0)) return;
  Field field(grid);
  std::ranges::copy(heights, field.values.begin());
  Transform const transform(grid.points, 0);
  transform.forward(field, grid.points, grid.points);
  for (int row = 0; row < grid.points; ++row)
    for (int column = 0; column < grid.points; ++column)
      field(row, column) *= turned(-(grid.frequency(column) * distance[0] + grid.frequency(row) * distance[1]));
  transform.inverse(field, grid.points, grid.points);
  std::ranges::transform(field.values, heights.begin(), [](Complex z) { return z.real(); });
}

}  // namespace straytrace::wave
