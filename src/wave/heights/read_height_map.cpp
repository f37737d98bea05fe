// SPDX-License-Identifier: BSD-3-Clause
// Height maps in HDF5 and in texts, and that of a mirror.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/files/text_file.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/units/quantity.hpp"
#include "io/delimited_text.hpp"
#include "io/hdf5/reader.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::wave {
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

}  // namespace

namespace {

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
