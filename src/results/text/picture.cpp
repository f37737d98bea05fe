// SPDX-License-Identifier: BSD-3-Clause
#include "results/text/picture.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "base/errors.hpp"
#include "base/process/child_process.hpp"
#include "results/results.hpp"

extern char** environ;

namespace straytrace::results {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view advice = "install its packages with: apt install python3-matplotlib python3-h5py";

std::string environment(char const* name) {
  char const* value = std::getenv(name);
  return value ? value : "";
}

std::string interpreter() {
  if (std::string const chosen = environment("STRAYTRACE_PYTHON"); !chosen.empty()) return chosen;
  std::string const system = "/usr/bin/python3";
  return ::access(system.c_str(), X_OK) == 0 ? system : "python3";
}

bool holds_package(fs::path const& folder) {
  std::error_code ignored;
  return fs::exists(folder / "straytrace" / "plots" / "__main__.py", ignored);
}

std::string package_folder() {
  if (std::string const chosen = environment("STRAYTRACE_PYTHONPATH"); !chosen.empty()) return chosen;
  std::error_code unknown;
  fs::path above = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  for (; !above.empty(); above = above.parent_path()) {
    if (holds_package(above)) return above;  // as pip installs it
    if (holds_package(above / "python")) return above / "python";
    if (holds_package(above / "share/straytrace/python")) return above / "share/straytrace/python";
    if (above == above.root_path()) break;
  }
#ifdef STRAYTRACE_SOURCE_PYTHON
  if (holds_package(STRAYTRACE_SOURCE_PYTHON)) return STRAYTRACE_SOURCE_PYTHON;
#endif
  return "";
}

std::vector<std::string> child_environment(std::string const& folder) {
  std::string path = folder;
  if (std::string const old = environment("PYTHONPATH"); !old.empty()) path += ":" + old;
  std::vector<std::string> all = {"PYTHONPATH=" + path, "PYTHONDONTWRITEBYTECODE=1", "MPLBACKEND=Agg"};
  for (char** entry = environ; *entry; ++entry) {
    std::string_view const text = *entry;
    if (!text.starts_with("PYTHONPATH=") && !text.starts_with("PYTHONDONTWRITEBYTECODE=") &&
        !text.starts_with("MPLBACKEND="))
      all.emplace_back(text);
  }
  return all;
}

std::string last_line(std::string text) {
  text.erase(text.find_last_not_of(" \n\r") + 1);
  return text.substr(text.rfind('\n') + 1);
}

// Runs a module of the package that draws `png_file`.
bool draw(std::vector<std::string> words, std::string const& png_file, std::string& message) {
  std::string const python = interpreter(), folder = package_folder();
  if (folder.empty()) {
    message =
        "no picture: the folder python/straytrace was not found near the program; set STRAYTRACE_PYTHONPATH to the "
        "folder that contains it";
    return false;
  }
  words.insert(words.begin(), {python, "-m"});
  FinishedChild const child = run_child(words, child_environment(folder));
  std::error_code ignored;
  if (child.start_error == 0 && child.status == 0 && fs::exists(png_file, ignored)) return true;
  if (child.start_error != 0)
    message = fmt::format("no picture: cannot start '{}' ({}); {}", python, std::strerror(child.start_error), advice);
  else if (child.output.find("ModuleNotFoundError") != std::string::npos || child.status == 127)
    message = fmt::format("no picture: {} says '{}'; {}", python, last_line(child.output), advice);
  else
    message = fmt::format("no picture: {} says '{}'", python, last_line(child.output));
  return false;
}

// A temporary folder for the picture.
class Workplace {
 public:
  Workplace() {
    std::error_code none;
    std::string name = (fs::temp_directory_path(none) / "straytrace-XXXXXX").string();
    if (none || ::mkdtemp(name.data()) == nullptr)
      throw InputError(fmt::format("cannot make a folder in '{}' for the picture",
                                   none ? environment("TMPDIR") : fs::path(name).parent_path().string()),
                       "set TMPDIR to another one");
    folder_ = name;
  }
  ~Workplace() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Workplace(Workplace const&) = delete;
  Workplace& operator=(Workplace const&) = delete;
  std::string path(char const* name) const { return (folder_ / name).string(); }

 private:
  fs::path folder_;
};

}  // namespace

bool draw_from_json(std::string const& what, std::string const& json_file, std::string const& png_file,
                    std::string& message) {
  return draw({"straytrace.plots." + what, json_file, "-o", png_file}, png_file, message);
}

std::string picture_of(std::string const& json, std::string const& what, std::string& message,
                       std::string const& ending) {
  Workplace const place;
  std::string const from = place.path("data.json"), to = place.path(("picture" + ending).c_str());
  write_file(from, json);
  return draw_from_json(what, from, to, message) ? read_file(to) : "";
}

bool draw_picture(std::string const& run_file, std::string const& png_file, std::string& message, double low_hz,
                  double high_hz) {
  std::vector<std::string> words = {"straytrace.plots", run_file, "-o", png_file};
  if (high_hz > low_hz) words.insert(words.end(), {"--band", fmt::format("{}", low_hz), fmt::format("{}", high_hz)});
  return draw(std::move(words), png_file, message);
}

std::string svg_of_run(std::string const& run_file, std::string& message) {
  Workplace const place;
  std::string const to = place.path("picture.svg");
  return draw_picture(run_file, to, message) ? read_file(to) : "";
}

bool draw_map_pictures(std::string const& run_file, std::string const& folder, std::string const& one_of_them,
                       std::string& message) {
  return draw({"straytrace.plots", run_file, "--maps", folder}, one_of_them, message);
}

bool draw_wave_picture(RunContent const& run, std::string const& png_file, std::string& message) {
  Workplace const place;
  std::string const from = place.path("run.h5");
  write_run(from, run);
  return draw({"straytrace.plots", from, "--wave", png_file}, png_file, message);
}

}  // namespace straytrace::results
