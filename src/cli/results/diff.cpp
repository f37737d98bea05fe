// SPDX-License-Identifier: BSD-3-Clause
// straytrace diff: two models, or two runs.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>
#include <utility>

#include "base/errors.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "session/compare/model_diff.hpp"
#include "session/compare/run_diff.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

namespace fs = std::filesystem;

nlohmann::ordered_json as_json(std::vector<Difference> const& all) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (Difference const& d : all)
    out.push_back({{"section", d.section},
                   {"name", d.name},
                   {"key", d.key},
                   {"before", d.before},
                   {"after", d.after},
                   {"instances", d.instances}});
  return out;
}

struct DiffOptions : SceneOptions {
  std::vector<std::string> files;
};

struct Side {
  std::optional<RunFile> run;
  Scene scene;
};

Side read_side(std::string const& file, std::vector<std::string> const& overrides) {
  Side side;
  if (is_run_file(file)) {
    if (!overrides.empty())
      throw InputError("-p sets parameters of a model, but a run has its own", "compare models, or remove -p");
    side.run = read_run(file);
  } else {
    side.scene = read_by_all(file, overrides);
  }
  return side;
}

void read_scene_of(Side& side) {
  if (!side.run) return;
  RunContent const& about = side.run->about;
  side.scene = read_by_all(about.main_file, about.overrides, &about.files);
}

// Names the files of a scene with their folder, which distinguishes scenes of one name.
InputError with_folder(InputError const& e, fs::path const& folder) {
  std::vector<std::string> names = e.files;
  std::string text = "\n" + std::string(e.what());
  for (std::string& name : names) {
    if (name.empty() || folder.empty() || !fs::exists(folder / name)) continue;
    std::string const begin = "\n" + name + ":", whole = (folder / name).string();
    for (std::size_t at = 0; (at = text.find(begin, at)) != text.npos; at += whole.size())
      text.replace(at + 1, name.size(), whole);
    name = whole;
  }
  return {e.problems, text.substr(1), names};
}

// Both, or the errors of both.
std::pair<Side, Side> read_sides(DiffOptions const& options) {
  std::pair<Side, Side> sides;
  std::vector<InputError> errors;
  for (std::size_t i = 0; i < 2; ++i) {
    try {
      (i == 0 ? sides.first : sides.second) = read_side(options.files[i], options.overrides);
    } catch (InputError const& e) {
      errors.push_back(with_folder(e, fs::path(options.files[i]).parent_path()));
    }
  }
  if (errors.size() == 2 && std::string_view(errors[0].what()) == errors[1].what()) errors.pop_back();
  throw_all(errors);
  return sides;
}

int diff(DiffOptions const& options) {
  std::vector<std::string> const& files = options.files;
  auto [before, after] = read_sides(options);
  std::vector<Difference> models;
  bool const runs = before.run && after.run;
  if (!runs || !same_texts(before.run->about, after.run->about)) {
    read_scene_of(before);
    read_scene_of(after);
    models = differences(before.scene, after.scene);
  }
  std::vector<Difference> const parameters = models.empty() ? models : parameter_differences(before.scene, after.scene);
  nlohmann::ordered_json out{{"parameters", as_json(parameters)}, {"models", as_json(models)}};
  std::string text = difference_text(difference_lines(parameters, models));
  if (runs) {
    if (std::string const motion = motion_difference(before.run->about, after.run->about); !motion.empty())
      text += motion + "\n";
    bool const same = data_hash(files[0]) == data_hash(files[1]);
    out["same_data"] = same;
    if (same) text += "the results are identical to the last bit (except run times)\n";
    if (!same || before.run->noise) {
      RunDifference const results = run_differences(*before.run, *after.run);
      out["results"] = run_difference_json(results);
      text += run_difference_text(results);
    }
  }
  std::cout << (options.json() ? out.dump(1) + "\n" : text);
  return done;
}

}  // namespace

void add_diff(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<DiffOptions>();
  DiffOptions& o = *options;
  auto* const command = app.add_subcommand("diff", "Show the physical differences between two models or two runs.");
  command->add_option("files", o.files, "two scenes, or two run files (HDF5); or one of each")->required()->expected(2);
  add_overrides(*command, o.overrides, "set a parameter of both scenes, for example -p rim=48cm");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace diff arm.yaml arm_with_baffles.yaml\n"
      "  straytrace diff before/run.h5 after/run.h5 --format json");
  command->callback([options, &exit_code] { exit_code = diff(*options); });
}

}  // namespace straytrace::cli
