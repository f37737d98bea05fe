// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/png.hpp"

#include <png.h>

#include "base/errors.hpp"
#include "results/results.hpp"

namespace straytrace {

std::string png_bytes(Image const& image) {
  png_image about = {};
  about.version = PNG_IMAGE_VERSION;
  about.width = image.columns;
  about.height = image.rows;
  about.format = PNG_FORMAT_RGB;
  std::string bytes;
  png_alloc_size_t size = 0;
  bool good = std::size_t{3} * image.columns * image.rows == image.rgb.size() &&
              png_image_write_get_memory_size(about, size, 0, image.rgb.data(), 0, nullptr);
  if (good) {
    bytes.resize(size);
    good = png_image_write_to_memory(&about, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr);
  }
  if (!good) throw NumericalError(std::string("a picture could not be written as PNG: ") + about.message);
  bytes.resize(size);
  return bytes;
}

void write_png(std::string const& file, Image const& image) { write_file(file, png_bytes(image)); }

}  // namespace straytrace
