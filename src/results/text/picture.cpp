// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/picture.hpp"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "base/errors.hpp"
#include "base/process/python_child.hpp"
#include "results/results.hpp"

namespace straytrace::results {
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
