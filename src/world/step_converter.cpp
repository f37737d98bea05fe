// SPDX-License-Identifier: BSD-3-Clause
#include "world/step_converter.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>
#include <vector>

#include "base/child_process.hpp"
#include "base/file_bytes.hpp"
#include "base/sha256.hpp"

extern char** environ;

namespace straytrace {
namespace {

namespace fs = std::filesystem;

std::string environment(char const* name) {
  char const* value = std::getenv(name);
  return value ? value : "";
}

bool can_run(fs::path const& program) {
  std::error_code ignored;
  return fs::is_regular_file(program, ignored) && ::access(program.c_str(), X_OK) == 0;
}

// Empty: there is none.
fs::path converter() {
  std::string const name = "straytrace-step";
  if (std::string const chosen = environment("STRAYTRACE_STEP"); !chosen.empty())
    return can_run(chosen) ? fs::path(chosen) : fs::path();
  std::error_code unknown;
  if (fs::path const beside = fs::read_symlink("/proc/self/exe", unknown).parent_path() / name; can_run(beside))
    return beside;
  std::string const path = environment("PATH");
  for (std::size_t at = 0; at < path.size();) {
    std::size_t const end = std::min(path.find(':', at), path.size());
    fs::path const folder = path.substr(at, end - at);
    if (folder.is_absolute() && can_run(folder / name)) return folder / name;
    at = end + 1;
  }
  return {};
}

fs::path cache_folder() {
  std::string const chosen = environment("XDG_CACHE_HOME"), home = environment("HOME");
  fs::path const base = !chosen.empty() ? fs::path(chosen) : !home.empty() ? fs::path(home) / ".cache" : fs::path();
  if (!base.is_absolute()) return {};
  fs::path const folder = base / "straytrace" / "step";
  std::error_code failed;
  fs::create_directories(folder, failed);
  return ::access(folder.c_str(), W_OK) == 0 ? folder : fs::path();
}

// A folder for one conversion, gone with it.
class WorkFolder {
 public:
  explicit WorkFolder(fs::path const& parent) {
    std::string pattern = (parent / "work-XXXXXX").string();
    if (::mkdtemp(pattern.data())) path_ = pattern;
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  WorkFolder(WorkFolder const&) = delete;
  WorkFolder& operator=(WorkFolder const&) = delete;
  fs::path const& path() const { return path_; }

 private:
  fs::path path_;
};

// "bench.step: error: WHAT\n  SUGGESTION\n"
MeshFault said(std::string const& output) {
  constexpr std::string_view mark = ": error: ";
  std::size_t const at = output.find(mark);
  if (at == std::string::npos)
    return {"straytrace-step failed: " + output.substr(0, 300), "run it on the file by hand"};
  std::size_t const begin = at + mark.size(), end = std::min(output.find('\n', begin), output.size());
  std::string suggestion = end < output.size() ? output.substr(end + 1) : "";
  while (suggestion.ends_with('\n')) suggestion.pop_back();
  suggestion.erase(0, suggestion.find_first_not_of(' '));
  return {output.substr(begin, end - begin), suggestion};
}

StepConversion run(fs::path const& program, fs::path const& folder, std::string const& bytes) {
  fs::path const from = folder / "in.step", to = folder / "out.cad.json";
  if (!(std::ofstream(from, std::ios::binary) << bytes))
    return {"",
            {fmt::format("there is no room in '{}' to convert it", folder.parent_path().string()), "free some space"}};
  std::vector<std::string> variables;
  for (char** entry = environ; *entry; ++entry) variables.emplace_back(*entry);
  FinishedChild const child = run_child(
      {program.string(), from.string(), "-o", to.string(), "--quiet", "--end-with-parent"}, std::move(variables));
  if (child.start_error != 0)
    return {"",
            {fmt::format("cannot start '{}': {}", program.string(), std::strerror(child.start_error)),
             "build straytrace-step again"}};
  if (child.status != 0) return {"", said(child.output)};
  return {bytes_of_file(to).bytes, {}};
}

}  // namespace

StepConversion convert_step(std::string const& name, std::string const& bytes) {
  fs::path const program = converter();
  if (program.empty())
    return {"",
            {"STEP files are read by the program straytrace-step, which is neither beside straytrace nor in PATH",
             fmt::format("install OpenCASCADE and build it (scripts/setup, scripts/build), or convert the file where "
                         "it is installed, 'straytrace-step {}', and name the .cad.json here",
                         name)}};
  std::error_code failed;
  fs::path const cache = cache_folder();
  std::string const identity = fmt::format("{} {} ", fs::file_size(program, failed),
                                           fs::last_write_time(program, failed).time_since_epoch().count());
  fs::path const kept = cache.empty() ? fs::path() : cache / (sha256(identity + bytes) + ".cad.json");
  // A machine that lost its power may have kept a part of it.
  if (std::string text = kept.empty() ? "" : bytes_of_file(kept).bytes; nlohmann::json::accept(text))
    return {std::move(text), {}};
  WorkFolder const work(cache.empty() ? fs::temp_directory_path(failed) : cache);
  if (work.path().empty())
    return {"", {"there is no folder to convert it in", "set XDG_CACHE_HOME to a folder of yours"}};
  StepConversion made = run(program, work.path(), bytes);
  if (!made.text.empty() && !kept.empty()) fs::rename(work.path() / "out.cad.json", kept, failed);
  return made;
}

}  // namespace straytrace
