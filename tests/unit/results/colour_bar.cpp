// SPDX-License-Identifier: BSD-3-Clause
// A picture contains its colour scale.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/every_module.hpp"
#include "results/text/picture.hpp"

namespace straytrace::testing {
namespace {

using Colour = std::array<std::uint8_t, 3>;

Image grey(std::uint32_t columns, std::uint32_t rows) {
  return {columns, rows, std::vector<std::uint8_t>(std::size_t(3) * columns * rows, 100)};
}
Colour at(Image const& image, int x, int y) {
  auto const i = std::size_t(3) * (std::size_t(y) * image.columns + std::size_t(x));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}
ColourBar bar(double low) {
  return {low, 1, "score per unit of power", [](double x) {
            return Colour{std::uint8_t(255 * x), 0, std::uint8_t(255 - 255 * x)};
          }};
}

// Columns of a row that are as dark as ink, in a picture whose bar has none.
std::vector<int> ticks(Image const& image, int y) {
  std::vector<int> found;
  for (int x = 0; x < int(image.columns); ++x)
    if (at(image, x, y) == Colour{40, 40, 40}) found.push_back(x);
  return found;
}

TEST(ColourBar, RunsFromLowToHighWithItsDecades) {
  Image image = grey(400, 300);
  ASSERT_TRUE(add_colour_bar(image, bar(1e-4)));
  Image const before = grey(400, 300);
  ASSERT_GT(image.rows, 300u);
  EXPECT_TRUE(std::equal(before.rgb.begin(), before.rgb.end(), image.rgb.begin())) << "the picture above is as it was";
  int row = 0;  // through the bar
  for (int y = 300; y < int(image.rows); ++y)
    if (at(image, 35, y)[2] > 200 && at(image, 365, y)[0] > 200 && at(image, 35, y)[0] < 60) row = y;
  ASSERT_GT(row, 0);
  EXPECT_EQ(at(image, 5, row), (Colour{246, 246, 246}));
  // Bar from 30 to 369: decades 1e-4 to 1 at quarters of it; control: nothing between.
  EXPECT_EQ(ticks(image, row), (std::vector<int>{30, 115, 200, 284, 369}));
  Image other = grey(400, 300);
  ASSERT_TRUE(add_colour_bar(other, bar(1e-8)));
  EXPECT_NE(ticks(other, row), ticks(image, row)) << "control: another scale has other ticks";
}

TEST(ColourBar, ANarrowPictureIsLeftAlone) {
  Image image = grey(100, 80);
  EXPECT_FALSE(add_colour_bar(image, bar(1e-4)));
  EXPECT_EQ(image.rgb, grey(100, 80).rgb);
}

}  // namespace
}  // namespace straytrace::testing
