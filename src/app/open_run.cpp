// SPDX-License-Identifier: BSD-3-Clause
#include "app/open_run.hpp"

#include <fmt/format.h>

#include <sstream>

#include "app/read_file.hpp"
#include "base/message.hpp"

namespace straytrace {
namespace {

Model traced_model(RunFile const& file, std::vector<std::string> const& overrides) {
  std::vector<std::string> all = file.about.overrides;
  all.insert(all.end(), overrides.begin(), overrides.end());
  return read_model(file.about.main_file, all, &file.about.files);
}

}  // namespace

Model model_of(RunFile const& file, std::vector<std::string> const& overrides) {
  Model model = traced_model(file, overrides);
  std::istringstream names(file.about.motion_file);
  for (std::string name; std::getline(names, name);) replace_motion(model, name, &file.about.files, nullptr);
  return model;
}

RunFile read_run_file(std::string const& path) {
  if ((path.ends_with(".yaml") || path.ends_with(".yml")) && !is_run_file(path))
    throw InputError(fmt::format(
        "error: '{0}' is a scene, not a run\n  trace it first: straytrace run {0} -o out/, which writes out/run.h5",
        path));
  return read_run(path);
}

OpenRun::OpenRun(std::string const& path) : file(read_run_file(path)), model(model_of(file)) {}

OpenRun::OpenRun(std::string const& path, std::string const& motion, FileTexts* files)
    : file(read_run_file(path)), model(motion.empty() ? model_of(file) : traced_model(file, {})) {
  if (files) *files = file.about.files;
  if (!motion.empty()) replace_motion(model, motion, nullptr, files);
}

}  // namespace straytrace
