// SPDX-License-Identifier: BSD-3-Clause
// From a run file to its model, in one place: what was projected with another motion is read with that motion.
#pragma once

#include <string>
#include <vector>

#include "app/model.hpp"
#include "report/report.hpp"

namespace straytrace {

// The model of a run: the scene inside the file with the parameters of the run, then `overrides`; motion and responses
// that the run was projected with take the place of those of the scene. Refers to the texts in the file.
Model model_of(RunFile const&, std::vector<std::string> const& overrides = {});

// read_run(), which tells the way to a run where this is a scene.
RunFile read_run_file(std::string const& path);

struct OpenRun {
  explicit OpenRun(std::string const& path);
  // With the motion in the file `motion` on disk instead of that which the run was projected with, unless it is empty.
  // Responses of ports that the run was projected with stay, except those that `motion` gives itself. `files`: gets the
  // texts of the run and of that file; throws where two of one name differ.
  OpenRun(std::string const& path, std::string const& motion, FileTexts* files = nullptr);
  OpenRun(OpenRun const&) = delete;  // the model refers to the texts in the file
  OpenRun& operator=(OpenRun const&) = delete;

  RunFile file;
  Model model;
  std::string projected_with;  // files of motion and responses in the order in which they act, a line each
};

}  // namespace straytrace
