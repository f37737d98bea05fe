// SPDX-License-Identifier: BSD-3-Clause
#include "base/process/python_child.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <unistd.h>

#include "base/errors.hpp"
#include "base/process/environment.hpp"

extern char** environ;

namespace straytrace {
namespace {

namespace fs = std::filesystem;

std::string interpreter(PythonChoice choice) {
  if (std::string const chosen = environment_variable("STRAYTRACE_PYTHON"); !chosen.empty()) return chosen;
  std::string const system = "/usr/bin/python3";
  return choice == PythonChoice::system && ::access(system.c_str(), X_OK) == 0 ? system : "python3";
}

bool holds_package(fs::path const& folder) {
  std::error_code ignored;
  return fs::exists(folder / "straytrace" / "plots" / "__main__.py", ignored);
}

std::string package_folder() {
  if (std::string const chosen = environment_variable("STRAYTRACE_PYTHONPATH"); !chosen.empty()) return chosen;
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
  if (std::string const old = environment_variable("PYTHONPATH"); !old.empty()) path += ":" + old;
  std::vector<std::string> all = {"PYTHONPATH=" + path, "PYTHONDONTWRITEBYTECODE=1", "MPLBACKEND=Agg"};
  for (char** entry = environ; *entry; ++entry) {
    std::string_view const text = *entry;
    if (!text.starts_with("PYTHONPATH=") && !text.starts_with("PYTHONDONTWRITEBYTECODE=") &&
        !text.starts_with("MPLBACKEND="))
      all.emplace_back(text);
  }
  return all;
}

}  // namespace

PythonChild run_python(std::vector<std::string> words, PythonChoice choice) {
  PythonChild child{{}, interpreter(choice), true};
  std::string const folder = package_folder();
  if (folder.empty()) {
    child.has_package = false;
    return child;
  }
  words.insert(words.begin(), {child.python, "-m"});
  static_cast<FinishedChild&>(child) = run_child(std::move(words), child_environment(folder));
  return child;
}

TemporaryFolder::TemporaryFolder(std::string const& purpose) {
  std::error_code none;
  std::string name = (fs::temp_directory_path(none) / "straytrace-XXXXXX").string();
  if (none || ::mkdtemp(name.data()) == nullptr)
    throw InputError(
        fmt::format("cannot make a folder in '{}' for {}",
                    none ? environment_variable("TMPDIR") : fs::path(name).parent_path().string(), purpose),
        "set TMPDIR to another one");
  folder_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace straytrace
