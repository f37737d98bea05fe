// SPDX-License-Identifier: BSD-3-Clause
// straytrace ghosts: every ghost beam of a scene, where it ends and how much of it comes back.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "app/common_options.hpp"
#include "app/ghost_noise.hpp"
#include "app/session.hpp"
#include "base/message.hpp"
#include "report/picture.hpp"

namespace straytrace {
namespace {

struct Wanted {
  double floor = 1e-15;
  std::uint32_t order = TreeLimits{}.order;
  std::string by = "power", beam;
};

constexpr std::size_t rows_shown = 20, objects_shown = 12;

GhostRank rank_of(std::string const& by) {
  return by == "strain" ? GhostRank::strain : by == "recoupled" ? GhostRank::recoupled : GhostRank::power;
}

// The scene with what the noise needs, as far as it is there.
Model read_for_ghosts(Options const& options) {
  Scene scene = read_scene(options.input, options.overrides);
  if (scene.root().has("interferometer")) return read_model(options.input, options.overrides);
  Model model;
  model.world = build_world(scene);
  scene.throw_if_problems();
  model.scene = std::move(scene);
  return model;
}

std::vector<BeamLaunch> choose_beams(Model const& model, std::string const& wanted) {
  std::vector<BeamLaunch> beams = launches(model.world);
  if (beams.empty())
    throw InputError(
        "error: the scene has no Gaussian beam to launch\n"
        "  give one of 'beams' a 'from', a 'cavity' or an 'on', and leave its profile Gaussian");
  if (wanted.empty()) return beams;
  std::vector<std::string> names;
  for (BeamLaunch const& b : beams) names.push_back(b.name);
  std::erase_if(beams, [&](BeamLaunch const& b) { return b.name != wanted; });
  if (!beams.empty()) return beams;
  std::string const near = nearest_word(wanted, names);
  throw InputError(fmt::format("error: no beam '{}' is launched\n  {}", wanted,
                               near.empty() ? fmt::format("it is one of: {}", fmt::join(names, ", "))
                                            : fmt::format("did you mean '{}'?", near)));
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

void add_notes(GhostReport& report, MainBeam const& main, GhostFamilies const& families) {
  if (!main.complete())
    report.notes.push_back(fmt::format(
        "The main beam meets more than {} surfaces: what comes into line beyond them is not counted as recoupled.",
        MainBeam::most_nodes));
  if (families.left_out > 0)
    report.notes.push_back(
        fmt::format("{} ghosts beyond the first {} families are left out of the sums at the port; "
                    "their shares sum to {:.3g}.",
                    families.left_out, GhostFamilies::most, families.left_out_share));
  if (!report.has_port)
    report.notes.push_back("No port of this beam is open on its way, so there is no h: see 'ports'.");
  else if (!report.has_noise)
    report.notes.push_back("The scene has no 'interferometer', so there is no h.");
}

// Everything about one launched beam; `each` gets the rows of the export.
GhostReport report_of(Model const& model, BeamLaunch const& launch, Wanted const& wanted, std::size_t show,
                      std::function<void(GhostTable const&, Ghost const&)> const& each) {
  World const& world = model.world;
  GhostReport report;
  report.beam = launch.name;
  report.power = world.beam_power * world.footprints()[launch.footprint].share;
  report.limits = {wanted.floor, wanted.order, TreeLimits{}.longest};
  report.rank = rank_of(wanted.by);
  report.groups = world.groups();
  MainBeam const main(world, launch, report.limits);
  GhostFamilies families(world, main, ghost_port(world, launch, main));
  report.has_port = families.port().has_value();
  report.has_noise = report.has_port && model.detector;
  if (report.rank == GhostRank::strain && !report.has_noise)
    throw InputError(fmt::format(
        "error: --by strain needs h, and {}\n  open a port for the beam '{}' and give 'interferometer', or take --by "
        "recoupled",
        report.has_port ? "the scene has no 'interferometer'" : "no port of this beam is open on its way",
        launch.name));
  if (report.has_port) {
    report.port = world.ports()[families.port()->value];
    find_ghosts(world, launch, report.limits, main, [&](Ghost const& g) { families.add(g); });
    for (GhostFamily const& f : families.all()) {
      report.share += f.share();
      report.incoherent += f.incoherent;
      report.worst += f.worst();
    }
    report.families = families.all().size();
    if (report.has_noise) report.strain = project_ghosts(model, families);
  }
  GhostTable table(world, launch, families, report.rank, show);
  report.ledger = find_ghosts(world, launch, report.limits, main, [&](Ghost const& g) {
    table.add(g);
    if (each) each(table, g);
  });
  if (double const off = std::fabs(report.ledger.total() - 1); !(off < 1e-10))
    throw NumericalError(fmt::format("the ledger of the beam '{}' does not close: {:.3g}", launch.name, off));
  report.rows = table.rows();
  report.objects = table.objects(report.ledger);
  report.ghosts = table.ghosts;
  report.by_order = table.by_order;
  report.power_by_order = table.power_by_order;
  report.recoupled_with = table.recoupled_with;
  report.recoupled_against = table.recoupled_against;
  add_notes(report, main, families);
  return report;
}

int ghosts(Options const& options, Wanted const& wanted) {
  refuse_two_formats(options);
  Model const model = read_for_ghosts(options);
  if (!options.quiet) std::cerr << model.scene.warnings();
  std::vector<BeamLaunch> const beams = choose_beams(model, wanted.beam);
  bool const files = !options.out.empty();
  std::string csv, text;
  bool const watts = model.world.beam_power > 0;
  if (options.csv) std::cout << ghost_csv_header(watts);
  if (files) {
    make_folder(options.out);
    csv = ghost_csv_header(watts);
  }
  nlohmann::json all = nlohmann::json::array();
  for (BeamLaunch const& launch : beams) {
    double const power = model.world.beam_power * model.world.footprints()[launch.footprint].share;
    auto const each = [&](GhostTable const& table, Ghost const& g) {
      std::string const line =
          ghost_csv(launch.name, table.row(g), g.where.valid() ? model.world.groups()[g.where.value] : "", power);
      if (options.csv) std::cout << line;
      if (files) csv += line;
    };
    GhostReport const report =
        report_of(model, launch, wanted, options.show ? options.show : rows_shown,
                  options.csv || files ? std::function<void(GhostTable const&, Ghost const&)>(each) : nullptr);
    text += (text.empty() ? "" : "\n") + ghost_text(report, objects_shown);
    nlohmann::json entry = nlohmann::json::parse(ghost_json(report));
    if (files) entry["surfaces"] = outlines(model.world, report);
    all.push_back(std::move(entry));
  }
  if (files) {
    std::filesystem::path const folder = options.out;
    write_file(folder / "ghosts.csv", csv);
    write_file(folder / "ghosts.txt", text);
    write_file(folder / "ghosts.json", all.dump());
    std::string message;
    if (!draw_ghost_picture(folder / "ghosts.json", folder / "ghosts.png", message)) std::cerr << message << '\n';
  }
  if (options.csv) return done;
  if (options.json())
    std::cout << all.dump() << '\n';
  else
    std::cout << text;
  return done;
}

CLI::Validator number_above_zero() {
  return {[](std::string const& word) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(word, value) && value > 0 && value <= 1) return {};
            return fmt::format("'{}' is not a share of power from 0 to 1; write for example 1e-15", word);
          },
          ""};
}

CLI::Validator whole_number(double most, std::string const& example) {
  return {[=](std::string const& word) -> std::string {
            bool const digits = !word.empty() && word.find_first_not_of("0123456789") == word.npos;
            if (digits && word.size() < 10 && std::stod(word) >= 1 && std::stod(word) <= most) return {};
            return fmt::format("'{}' is not a whole number from 1 to {:g}; write for example {}", word, most, example);
          },
          ""};
}

}  // namespace

void add_ghosts(CLI::App& app, Options& options, int& exit_code) {
  auto* const command =
      app.add_subcommand("ghosts", "every ghost beam: order, power, where it ends, how much of it comes back");
  static Wanted wanted;
  add_scene_options(*command, options);
  command->add_option("--floor", wanted.floor, "least power that is followed, over the launched power; default 1e-15")
      ->check(number_above_zero());
  command->add_option("--order", wanted.order, "departures from the main beam, at most; default: no limit")
      ->check(whole_number(1e6, "2"));
  command->add_option("--by", wanted.by, "rank by power (default), strain or recoupled")
      ->check(CLI::IsMember({"power", "strain", "recoupled"}));
  command->add_option("--beam", wanted.beam, "only this beam; of a cavity: the mirror that it leaves through");
  command->add_option("--show", options.show, "rows; 20 unless given")->check(whole_number(1e6, "50"));
  command->add_flag("--csv", options.csv, "all ghosts, all digits, in the order in which they are found");
  command->add_option("-o,--out", options.out, "folder for ghosts.csv, ghosts.txt, ghosts.json and ghosts.png");
  command->footer(
      "Examples:\n"
      "  straytrace ghosts examples/bench.yaml --order 2\n"
      "  straytrace ghosts examples/bench.yaml --floor 1e-12 --by recoupled --show 50");
  command->callback([&] { exit_code = ghosts(options, wanted); });
}

}  // namespace straytrace
