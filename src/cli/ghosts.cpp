// SPDX-License-Identifier: BSD-3-Clause
// straytrace ghosts: every ghost beam of a scene, its end and its recoupled power.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "base/errors.hpp"
#include "base/files/read_write.hpp"
#include "base/text/json_text.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/text/picture.hpp"
#include "session/interrupt.hpp"
#include "session/light/ghost_search.hpp"
#include "session/light/optical_network.hpp"
#include "session/open_run.hpp"
#include "session/session.hpp"

namespace straytrace::cli {
namespace {

struct GhostsOptions : SceneOptions {
  std::optional<double> floor;
  std::optional<std::uint32_t> order;
  std::string by = "power", beam, out;
  std::size_t show = 20;
  bool csv = false;
};

constexpr std::size_t objects_shown = 12;

GhostRank rank_of(std::string const& by) {
  return by == "strain" ? GhostRank::strain : by == "recoupled" ? GhostRank::recoupled : GhostRank::power;
}

// The scene with the inputs of the noise, if present.
Model read_for_ghosts(SceneOptions const& options) {
  Scene scene = read_scene(options.input, options.overrides);
  if (scene.root().has("interferometer")) return read_model(options.input, options.overrides);
  Model model;
  model.world = build_lit_world(scene);
  scene.throw_if_problems();
  model.scene = std::move(scene);
  return model;
}

std::vector<BeamLaunch> choose_beams(Model const& model, std::string const& wanted) {
  std::vector<BeamLaunch> beams = launches(model.world);
  if (beams.empty())
    throw InputError("the scene has no Gaussian beam to launch",
                     "give one of 'beams' a 'from', a 'cavity' or an 'on', and leave its profile Gaussian");
  if (wanted.empty()) return beams;
  std::vector<std::string> names;
  for (BeamLaunch const& b : beams) names.push_back(b.name);
  std::erase_if(beams, [&](BeamLaunch const& b) { return b.name != wanted; });
  if (!beams.empty()) return beams;
  throw InputError(fmt::format("beam '{}' is not launched", wanted),
                   did_you_mean(wanted, names, fmt::format("it is one of: {}", fmt::join(names, ", "))));
}

// Surfaces that the rows shown have met, as points on them: the background of the picture.
nlohmann::json outlines(World const& world, GhostReport const& report) {
  std::vector<bool> met(world.groups().size());
  for (GhostRow const& r : report.rows) {
    for (PathStep const& s : r.steps) met[s.group.value] = true;
    if (r.ghost.where.valid()) met[r.ghost.where.value] = true;
  }
  nlohmann::json all = nlohmann::json::array();
  WorldView const view = world.view();
  for (Surface const& s : world.surfaces()) {
    if (!met[s.group.value]) continue;
    nlohmann::json points = nlohmann::json::array();
    for (int i = 0; i < 20; ++i)
      for (int k = 0; k < 20; ++k) {
        Vec3 const p =
            view.shapes
                .visit(s.shape, [&](auto const& shape) { return sample_of(shape, (i + 0.5) / 20, (k + 0.5) / 20); })
                .point;
        points.push_back({p.x, p.y, p.z});
      }
    all.push_back({{"object", world.groups()[s.group.value]}, {"points_m", points}});
  }
  return all;
}

// The table of the scene, unless the command line overrides it.
GhostSettings settings_of(Model const& model, GhostsOptions const& wanted) {
  GhostSettings settings = read_ghosts(model.scene).value_or(GhostSettings{});
  model.scene.throw_if_problems();
  settings.floor = wanted.floor.value_or(settings.floor);
  settings.order = wanted.order.value_or(settings.order);
  return settings;
}

// Output, beam by beam.
class Answers {
 public:
  Answers(GhostsOptions const& options, World const& world)
      : options_(options), world_(world), rows_(world.beam_power > 0) {
    if (options.csv) std::cout << rows_.head();
    if (options.out.empty()) return;
    folder_.emplace(options.out);
    csv_ = std::make_unique<AtomicFile>(in_folder("ghosts.csv"));
    csv_->write(rows_.head());
  }
  // Receives every row of a beam; empty: not needed.
  std::function<void(GhostTable const&, Ghost const&)> rows_of(BeamLaunch const& launch) {
    if (!options_.csv && !csv_) return {};
    double const power = world_.beam_power * world_.footprints()[launch.footprint].share;
    return [this, name = launch.name, power](GhostTable const& table, Ghost const& g) {
      std::string const line = rows_.row(name, table.row(g), g.where.valid() ? world_.groups()[g.where.value] : "",
                                         power, world_.body_names());
      if (options_.csv) std::cout << line;
      if (csv_) csv_->write(line);
    };
  }
  void add(GhostReport const& report) {
    text_ += (text_.empty() ? "" : "\n") + ghost_text(report, objects_shown);
    nlohmann::json entry = read_json(ghost_json(report));
    if (csv_) entry["surfaces"] = outlines(world_, report);
    all_.push_back(std::move(entry));
    if (options_.quiet) return;
    if (report.energy_balance.stopped > 0)
      std::cerr << fmt::format("stopped early: beam '{}': {:.2g} of the launched power was not followed\n", report.beam,
                               double(report.energy_balance.stopped));
    for (std::string const& w : report.warnings) std::cerr << fmt::format("warning: beam '{}': {}\n", report.beam, w);
  }
  void finish() {
    if (csv_) {
      csv_->publish();
      write_file(in_folder("ghosts.txt"), text_);
      write_file(in_folder("ghosts.json"), json_text(all_));
      std::string message;
      if (!draw_from_json("ghosts", in_folder("ghosts.json"), in_folder("ghosts.png"), message))
        std::cerr << message << '\n';
    }
    if (options_.csv) return;
    if (options_.json())
      std::cout << json_text(all_) << '\n';
    else
      std::cout << text_;
  }

 private:
  std::string in_folder(char const* name) const { return (std::filesystem::path(options_.out) / name).string(); }
  GhostsOptions const& options_;
  World const& world_;
  GhostCsv rows_;
  std::optional<OutputFolder> folder_;
  std::unique_ptr<AtomicFile> csv_;
  std::string text_;
  nlohmann::json all_ = nlohmann::json::array();
};

int ghosts(GhostsOptions const& options) {
  refuse_two_formats(options.csv, options);
  Model const model = read_for_ghosts(options);
  print_warnings(model.scene, options);
  GhostSearch search{model, settings_of(model, options), rank_of(options.by), options.show, nullptr, {}};
  std::vector<BeamLaunch> const beams = choose_beams(model, options.beam);
  if (search.rank == GhostRank::strain) require_strain(search, beams);
  Answers answers(options, model.world);
  ProgressLine progress(options.quiet);
  auto const start = std::chrono::steady_clock::now();
  search.progress = [&](BeamLaunch const& launch, std::uint64_t ended, char const* doing) {
    double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    progress.at(seconds, [&] {
      return fmt::format("ghosts  beam {}  {}  {:.3g} beams  {:.0f} s", launch.name, doing, double(ended), seconds);
    });
  };
  InterruptGuard const guard;
  search.stop = &guard.stop();
  std::string not_begun;
  for (BeamLaunch const& launch : beams) {
    if (guard.stop())
      not_begun += (not_begun.empty() ? "" : ", ") + launch.name;
    else
      answers.add(ghost_report(search, launch, answers.rows_of(launch)));
  }
  answers.finish();
  if (!not_begun.empty()) std::cerr << fmt::format("stopped early: not begun: {}\n", not_begun);
  return guard.stop() ? checkpointed : done;
}

CLI::Validator number_above_zero() {
  return {[](std::string const& word) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(word, value) && value > 0 && value <= 1) return {};
            return fmt::format("'{}' is not a power ratio above 0 and up to 1; write for example 1e-15", word);
          },
          ""};
}

}  // namespace

void add_ghosts(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<GhostsOptions>();
  GhostsOptions& o = *options;
  auto* const command = app.add_subcommand("ghosts", "List every ghost beam: order, power, end, and recoupled power.");
  add_scene_options(*command, o);
  command
      ->add_option("--floor", o.floor,
                   "smallest power to follow, relative to the launched power or that leaving the cavity; default 1e-15")
      ->check(number_above_zero());
  command->add_option("--order", o.order, "largest number of departures from the main beam; default: no limit")
      ->check(whole_between(0, 1e6, "2"));
  command->add_option("--by", o.by, "rank by power (default), strain or recoupled")
      ->check(CLI::IsMember({"power", "strain", "recoupled"}));
  command->add_option("--beam", o.beam, "only this beam; for a cavity: the mirror through which it leaves");
  command->add_option("--show", o.show, "number of rows; default 20")->check(whole_between(1, 1e6, "50"));
  command->add_flag("--csv", o.csv, "all ghosts, all digits, in the order of the beam tree");
  command->add_option("-o,--out", o.out, "folder for ghosts.csv, ghosts.txt, ghosts.json and ghosts.png");
  command->footer(
      "Examples:\n"
      "  straytrace ghosts examples/bench.yaml --order 2\n"
      "  straytrace ghosts examples/bench.yaml --floor 1e-12 --by recoupled --show 50");
  command->callback([options, &exit_code] { exit_code = ghosts(*options); });
}

}  // namespace straytrace::cli
