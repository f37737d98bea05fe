// SPDX-License-Identifier: BSD-3-Clause
// Height maps from HDF5 files and texts, and errors in them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/every_module.hpp"
#include "io/hdf5/read_write.hpp"
#include "support/message_of.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::height_map_files {
namespace {

using test::message_of;
using ::testing::HasSubstr;

std::vector<double> equidistant(int count, double first, double step) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first + i * step);
  return values;
}

// Height 1 nm times column plus 100 nm times row.
double numbered(int row, int column) { return 1e-9 * (column + 100 * row); }

std::vector<double> numbered_heights(int rows, int columns) {
  std::vector<double> values;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) values.push_back(numbered(row, column));
  return values;
}

std::string hdf5_map(std::vector<double> const& x, std::vector<double> const& y, std::vector<double> const& heights,
                     io::hdf5::Sizes const& shape, std::string const& name = "height", std::string const& unit = "m") {
  io::hdf5::Writer writer;
  writer.array("x", x, "m");
  writer.array("y", y, "m");
  writer.array(name, heights, unit, shape);
  return writer.bytes();
}

void expect_numbered(HeightMap const& map, double step) {
  ASSERT_EQ(map.x.size(), 9U);
  ASSERT_EQ(map.y.size(), 8U);
  EXPECT_NEAR(map.pitch_x(), step, 1e-12);
  EXPECT_NEAR(map.pitch_y(), step, 1e-12);
  EXPECT_GT(map.y.back(), map.y.front());
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 9; ++column)
      EXPECT_NEAR(map.height[std::size_t(row * 9 + column)], numbered(row, column), 1e-18);
}

TEST(HeightMapFiles, Hdf5WithBothNamesAndDescendingAxes) {
  auto const x = equidistant(9, -4e-3, 1e-3), y = equidistant(8, -3e-3, 1e-3);
  for (char const* const name : {"A", "height"})
    expect_numbered(height_map_of(hdf5_map(x, y, numbered_heights(8, 9), {8, 9}, name), "m.h5"), 1e-3);
  auto heights = numbered_heights(8, 9);
  std::ranges::reverse(heights);
  auto const falling_x = equidistant(9, 4e-3, -1e-3), falling_y = equidistant(8, 4e-3, -1e-3);
  expect_numbered(height_map_of(hdf5_map(falling_x, falling_y, heights, {8, 9}), "m.h5"), 1e-3);
  for (double& h : heights) h *= 1e9;
  expect_numbered(height_map_of(hdf5_map(falling_x, falling_y, heights, {8, 9}, "height", "nm"), "m.h5"), 1e-3);
}

TEST(HeightMapFiles, TextsOfPointsAndMatrices) {
  std::string list = "x [mm], y [mm], height [nm]\n", matrix = "# pixel: 0.5 mm\n# unit: nm\n";
  for (int row = 7; row >= 0; --row) {
    for (int column = 0; column < 9; ++column) {
      list += std::to_string(0.5 * column) + ", " + std::to_string(0.5 * row) + ", ";
      list += std::to_string(column + 100 * row) + "\n";
      matrix += std::to_string(column + 100 * row) + " ";
    }
    matrix += "\n";
  }
  expect_numbered(height_map_of(list, "m.csv"), 5e-4);
  HeightMap const map = height_map_of(matrix, "m.txt");
  expect_numbered(map, 5e-4);
  EXPECT_NEAR(map.x.front(), -2e-3, 1e-15);
  EXPECT_NEAR(map.y.back(), 1.75e-3, 1e-15);
  // Points without a row, and the word nan, are holes.
  std::string const holes = list.substr(0, list.rfind('\n', list.size() - 2) + 1);
  EXPECT_TRUE(std::isnan(height_map_of(holes, "m.csv").height[8]));
  matrix.replace(matrix.rfind(" 8 "), 3, " nan ");
  EXPECT_TRUE(std::isnan(height_map_of(matrix, "m.txt").height[8]));
}

TEST(BadInput, HeightMapsInHdf5) {
  auto const x = equidistant(9, 0, 1e-3), y = equidistant(8, 0, 1e-3);
  auto const heights = numbered_heights(8, 9);
  auto const refusal = [](std::string const& bytes) { return message_of([&] { height_map_of(bytes, "m.h5"); }); };
  EXPECT_THAT(refusal(hdf5_map(x, y, heights, {8, 9}, "other")), HasSubstr("m.h5: error: it has no dataset 'height'"));
  EXPECT_THAT(refusal(hdf5_map(x, y, heights, {9, 8})), HasSubstr("shape 9 x 8, but y and x have 8 and 9 points"));
  EXPECT_THAT(refusal(hdf5_map(x, y, heights, {72})), HasSubstr("shape 72, but"));
  EXPECT_THAT(refusal(hdf5_map(x, y, heights, {8, 9}, "A", "Hz")), HasSubstr("'A' is in 'Hz', which is not a length"));
  auto bent = x;
  bent[4] += 1e-4;
  EXPECT_THAT(refusal(hdf5_map(bent, y, heights, {8, 9})), HasSubstr("'x' is not equidistant at its element 5"));
  EXPECT_THAT(refusal(hdf5_map(std::vector(9, 0.0), y, heights, {8, 9})), HasSubstr("'x' is not equidistant"));
  EXPECT_THAT(refusal(hdf5_map({0, 1e-3}, {0, 1e-3}, {1, 2, 3, 4}, {2, 2})), HasSubstr("8 x 8 points or more"));
  EXPECT_THAT(refusal(hdf5_map(x, y, std::vector(72, std::nan("")), {8, 9})), HasSubstr("no point of the height map"));
  std::string const whole = hdf5_map(x, y, heights, {8, 9});
  EXPECT_THAT(refusal(whole.substr(0, whole.size() / 2)), HasSubstr("m.h5: error: "));
}

TEST(BadInput, HeightMapsInTexts) {
  auto const refusal = [](std::string const& text) { return message_of([&] { height_map_of(text, "m.csv"); }); };
  std::string row, rows;
  for (int i = 0; i < 9; ++i) row += "1 ";
  for (int i = 0; i < 9; ++i) rows += row + "\n";
  EXPECT_EQ(message_of([&] { height_map_of("# pixel: 1 mm\n# unit: nm\n" + rows, "m.csv"); }), "no error");
  EXPECT_THAT(refusal(rows), HasSubstr("does not state its pixel"));
  EXPECT_THAT(refusal("# pixel: 1 mm\n" + rows), HasSubstr("does not state its unit"));
  EXPECT_THAT(refusal("# pixel: 1 Hz\n# unit: nm\n" + rows), HasSubstr("the pixel '1 Hz' is not a length"));
  EXPECT_THAT(refusal("# pixel: -1 mm\n# unit: nm\n" + rows), HasSubstr("the pixel '-1 mm' is not a length"));
  EXPECT_THAT(refusal("# pixel: 1 mm\n# unit: s\n" + rows), HasSubstr("the unit 's' is not a length"));
  EXPECT_THAT(refusal("# pixel: 1 mm\n# unit: nm\n" + row + "\n1 2 x\n"), HasSubstr("m.csv:4:5: error: 'x' is not"));
  EXPECT_THAT(refusal("# pixel: 1 mm\n# unit: nm\n" + row + "\n"), HasSubstr("8 x 8 points or more, this one 9 x 1"));
  EXPECT_THAT(refusal(""), HasSubstr("no numbers in it"));
  EXPECT_THAT(refusal("x [mm], y [mm], height\n1, 2, 3\n"),
              HasSubstr("column 'height' is a length and needs its unit"));
  std::string const header = "x [mm], y [mm], height [nm]\n";
  EXPECT_THAT(refusal(header + "1, 2, 3\n"), HasSubstr("'x' has fewer than 8 places"));
  std::string list = header;
  for (int i = 0; i < 81; ++i) list += std::to_string(i % 9) + ", " + std::to_string(i / 9) + ", 1\n";
  EXPECT_EQ(message_of([&] { height_map_of(list, "m.csv"); }), "no error");
  EXPECT_THAT(refusal(list + "3, 4, 2\n"), HasSubstr("m.csv:83: error: this point has a height already"));
  EXPECT_THAT(refusal(list + "nan, 4, 2\n"), HasSubstr("m.csv:83: error: the place of a height is not a number"));
  EXPECT_THAT(refusal(list + "3.2345, 9, 2\n"), HasSubstr("'x' is not on a grid of equal steps"));
  EXPECT_THAT(refusal(list + "1e6, 9, 2\n"), HasSubstr("'x' "));
}

}  // namespace
}  // namespace straytrace::height_map_files
