// SPDX-License-Identifier: BSD-3-Clause
// PNG files hold what they were given.
#include <gtest/gtest.h>

#include <png.h>

#include "base/errors.hpp"
#include "base/every_module.hpp"
#include "results/text/picture.hpp"

namespace straytrace::testing {
namespace {

TEST(ImageFile, PixelsComeBack) {
  Image image{7, 5, {}};
  for (unsigned i = 0; i < 3 * 7 * 5; ++i) image.rgb.push_back(std::uint8_t(37 * i));
  std::string const bytes = png_bytes(image);
  EXPECT_EQ(bytes, png_bytes(image));
  png_image back = {};
  back.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&back, bytes.data(), bytes.size()));
  EXPECT_EQ(back.width, 7u);
  EXPECT_EQ(back.height, 5u);
  back.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(back));
  ASSERT_TRUE(png_image_finish_read(&back, nullptr, rgb.data(), 0, nullptr));
  EXPECT_EQ(rgb, image.rgb);
  image.rgb[20] ^= 1;
  EXPECT_NE(png_bytes(image), bytes);
}

TEST(ImageFile, ImpossibleSizesAreErrors) {
  EXPECT_THROW(png_bytes({7, 5, std::vector<std::uint8_t>(3)}), NumericalError);
  EXPECT_THROW(write_png("no/such/folder/a.png", {1, 1, {1, 2, 3}}), InputError);
}

}  // namespace
}  // namespace straytrace::testing
