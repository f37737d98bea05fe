// SPDX-License-Identifier: BSD-3-Clause
#include "app/model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "app/ghost_noise.hpp"
#include "base/message.hpp"
#include "report/report.hpp"
#include "world/beam_tree.hpp"

namespace straytrace {
namespace {

constexpr double most_histories = 1e12;

void read_orders(Model& model) {
  Node const t = model.scene.table("trace");
  if (t) {
    model.seed = t.whole("seed", 1, 0, 9e15);
    model.histories = t.whole("histories", 0, 0, most_histories);
    if (Node const until = t["until"]) try {
        model.until = parse_stop_rule(until.as_word());
        if (auto const complaint = complaint_about(model.until, model); complaint && until.healthy())
          until.problem(complaint->what, complaint->suggestion);
      } catch (InputError const& e) {
        until.problem(e.what(), "write for example until: \"h_total < 5 %\"");
      }
    t.refuse_unknown("'trace'");
  }
  model.histories_stated = model.histories > 0;
  if (!model.histories_stated) model.histories = model.until.by_error() ? no_limit : 1 << 20;
  if (Node const r = model.scene.table("report")) {
    model.paths_shown = r.whole("paths", 12, 1, 1e6);
    r.refuse_unknown("'report'");
  }
}

void read_noise(Model& model, Scene const& scene) {
  Node const table = scene.table("noise");
  model.noise = read_noise_settings(table);
  model.design = read_design_curves(table, model.noise);
  if (table) table.refuse_unknown("'noise'");
}

// Light that `lit` followed through a mirror of a cavity has passed it in its coupling already, twice; the places
// behind that mirror would count the transmission again (physics.md eq. 9.3).
void check_entrances(Scene const& scene, World const& world) {
  Node const ports = scene.table("interferometer").table("ports");
  if (!ports) return;
  for (std::size_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.port.valid() || world.feeds()[i].mirror == Feed::none) continue;
    Node const entry = ports[world.ports()[f.port.value]];
    if (!entry || !entry.has("at")) continue;
    std::string const at = entry.word("at");
    if (at == "end-bench" || at == "short-arm")
      return entry["at"].problem("'lit' has followed this light through the mirror: its transmission would count twice",
                                 "leave 'at' out: couplings of the port are relative to the light in the arm");
  }
}

// Behind the input mirror the light of the arm interferes with the light that the splitter sends, which `lit` does not
// follow: on resonance a quarter of what the mirror passes stands there (physics.md eq. 9.5).
void refuse_input_mirrors(Scene const& scene, World const& world) {
  auto const beams = scene.table("beams").items();
  auto const name = [&](Footprint const& f) { return world.groups()[world.surfaces()[f.surface.value].group.value]; };
  for (BeamLaunch const& launch : launches(world)) {
    if (!launch.through_input_mirror() || launch.beam >= beams.size()) continue;
    std::set<std::string> lit;
    for (std::size_t i = 0; i < world.footprints().size(); ++i)
      if (world.feeds()[i].mirror == launch.footprint) lit.insert('"' + name(world.footprints()[i]) + '"');
    if (lit.empty()) continue;
    beams[launch.beam].second["lit"].problem(
        fmt::format("{} lit through '{}', which passes {:.2g} of the light: the light that the splitter sends "
                    "interferes there and is not followed",
                    lit.size() == 1 ? *lit.begin() + " is" : fmt::format("{} surfaces are", lit.size()), launch.name,
                    launch.passes),
        fmt::format(
            "write 'lit: {{except: [{}]}}', or name what stands behind the end mirror by 'only'; light the "
            "splitter side, in a scene of its own, by a beam 'from' behind '{}', with 'at: short-arm' for its port",
            fmt::join(lit, ", "), launch.name));
  }
}

void warn_of_ghosts_left_out(Scene const& scene, World const& world) {
  Node const table = scene.table("ghosts");
  BeamSink nobody;
  for (BeamLaunch const& launch : launches(world)) {
    if (!table || !launch.through_input_mirror() || grow_tree(world, launch, {0, 0, 1}, nobody).spots < 2) continue;
    table.warning(
        fmt::format("ghosts behind '{}' are not counted: light from the splitter interferes there", launch.name),
        fmt::format("for these write a scene of the splitter side: a beam 'from' behind '{}', with 'at: short-arm' for "
                    "its port",
                    launch.name));
  }
}

}  // namespace

Model read_model(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts) {
  Model model;
  model.scene = read_scene(file, overrides, texts);
  model.world = build_world(model.scene);
  model.motion = read_motion(model.scene.table("bodies"), model.world.body_names());
  bool const noiseless = model.world.ports().empty() && model.scene.root().has("receivers") &&
                         !model.scene.root().has("interferometer") && !model.scene.root().has("ports");
  bool const without = !noiseless && !model.scene.root().has("interferometer");
  if (without)
    model.scene.root().problem(
        "there is no 'interferometer' that turns light at the ports into strain",
        "add 'interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, "
        "input_transmission: 1.4 %}', or count watts on 'receivers'");
  else if (!noiseless)
    model.detector = make_interferometer(model.scene.table("interferometer"), model.world.ports(),
                                         model.world.wavelength, model.world.beam_power);
  check_entrances(model.scene, model.world);
  if (model.detector) refuse_input_mirrors(model.scene, model.world);
  if (model.detector && model.motion.inputs.empty() && model.scene.table("bodies"))
    model.scene.table("bodies").warning("no body moves, so no route makes noise", "give a body a 'motion'");
  read_noise(model, model.scene);
  read_orders(model);
  read_ghosts(model.scene);
  warn_of_ghosts_left_out(model.scene, model.world);
  if (Node const table = model.scene.root()["scan"]) table.problem("this version has no 'scan'", "leave it out");
  model.scene.throw_if_problems();
  return model;
}

void replace_motion(Model& model, std::string const& file, FileTexts const* texts, FileTexts* read) {
  Scene const other = read_scene(file, {}, texts);
  if (Node const bodies = other.table("bodies")) {
    std::vector<std::string> const known = model.world.body_names();
    for (auto const& [name, node] : bodies.items()) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      std::string const near = nearest_word(name, known);
      node.problem(fmt::format("the run has no body '{}'", name),
                   near.empty() ? fmt::format("its bodies: {}", fmt::join(known, ", "))
                                : fmt::format("did you mean '{}'?", near));
    }
    model.motion = read_motion(bodies, known);
  }
  if (Node const table = other.table("interferometer"))
    model.detector = make_interferometer(table, model.world.ports(), model.world.wavelength, model.world.beam_power);
  if (other.table("noise")) read_noise(model, other);
  if (!other.table("bodies") && !other.table("interferometer") && !other.table("noise"))
    other.root().problem("this file replaces nothing", "give 'bodies' (also 'interferometer', 'noise')");
  other.throw_if_problems();
  if (!read) return;
  for (auto const& [name, text] : other.files())
    if (auto const [at, added] = read->emplace(name, text); !added && at->second != text)
      throw InputError(
          fmt::format("error: the run already holds a file '{}' with other content\n"
                      "  give the file of the new motion another name",
                      name));
}

std::string Model::hash() const {
  std::string const parts[] = {world.fingerprint()};
  return model_hash(parts);
}

NoiseBudget Model::project(CouplingTable const& coupling) const {
  if (!detector)
    throw InputError(
        "error: without an interferometer there is no noise to project\n  add 'ports' and 'interferometer' to the "
        "scene, or look at the receivers: straytrace paths RUN --by receiver");
  NoiseBudget budget = project_noise(coupling, motion, *detector, noise);
  budget.design = design;
  budget.margin = noise.margin;
  return budget;
}

std::vector<std::string> Model::assumptions() const {
  std::vector<std::string> lines = world.notes;
  if (detector) lines.push_back("frozen geometry: paths do not move while the surfaces shake (physics.md eq. 2.6)");
  if (detector)
    lines.push_back("scalar light; each route with a diffuse vertex has an independent random static phase");
  lines.push_back(world.edges.groups.empty() ? "diffraction at rims is not counted: the scene has no table 'edges'"
                                             : "diffraction at the rims of 'edges': routes of kind edge, upper bounds");
  lines.push_back(scene.root().has("ghosts") ? "ghost beams: routes of kind ghost, by the beam tree"
                                             : "ghost beams are not counted: the scene has no table 'ghosts'");
  if (scene.root().has("ghosts"))
    for (BeamLaunch const& launch : launches(world))
      if (launch.through_input_mirror())
        lines.push_back(
            fmt::format("ghosts behind '{}' are not counted: light from the splitter interferes there", launch.name));
  for (auto const& [name, material] : scene.table("materials").items())
    if (Node const source = material["source"]) lines.push_back(fmt::format("material {}: {}", name, source.as_word()));
  return lines;
}

}  // namespace straytrace
