// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <png.h>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"
#include "results/results.hpp"

namespace straytrace::results {

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

// Scale of a picture whose colours represent a number.

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Colour paper{246, 246, 246}, ink{40, 40, 40};
constexpr int wide = 6, tall = 7;  // of a character with the gap behind it

// Columns of five by seven dots from the left, the lowest bit at the top.
constexpr std::string_view characters = " +-./:0123456789abcdefghijklmnopqrstuvwxyz";
constexpr std::uint8_t dots[][5] = {
    {0x00, 0x00, 0x00, 0x00, 0x00}, {0x08, 0x08, 0x3e, 0x08, 0x08}, {0x08, 0x08, 0x08, 0x08, 0x08},
    {0x00, 0x60, 0x60, 0x00, 0x00}, {0x20, 0x10, 0x08, 0x04, 0x02}, {0x00, 0x36, 0x36, 0x00, 0x00},
    {0x3e, 0x51, 0x49, 0x45, 0x3e}, {0x00, 0x42, 0x7f, 0x40, 0x00}, {0x42, 0x61, 0x51, 0x49, 0x46},
    {0x21, 0x41, 0x45, 0x4b, 0x31}, {0x18, 0x14, 0x12, 0x7f, 0x10}, {0x27, 0x45, 0x45, 0x45, 0x39},
    {0x3c, 0x4a, 0x49, 0x49, 0x30}, {0x01, 0x71, 0x09, 0x05, 0x03}, {0x36, 0x49, 0x49, 0x49, 0x36},
    {0x06, 0x49, 0x49, 0x29, 0x1e}, {0x20, 0x54, 0x54, 0x54, 0x78}, {0x7f, 0x48, 0x44, 0x44, 0x38},
    {0x38, 0x44, 0x44, 0x44, 0x20}, {0x38, 0x44, 0x44, 0x48, 0x7f}, {0x38, 0x54, 0x54, 0x54, 0x18},
    {0x08, 0x7e, 0x09, 0x01, 0x02}, {0x0c, 0x52, 0x52, 0x52, 0x3e}, {0x7f, 0x08, 0x04, 0x04, 0x78},
    {0x00, 0x44, 0x7d, 0x40, 0x00}, {0x20, 0x40, 0x44, 0x3d, 0x00}, {0x7f, 0x10, 0x28, 0x44, 0x00},
    {0x00, 0x41, 0x7f, 0x40, 0x00}, {0x7c, 0x04, 0x18, 0x04, 0x78}, {0x7c, 0x08, 0x04, 0x04, 0x78},
    {0x38, 0x44, 0x44, 0x44, 0x38}, {0x7c, 0x14, 0x14, 0x14, 0x08}, {0x08, 0x14, 0x14, 0x18, 0x7c},
    {0x7c, 0x08, 0x04, 0x04, 0x08}, {0x48, 0x54, 0x54, 0x54, 0x20}, {0x04, 0x3f, 0x44, 0x40, 0x20},
    {0x3c, 0x40, 0x40, 0x20, 0x7c}, {0x1c, 0x20, 0x40, 0x20, 0x1c}, {0x3c, 0x40, 0x30, 0x40, 0x3c},
    {0x44, 0x28, 0x10, 0x28, 0x44}, {0x0c, 0x50, 0x50, 0x50, 0x3c}, {0x44, 0x64, 0x54, 0x4c, 0x44}};
static_assert(characters.size() == std::size(dots));

class Canvas {
 public:
  Canvas(Image& image, int scale) : image_(image), scale_(scale) {}

  void fill(int left, int top, int width, int height, Colour const& c) {
    for (int y = std::max(0, top); y < std::min(int(image_.rows), top + height); ++y)
      for (int x = std::max(0, left); x < std::min(int(image_.columns), left + width); ++x)
        std::copy(c.begin(), c.end(), image_.rgb.begin() + 3 * (std::ptrdiff_t(y) * image_.columns + x));
  }
  int width_of(std::string_view text) const { return int(text.size()) * wide * scale_ - scale_; }
  void write(int left, int top, std::string_view text) {
    for (char const c : text) {
      auto const at = std::min(characters.find(c), characters.size());
      for (int column = 0; column < 5 && at < characters.size(); ++column)
        for (int row = 0; row < tall; ++row)
          if (dots[at][column] >> row & 1) fill(left + column * scale_, top + row * scale_, scale_, scale_, ink);
      left += wide * scale_;
    }
  }

 private:
  Image& image_;
  int scale_;
};

struct Tick {
  double place;  // 0 to 1
  std::string label;
};

// Decades, as many as there is room for; both ends where there are fewer than two.
std::vector<Tick> ticks_of(ColourBar const& bar, double room) {
  double const low = std::log10(bar.low), span = std::log10(bar.high) - low;
  int const first = int(std::ceil(low - 1e-9)), last = int(std::floor(low + span + 1e-9));
  if (last <= first) return {{0, fmt::format("{:.2g}", bar.low)}, {1, fmt::format("{:.2g}", bar.high)}};
  int const each = std::max(1, int(std::ceil(double(last - first) / std::max(1.0, room))));
  std::vector<Tick> ticks;
  for (int decade = last; decade >= first; decade -= each)
    ticks.push_back({(decade - low) / span, decade == 0 ? "1" : fmt::format("1e{}", decade)});
  return ticks;
}

}  // namespace

bool add_colour_bar(Image& image, ColourBar const& bar) {
  int const columns = int(image.columns), scale = std::max(1, columns / 400);
  int const gap = 2 * scale, thick = 7 * scale, text = tall * scale;
  int const height = 2 * text + thick + 4 * gap, margin = 5 * wide * scale;
  Canvas canvas(image, scale);
  int const width = columns - 2 * margin;
  if (width < canvas.width_of(bar.title) || !(bar.high > bar.low && bar.low > 0)) return false;
  int y = int(image.rows) + gap;
  image.rows += std::uint32_t(height);
  image.rgb.resize(std::size_t(3) * image.columns * image.rows);
  canvas.fill(0, y - gap, columns, height, paper);
  canvas.write((columns - canvas.width_of(bar.title)) / 2, y, bar.title);
  y += text + gap;
  for (int x = 0; x < width; ++x) canvas.fill(margin + x, y, 1, thick, bar.colour((x + 0.5) / width));
  y += thick;
  for (Tick const& tick : ticks_of(bar, double(width) / (7.0 * wide * scale))) {
    int const x = margin + int(std::lround(tick.place * (width - 1)));
    canvas.fill(x - scale / 2, y - thick, scale, thick + gap / 2, ink);
    canvas.write(x - canvas.width_of(tick.label) / 2, y + gap, tick.label);
  }
  return true;
}

namespace {

namespace fs = std::filesystem;
constexpr std::string_view advice = "install its packages with: apt install python3-matplotlib python3-h5py";

std::string last_line(std::string text) {
  text.erase(text.find_last_not_of(" \n\r") + 1);
  return text.substr(text.rfind('\n') + 1);
}

// Runs a module of the package that draws `png_file`.
bool draw(std::vector<std::string> words, std::string const& png_file, std::string& message) {
  PythonChild const child = run_python(std::move(words), PythonChoice::system);
  if (!child.has_package) {
    message =
        "no picture: the folder python/straytrace was not found near the program; set STRAYTRACE_PYTHONPATH to the "
        "folder that contains it";
    return false;
  }
  std::error_code ignored;
  if (child.start_error == 0 && child.status == 0 && fs::exists(png_file, ignored)) return true;
  if (child.start_error != 0)
    message =
        fmt::format("no picture: cannot start '{}' ({}); {}", child.python, std::strerror(child.start_error), advice);
  else if (child.output.find("ModuleNotFoundError") != std::string::npos || child.status == 127)
    message = fmt::format("no picture: {} says '{}'; {}", child.python, last_line(child.output), advice);
  else
    message = fmt::format("no picture: {} says '{}'", child.python, last_line(child.output));
  return false;
}

}  // namespace

bool draw_from_json(std::string const& what, std::string const& json_file, std::string const& png_file,
                    std::string& message) {
  return draw({"straytrace.plots." + what, json_file, "-o", png_file}, png_file, message);
}

std::string picture_of(std::string const& json, std::string const& what, std::string& message,
                       std::string const& ending) {
  TemporaryFolder const place("the picture");
  std::string const from = place.path("data.json"), to = place.path("picture" + ending);
  write_file(from, json);
  return draw_from_json(what, from, to, message) ? read_file(to) : "";
}

bool draw_picture(std::string const& run_file, std::string const& png_file, std::string& message, double low_hz,
                  double high_hz, std::string const& measured) {
  std::vector<std::string> words = {"straytrace.plots", run_file, "-o", png_file};
  std::optional<TemporaryFolder> place;
  if (!measured.empty()) {
    place.emplace("the measured curve");
    write_file(place->path("measured.json"), measured);
    words.insert(words.end(), {"--measured", place->path("measured.json")});
  }
  if (high_hz > low_hz) words.insert(words.end(), {"--band", fmt::format("{}", low_hz), fmt::format("{}", high_hz)});
  return draw(std::move(words), png_file, message);
}

std::string svg_of_run(std::string const& run_file, std::string& message, std::string const& measured) {
  TemporaryFolder const place("the picture");
  std::string const to = place.path("picture.svg");
  return draw_picture(run_file, to, message, 0, 0, measured) ? read_file(to) : "";
}

bool draw_map_pictures(std::string const& run_file, std::string const& folder, std::string const& one_of_them,
                       std::string& message) {
  return draw({"straytrace.plots", run_file, "--maps", folder}, one_of_them, message);
}

bool draw_wave_picture(RunContent const& run, std::string const& png_file, std::string& message) {
  TemporaryFolder const place("the picture");
  std::string const from = place.path("run.h5");
  write_run(from, run);
  return draw({"straytrace.plots", from, "--wave", png_file}, png_file, message);
}

}  // namespace straytrace::results
