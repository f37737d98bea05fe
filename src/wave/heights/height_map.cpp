// SPDX-License-Identifier: BSD-3-Clause
// Low orders, holes and resampling of height maps.
#include "wave/heights/height_map.hpp"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/math/linear_algebra.hpp"
#include "base/units/quantity.hpp"
#include "io/delimited_text.hpp"
#include "io/hdf5/read_write.hpp"
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
  auto const found = solve_regular(matrix, right, 1e-10);
  if (!found)
    throw InputError(fmt::format("the height map has too few points within the beam of {:g} m radius", w),
                     "give a map that covers the beam, with the axis of the cavity at x = y = 0");
  Orders const fit = *found;
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

// Height maps in HDF5 and in texts, and that of a mirror.

namespace {

constexpr std::size_t fewest_points = 8;        // along each side
constexpr std::uint64_t largest_map = 1 << 30;  // bytes of the heights
constexpr char const* text_remedy =
    "write rows below 'x [mm], y [mm], height [nm]', or a matrix below '# pixel: 0.4 mm' and '# unit: nm'";

[[noreturn]] void refuse_map(std::string const& file, std::string what, std::string suggestion,
                             std::uint32_t line = 0) {
  throw errors_in(file, {{{0, line, 0}, std::move(what), std::move(suggestion)}});
}

void check_heights(HeightMap& map, std::string const& file) {
  if (std::min(map.x.size(), map.y.size()) < fewest_points)
    refuse_map(file,
               fmt::format("a height map has {} x {} points or more, this one {} x {}", fewest_points, fewest_points,
                           map.x.size(), map.y.size()),
               "give the whole map");
  for (double& h : map.height)
    if (!std::isfinite(h)) h = not_a_number;
  if (std::ranges::all_of(map.height, [](double h) { return std::isnan(h); }))
    refuse_map(file, "no point of the height map has data", "check the mask of the measurement");
}

// HDF5.

class MapDatasets {
 public:
  MapDatasets(std::string const& bytes, std::string const& file) : file_(file), reader_(opened(bytes, file)) {}

  HeightMap map() const {
    std::string const name = reader_.has("A") ? "A" : "height";
    for (std::string const& needed : {std::string("x"), std::string("y"), name})
      if (!reader_.has(needed) || reader_.is_group(needed))
        refuse_map(file_, fmt::format("it has no dataset '{}'", needed),
                   "a height map has the lists 'x' and 'y' and the heights 'height' or 'A', in m");
    HeightMap map{numbers("x"), numbers("y"), numbers(name)};
    hdf5::Sizes const shape = reader_.shape(name);
    if (shape != hdf5::Sizes{map.y.size(), map.x.size()})
      refuse_map(file_,
                 fmt::format("'{}' has the shape {}, but y and x have {} and {} points", name, text_of(shape),
                             map.y.size(), map.x.size()),
                 "store a row of heights along x for each y");
    if (std::min(map.x.size(), map.y.size()) >= fewest_points) sort(map);
    return map;
  }

 private:
  template <class Action>
  static auto told(std::string const& file, Action const& action) {
    try {
      return action();
    } catch (InputError const& e) {
      refuse_map(file, e.reason(), "copy the file again, or export the map again");
    }
  }
  static hdf5::Reader opened(std::string const& bytes, std::string const& file) {
    return told(file, [&] { return hdf5::Reader(bytes, {.largest = largest_map}); });
  }
  static std::string text_of(hdf5::Sizes const& shape) {
    std::string text;
    for (auto const size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
    return text.empty() ? "of one number" : text;
  }

  // In m.
  std::vector<double> numbers(std::string const& name) const {
    std::string unit = "m";
    for (char const* const attribute : {"unit", "units"})
      if (reader_.has_attribute(name, attribute))
        unit = told(file_, [&] { return reader_.attribute_text(name, attribute); });
    auto const factor = parse_unit(unit);
    if (!factor || factor->dimension != dim::length)
      refuse_map(file_, fmt::format("'{}' is in '{}', which is not a length", name, shortened(unit)),
                 "state m, mm, um or nm");
    hdf5::Sizes const shape = reader_.shape(name);
    std::size_t const columns = shape.size() == 2 ? shape[1] : 1;
    std::vector<double> values = told(file_, [&] { return reader_.array<double>(name, columns); });
    for (double& v : values) v = to_si(v, *factor);
    return values;
  }

  // Both axes ascending.
  void sort(HeightMap& map) const {
    std::size_t const columns = map.x.size();
    if (map.y.front() > map.y.back()) {
      std::ranges::reverse(map.y);
      for (std::size_t row = 0; row < map.y.size() / 2; ++row)
        std::swap_ranges(map.height.begin() + std::ptrdiff_t(row * columns),
                         map.height.begin() + std::ptrdiff_t((row + 1) * columns),
                         map.height.end() - std::ptrdiff_t((row + 1) * columns));
    }
    if (map.x.front() > map.x.back()) {
      std::ranges::reverse(map.x);
      for (auto row = map.height.begin(); row != map.height.end(); row += std::ptrdiff_t(columns))
        std::reverse(row, row + std::ptrdiff_t(columns));
    }
    check_steps(map.x, "x");
    check_steps(map.y, "y");
  }
  void check_steps(std::vector<double> const& place, char const* name) const {
    double const step = (place.back() - place.front()) / double(place.size() - 1);
    for (std::size_t i = 0; i < place.size(); ++i)
      if (!(step > 0 && std::fabs(place[i] - place.front() - double(i) * step) <= 0.01 * step))
        refuse_map(file_, fmt::format("'{}' is not equidistant at its element {}", name, i + 1),
                   "give the heights on a grid of equal steps");
  }

  std::string const& file_;
  hdf5::Reader reader_;
};

// Texts.

std::optional<double> length_unit(std::string_view text) {
  auto const unit = parse_unit(text);
  return unit && unit->dimension == dim::length ? std::optional(unit->si) : std::nullopt;
}

// The places of a coordinate, from the first in equal steps, and the number of the place of each row of the table.
struct MapAxis {
  std::vector<double> places;
  std::vector<std::size_t> of_row;
};

MapAxis axis_of(NumberTable const& table, std::size_t column, std::string const& file) {
  std::vector<double> const& values = table.column[column];
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  double const extent = sorted.back() - sorted.front();
  double step = extent;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (double const gap = sorted[i] - sorted[i - 1]; gap > 1e-6 * extent) step = std::min(step, gap);
  double const count = extent > 0 ? std::round(extent / step) : 0;
  if (!(count + 1 >= double(fewest_points)))
    refuse_map(file, fmt::format("'{}' has fewer than {} places", table.name[column], fewest_points),
               "give the whole map");
  step = extent / count;
  MapAxis axis;
  for (std::size_t i = 0; i < values.size(); ++i) {
    double const place = (values[i] - sorted.front()) / step;
    if (std::fabs(place - std::round(place)) > 0.1)
      refuse_map(file, fmt::format("'{}' is not on a grid of equal steps", table.name[column]),
                 "give the heights on a grid, with enough digits of x and y", table.line[i]);
    axis.of_row.push_back(std::size_t(std::round(place)));
  }
  if (count > 10 * double(values.size()))
    refuse_map(file, fmt::format("'{}' has far more places than the table has rows", table.name[column]),
               "give the heights on a grid of equal steps");
  for (std::size_t i = 0; i <= std::size_t(count); ++i) axis.places.push_back(sorted.front() + double(i) * step);
  return axis;
}

HeightMap map_of_list(NumberTable const& table, std::string const& file) {
  std::array<double, 3> to_si{};
  for (std::size_t i = 0; i < 3; ++i) {
    auto const unit = length_unit(table.unit[i]);
    if (!unit) refuse_map(file, fmt::format("column '{}' is a length and needs its unit", table.name[i]), text_remedy);
    to_si[i] = *unit;
  }
  for (std::size_t i = 0; i < table.rows(); ++i)
    if (!std::isfinite(table.column[0][i]) || !std::isfinite(table.column[1][i]))
      refuse_map(file, "the place of a height is not a number", "leave out points without data", table.line[i]);
  MapAxis const x = axis_of(table, 0, file), y = axis_of(table, 1, file);
  std::size_t const columns = x.places.size(), points = columns * y.places.size();
  if (points > 16 * table.rows())
    refuse_map(file, fmt::format("its rows fill {} of {} x {} points", table.rows(), columns, y.places.size()),
               "give the heights on a grid of equal steps, with enough digits of x and y");
  HeightMap map{x.places, y.places, std::vector<double>(points, not_a_number)};
  std::vector<bool> taken(points);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    std::size_t const at = y.of_row[i] * columns + x.of_row[i];
    if (taken[at]) refuse_map(file, "this point has a height already", "keep one of the two rows", table.line[i]);
    taken[at] = true;
    map.height[at] = to_si[2] * table.column[2][i];
  }
  for (double& v : map.x) v *= to_si[0];
  for (double& v : map.y) v *= to_si[1];
  return map;
}

// The text behind "# KEY:" in front of the numbers.
std::string_view declared(std::string_view text, std::string_view key) {
  for (TextLine const& line : text_lines(text, Comments::kept)) {
    std::string_view const content = without_blanks(line.text);
    if (!content.starts_with('#')) break;
    std::string_view const rest = without_blanks(content.substr(1));
    if (rest.starts_with(key) && rest.substr(key.size()).starts_with(':'))
      return without_blanks(rest.substr(key.size() + 1));
  }
  return {};
}

HeightMap map_of_matrix(NumberTable const& table, std::string_view text, std::string const& file) {
  std::string_view const pixel = declared(text, "pixel"), unit = declared(text, "unit");
  std::size_t const blank = std::min(pixel.find(' '), pixel.size());
  auto const number = number_in(pixel.substr(0, blank));
  auto const of_pixel = length_unit(without_blanks(pixel.substr(blank))), of_height = length_unit(unit);
  if (!number || !of_pixel || !(*number > 0))
    refuse_map(file,
               pixel.empty() ? "the matrix of heights does not state its pixel"
                             : fmt::format("the pixel '{}' is not a length", shortened(pixel)),
               text_remedy);
  if (!of_height)
    refuse_map(file,
               unit.empty() ? "the matrix of heights does not state its unit"
                            : fmt::format("the unit '{}' is not a length", shortened(unit)),
               text_remedy);
  std::size_t const columns = table.column.size(), rows = table.rows();
  HeightMap map{{}, {}, std::vector<double>(columns * rows)};
  double const step = *number * *of_pixel;
  for (std::size_t i = 0; i < columns; ++i) map.x.push_back((double(i) - double(columns - 1) / 2) * step);
  for (std::size_t i = 0; i < rows; ++i) map.y.push_back((double(i) - double(rows - 1) / 2) * step);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t i = 0; i < columns; ++i)
      map.height[(rows - 1 - row) * columns + i] = *of_height * table.column[i][row];
  return map;
}

HeightMap map_of_text(std::string const& text, std::string const& file) {
  refuse_binary(text, file);
  NumberTable table = parse_numbers(text, NonFinite::kept, HeaderRow::allowed);
  if (!table.problems.empty()) {
    for (Problem& p : table.problems) p.suggestion = text_remedy;
    throw errors_in(file, table.problems);
  }
  bool const list = table.name == std::vector<std::string>{"x", "y", "height"};
  return list ? map_of_list(table, file) : map_of_matrix(table, text, file);
}

// Weighted by the beam. m
double rms_in_beam(HeightMap const& map, LightOnMirror const& light) {
  auto const [rx, ry] = light.on_mirror();
  double squares = 0, weights = 0;
  for (std::size_t i = 0; i < map.height.size(); ++i) {
    if (!std::isfinite(map.height[i])) continue;
    double const x = (map.x[i % map.x.size()] - light.centre[0]) / rx,
                 y = (map.y[i / map.x.size()] - light.centre[1]) / ry;
    double const weight = std::exp(-2 * (x * x + y * y));
    squares += weight * map.height[i] * map.height[i];
    weights += weight;
  }
  return std::sqrt(squares / weights);
}

}  // namespace

HeightMap measured_map(WaveSettings::Mirror const& settings, LightOnMirror const& light, double wavelength) {
  HeightMap map = height_map_of(settings.bytes, settings.file);
  auto const [rx, ry] = light.on_mirror();
  double const off = std::hypot(light.centre[0], light.centre[1]), spot = std::max(rx, ry);
  if (MeasuredDisc const disc = measured_disc(map); disc.radius < 2 * spot + off)
    throw InputError(
        fmt::format("the map covers a disc of radius {:.3g} m, less than twice the radius {:.3g} m of the "
                    "mode{}",
                    disc.radius, spot, off > 0 ? fmt::format(", which falls {:.3g} m beside its centre", off) : ""),
        "give a map of the whole mirror, or 'spectrum: material'");
  refuse_large_holes(map);
  auto const& r = settings.removed;
  remove(map, fit_low_orders(map, light), {r.piston, r.tilt, r.curvature, r.astigmatism}, light.centre);
  if (double const size = rms_in_beam(map, light); !(size < wavelength / 4))
    throw InputError(
        fmt::format("the heights are {:.3g} m rms in the beam after the removal of low orders, more than a "
                    "quarter of the wavelength",
                    size),
        "check their unit; see docs/reference/scene.md#wave");
  return map;
}

HeightMap height_map_of(std::string const& bytes, std::string const& file) {
  HeightMap map = bytes.starts_with("\x89HDF") ? MapDatasets(bytes, file).map() : map_of_text(bytes, file);
  check_heights(map, file);
  return map;
}

}  // namespace straytrace::wave
