// SPDX-License-Identifier: BSD-3-Clause
#include "session/open_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>
#include <sstream>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "base/text/words.hpp"
#include "scene/scene_document.hpp"
#include "session/light/optical_network.hpp"
#include "session/model.hpp"

namespace straytrace::session {
namespace {

std::vector<std::string> all_overrides(RunFile const& file, std::vector<std::string> const& more) {
  std::vector<std::string> all = file.about.overrides;
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

Model traced_model(RunFile const& file, std::vector<std::string> const& overrides) {
  return read_model(file.about.main_file, all_overrides(file, overrides), &file.about.files);
}

std::vector<std::string> lines_of(std::string const& text) {
  std::vector<std::string> all;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  return all;
}

// Files of schema 1 hold no projection inputs: their whole model is built for them.
ProjectionModel traced_projection(RunFile const& file, std::vector<std::string> const& overrides = {}) {
  RunContent const& about = file.about;
  if (!about.projection) return traced_model(file, overrides);
  return read_projection_model(about.main_file, all_overrides(file, overrides), about.files, *about.projection);
}

template <class Projected>
Projected with_motion_of(RunFile const& file, Projected model) {
  for (std::string const& name : lines_of(file.about.motion_file))
    replace_motion(model, name, &file.about.files, nullptr);
  return model;
}

// Of the files that the run was projected with, those that hold responses of ports and nothing else.
std::vector<std::string> files_of_responses(RunFile const& file) {
  std::vector<std::string> all;
  for (std::string const& name : lines_of(file.about.motion_file)) {
    Scene const held = read_scene(name, {}, &file.about.files);
    if (held.table("interferometer").has("responses") && !held.table("bodies") && !held.table("noise"))
      all.push_back(name);
  }
  return all;
}

}  // namespace

Model model_of(RunFile const& file, std::vector<std::string> const& overrides) {
  return with_motion_of(file, traced_model(file, overrides));
}

ProjectionModel projection_of(RunFile const& file, std::vector<std::string> const& overrides) {
  return with_motion_of(file, traced_projection(file, overrides));
}

Scene scene_of(RunFile const& file, std::vector<std::string> const& overrides) {
  return read_scene(file.about.main_file, all_overrides(file, overrides), &file.about.files);
}

void refuse_scene(std::string const& path) {
  if ((path.ends_with(".yaml") || path.ends_with(".yml")) && !is_run_file(path))
    throw InputError(fmt::format("'{}' is a scene, not a run", path),
                     fmt::format("trace it first: straytrace run {} -o out/, which writes out/run.h5", path));
}

RunFile read_run_file(std::string const& path) {
  refuse_scene(path);
  return read_run(path);
}

OpenRun::OpenRun(RunFile run)
    : file(std::move(run)),
      model(with_motion_of(file, traced_projection(file))),
      projected_with(file.about.motion_file) {}

// A new motion file acts before the responses that stay, which its band must not undo; one that defines the
// interferometer acts after them.
OpenRun::OpenRun(RunFile run, std::string const& motion, FileTexts* files)
    : file(std::move(run)),
      model(motion.empty() ? with_motion_of(file, traced_projection(file)) : traced_projection(file)),
      projected_with(file.about.motion_file) {
  if (files) *files = file.about.files;
  if (motion.empty()) return;
  std::vector<std::string> names = files_of_responses(file);
  bool const last = bool(read_scene(motion, {}).table("interferometer"));
  auto const stay = [&] {
    for (std::string const& name : names) replace_motion(model, name, &file.about.files, nullptr);
  };
  if (last) stay();
  replace_motion(model, motion, nullptr, files);
  if (!last) stay();
  names.insert(last ? names.end() : names.begin(), std::filesystem::path(motion).filename().string());
  projected_with = fmt::format("{}", fmt::join(names, "\n"));
}

RunInput::RunInput(std::string input) : input_(std::move(input)) {
  if (names_run(input_)) file_ = read_run(input_);
}

Model RunInput::read(std::vector<std::string> const& overrides) const {
  if (!file_) return read_model(input_, overrides);
  Model model = model_of(*file_, overrides);
  model.waves = file_->about.waves;
  if (overrides.empty()) model.ring_waves = file_->about.ring;
  model.seed = file_->trace.coupling.seed;
  model.world.block_size = file_->trace.coupling.block_size;
  if (file_->trace.stop_rule.empty()) {
    bool const in_pieces = file_->trace.stopped == Stopped::by_gaps || !file_->trace.slice.whole();
    model.until = {};
    model.histories =
        in_pieces ? file_->trace.all_blocks * file_->trace.coupling.block_size : file_->trace.coupling.histories;
  } else {
    model.until = parse_stop_rule(file_->trace.stop_rule);
  }
  return model;
}

Model RunInput::read_to_the_end(std::vector<std::string> const& overrides) const {
  Model model = read(overrides);
  if (file_) model.histories = file_->trace.all_blocks * file_->trace.coupling.block_size;
  return model;
}

RunContent RunInput::completed(RunContent content) const {
  if (!file_ || file_->about.motion_file.empty()) return content;
  content.files = file_->about.files;
  content.motion_file = file_->about.motion_file;
  return content;
}

bool is_run_file(std::string const& file) {
  constexpr std::string_view seal = "straytrace-run ", hdf5 = "\x89HDF\r\n\x1a\n";
  std::string const head = head_of_file(file, seal.size());
  return head == seal || head.starts_with(hdf5);
}

bool names_run(std::string const& file) { return file.ends_with(".h5") || is_run_file(file); }

bool only_motion(Scene const& scene) {
  return scene.table("bodies") && !scene.root().has("scene") && !scene.root().has("beams");
}

Scene read_by_all(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts) {
  if (Scene scene = read_scene(file, overrides, texts); only_motion(scene)) {
    read_motion_file(scene);
    return scene;
  } else if (only_network(scene)) {
    read_lone_network(scene);
    return scene;
  }
  return std::move(read_model(file, overrides, texts).scene);
}

void print_warnings(ProjectionModel const& model, PrintOptions const& options) {
  if (!options.quiet) std::cerr << (options.json() ? model.warnings_json : printable(model.warnings));
}

void print_warnings(Scene const& scene, PrintOptions const& options) {
  if (!options.quiet) std::cerr << (options.json() ? warnings_as_json(scene) : printable(scene.warnings()));
}

std::string warning_as_json(std::string const& sentence) {
  constexpr std::string_view between = "\n  ";
  std::size_t const at = sentence.find(between);
  std::string const remedy = at == sentence.npos ? "" : sentence.substr(at + between.size());
  return problems_as_json(InputError({{{}, sentence.substr(0, at), remedy, Severity::warning}}, ""));
}

void print_warning(std::string const& sentence, PrintOptions const& options) {
  if (options.quiet || !options.warnings) return;
  if (options.json())
    std::cerr << warning_as_json(sentence);
  else
    std::cerr << "warning: " << printable(sentence) << '\n';
}

namespace {

using SortedJson = nlohmann::json;
bool told = false;

void tell(SortedJson const& event) { std::cerr << json_text(event) << '\n' << std::flush; }

}  // namespace

void print_events() { told = true; }
bool events_on() { return told; }

void print_progress(TraceProgress const& p, std::string const& line) {
  tell({{"event", "progress"},
        {"histories", p.histories},
        {"wanted_histories", p.wanted_histories},
        {"seconds", p.seconds},
        {"histories_per_s", p.histories_per_s},
        {"rays_per_s", p.rays_per_s},
        {"error", p.error},  // not a number: null
        {"wanted_error", p.wanted_error},
        {"line", line}});
}

void print_problems(InputError const& e) {
  tell({{"event", "problems"}, {"text", e.what()}, {"problems", read_json(problems_as_json(e))}});
}

}  // namespace straytrace::session
