// SPDX-License-Identifier: BSD-3-Clause
// straytrace diff: two models, or two runs.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "session/compare/model_diff.hpp"
#include "session/compare/run_diff.hpp"
#include "session/open_run.hpp"

namespace straytrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr int most_files = 100;

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

// All of them, or the errors of all.
std::vector<Side> read_sides(DiffOptions const& options) {
  std::vector<Side> sides;
  std::vector<InputError> errors;
  for (std::string const& file : options.files) try {
      sides.push_back(read_side(file, options.overrides));
    } catch (InputError const& e) {
      InputError own = with_folder(e, fs::path(file).parent_path());
      auto const same = [&](InputError const& known) { return std::string_view(known.what()) == own.what(); };
      if (std::ranges::none_of(errors, same)) errors.push_back(std::move(own));
    }
  throw_all(errors);
  return sides;
}

struct Answer {
  nlohmann::ordered_json json;
  std::string text;
};

Answer compared(Side& before, Side& after, std::string const& file_before, std::string const& file_after) {
  std::vector<Difference> models;
  bool const runs = before.run && after.run;
  if (!runs || !same_texts(before.run->about, after.run->about)) {
    read_scene_of(before);
    read_scene_of(after);
    models = differences(before.scene, after.scene);
  }
  std::vector<Difference> const parameters = models.empty() ? models : parameter_differences(before.scene, after.scene);
  Answer out{{{"parameters", as_json(parameters)}, {"models", as_json(models)}},
             difference_text(difference_lines(parameters, models))};
  if (!runs) return out;
  if (std::string const motion = motion_difference(before.run->about, after.run->about); !motion.empty())
    out.text += motion + "\n";
  bool const same = data_hash(file_before) == data_hash(file_after);
  out.json["same_data"] = same;
  if (same) out.text += "the results are identical to the last bit (except run times)\n";
  if (!same || before.run->noise) {
    RunDifference const results = run_differences(*before.run, *after.run);
    out.json["results"] = run_difference_json(results);
    out.text += run_difference_text(results);
  }
  return out;
}

// Of two files as it is; of more each with the first, under its name.
int diff(DiffOptions const& options) {
  std::vector<std::string> const& files = options.files;
  std::vector<Side> sides = read_sides(options);
  if (files.size() == 2) {
    Answer const only = compared(sides[0], sides[1], files[0], files[1]);
    std::cout << (options.json() ? json_text(only.json, 1) + "\n" : only.text);
    return done;
  }
  nlohmann::ordered_json all{{"reference", files[0]}, {"comparisons", nlohmann::ordered_json::array()}};
  std::string text;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    Answer one = compared(sides[0], sides[i], files[0], files[i]);
    text += fmt::format("{}{} against {}\n{}", i > 1 ? "\n" : "", files[i], files[0], one.text);
    one.json["file"] = files[i];
    all["comparisons"].push_back(std::move(one.json));
  }
  std::cout << (options.json() ? json_text(all, 1) + "\n" : text);
  return done;
}

}  // namespace

void add_diff(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<DiffOptions>();
  DiffOptions& o = *options;
  auto* const command = app.add_subcommand("diff", "Show the physical differences between models or runs.");
  command->add_option("files", o.files, "scenes or run files (HDF5), two or more: each is compared with the first")
      ->required()
      ->expected(2, most_files);
  add_overrides(*command, o.overrides, "set a parameter of all scenes, for example -p rim=48cm");
  add_format_option(*command, o);
  command->footer(
      "Examples:\n"
      "  straytrace diff arm.yaml arm_with_baffles.yaml\n"
      "  straytrace diff before/run.h5 after/run.h5 --format json\n"
      "  straytrace diff reference/run.h5 black/run.h5 tilted/run.h5");
  command->callback([options, &exit_code] { exit_code = diff(*options); });
}

}  // namespace straytrace::cli
