// SPDX-License-Identifier: BSD-3-Clause
// From a run file to its model, in one place, and the warnings about both.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/errors.hpp"
#include "results/results.hpp"
#include "scene/scene.hpp"
#include "session/model.hpp"
#include "session/options.hpp"
#include "trace/run/trace.hpp"

namespace straytrace::session {

// From a run file to its model, in one place: a run projected with another motion is read with that motion.

// The whole model of a run, with its surfaces: the scene inside the file with the parameters of the run, then
// `overrides`; motion and responses that the run was projected with replace those of the scene. Refers to the texts in
// the file.
Model model_of(RunFile const&, std::vector<std::string> const& overrides = {});

// The part of it that projects noise, without its surfaces; `overrides` must not change the light.
ProjectionModel projection_of(RunFile const&, std::vector<std::string> const& overrides);

// The scene inside the file with the parameters of the run, then `overrides`. Refers to the texts in the file.
Scene scene_of(RunFile const&, std::vector<std::string> const& overrides);

// Throws InputError, whose remedy makes a run, where this is a scene by its name.
void refuse_scene(std::string const& path);
RunFile read_run_file(std::string const& path);

// A run and the model that projects it: no surface is built.
struct OpenRun {
  explicit OpenRun(std::string const& path) : OpenRun(read_run_file(path)) {}
  explicit OpenRun(RunFile);
  // With the motion in the file `motion` on disk instead of that which the run was projected with, unless it is empty.
  // Responses of ports that the run was projected with stay, except those that `motion` gives itself. `files`: gets the
  // texts of the run and of that file; throws where two of one name differ.
  OpenRun(std::string const& path, std::string const& motion, FileTexts* files = nullptr)
      : OpenRun(read_run_file(path), motion, files) {}
  OpenRun(RunFile, std::string const& motion, FileTexts* files = nullptr);
  OpenRun(OpenRun const&) = delete;  // the model refers to the texts in the file
  OpenRun& operator=(OpenRun const&) = delete;

  RunFile file;
  ProjectionModel model;
  std::string projected_with;  // files of motion and responses in the order in which they act, a line each
};

// The input of `run`: a scene file, or a run file that is repeated from the texts, seed and stop rule inside it.
class RunInput {
 public:
  explicit RunInput(std::string input);
  Model read(std::vector<std::string> const& overrides) const;  // refers to the texts held here
  // The same with the number of histories originally requested, where the run stopped early.
  Model read_to_the_end(std::vector<std::string> const& overrides) const;
  Slice slice() const { return file_ ? file_->trace.slice : Slice{}; }
  RunContent completed(RunContent) const;  // with the motion file the run was projected with

 private:
  std::string input_;
  std::optional<RunFile> file_;
};

// By its first bytes; read_run() checks the rest.
bool is_run_file(std::string const& file);
// Where a command takes a scene or a run: also a name ending in .h5, so that the error of a missing or damaged run says
// so.
bool names_run(std::string const& file);

// A file with nothing to trace holds motion for `straytrace noise --motion`.
bool only_motion(Scene const&);

// A file of the language, a model or only motion, read by every module involved. Throws one InputError with all
// problems. `texts`: of a run file, instead of disk.
Scene read_by_all(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts = nullptr);

// Warnings on stderr: sentences, JSON lists with --format json, nothing with --quiet.

void print_warnings(ProjectionModel const&, PrintOptions const&);
void print_warnings(Scene const&, PrintOptions const&);
// Without a place in a file; a remedy follows in a line of its own, after two spaces.
void print_warning(std::string const& sentence, PrintOptions const&);
std::string warning_as_json(std::string const& sentence);  // a list of one (problems_as_json)

// Lines of JSON on stderr for a program that runs this one (straytrace --events): progress of a trace, and problems of
// the input, which are then printed in no other form. Each is an object with the key `event`; all other lines are plain
// text.

void print_events();  // from now on
bool events_on();
// {"event": "progress", histories, wanted_histories, seconds, histories_per_s, rays_per_s, error, wanted_error, line};
// errors are relative, null where there is none; `line` is plain text.
void print_progress(TraceProgress const&, std::string const& line);
void print_problems(InputError const&);  // {"event": "problems", text, "problems": [as problems_as_json]}

}  // namespace straytrace::session
