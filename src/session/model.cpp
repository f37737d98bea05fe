// SPDX-License-Identifier: BSD-3-Clause
#include "session/model.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "ifo/ports.hpp"
#include "noise/bands/speckle_band.hpp"
#include "noise/classes/delayed_paths.hpp"
#include "noise/project/static_phase.hpp"
#include "results/results.hpp"
#include "scene/scene_document.hpp"
#include "session/compare/model_diff.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/light/ghost_search.hpp"
#include "session/light/optical_network.hpp"
#include "session/optimise/order.hpp"
#include "session/records/time_inputs.hpp"
#include "session/report_page.hpp"
#include "wave/arm/arm_cavity.hpp"
#include "world/model/material.hpp"

namespace straytrace::session {
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
        until.problem(e.reason(), e.remedy());
      }
    t.refuse_unknown("'trace'");
  }
  model.histories_stated = model.histories > 0;
  if (!model.histories_stated) model.histories = model.until.by_error() ? no_limit : 1 << 20;
  model.world.block_size = block_size_of(model.histories);
}

void read_report(ProjectionModel& model) {
  Node const r = model.scene.table("report");
  if (!r) return;
  model.paths_shown = r.whole("paths", 12, 1, 1e6);
  read_pictures(r);
  r.refuse_unknown("'report'");
}

void read_noise(ProjectionModel& model, Scene const& scene) {
  Node const table = scene.table("noise");
  model.noise = read_noise_settings(table);
  model.design = read_design_curves(table, model.noise);
  if (table) table.refuse_unknown("'noise'");
  std::vector<StaticPhase> phases = model.noise.static_phases;
  if (model.noise.scanned) phases.push_back({model.noise.scanned->body});
  for (StaticPhase const& phase : phases)
    if (!model.motion.bodies.empty() && std::ranges::find(model.motion.bodies, phase.body) == model.motion.bodies.end())
      table["static_phase"][phase.body].problem(
          fmt::format("there is no body '{}'", phase.body),
          did_you_mean(phase.body, model.motion.bodies,
                       fmt::format("it is one of: {}", fmt::join(model.motion.bodies, ", "))));
}

// Light that a body scatters back moves with it and with the bodies on the way there: routes that a trace will find.
void check_static_phases(Model const& model) {
  World const& world = model.world;
  std::vector<StaticPhase> stated = model.noise.static_phases;
  if (model.noise.scanned) stated.push_back({model.noise.scanned->body});
  std::set<std::pair<std::string, std::string>> said;
  for (std::uint32_t i = 0; i < world.footprints().size(); ++i) {
    Footprint const& f = world.footprints()[i];
    if (!f.emits || !f.port.valid() || !f.surface.valid()) continue;
    std::set<BodyId> moved{world.surfaces()[f.surface.value].body};
    for (PhaseSensitivity const& s : world.feeds()[i].phase_sensitivities)
      if (std::ranges::any_of(s.d, [](double d) { return d != 0; })) moved.insert(s.body);
    StaticPhase const* by = nullptr;
    for (StaticPhase const& phase : stated) {
      auto const at = std::ranges::find(model.motion.bodies, phase.body) - model.motion.bodies.begin();
      if (!moved.contains(BodyId{std::uint32_t(at)})) continue;
      if (double const copies = model.detector ? model.detector->copies(f.port) : 1;
          !f.standing && copies != 1 && said.insert({phase.body, world.ports()[f.port.value]}).second)
        model.scene.table("noise")["static_phase"][phase.body].problem(
            fmt::format("it is that of one scatterer, and port '{}' of the light that '{}' scatters has {:g} equal "
                        "copies",
                        world.ports()[f.port.value], world.name_of(f.surface), copies),
            "write 'copies: 1' for this port in the interferometer, or 'arms: 1'");
      if (by && said.insert({by->body, phase.body}).second)
        model.scene.table("noise")["static_phase"][phase.body].problem(
            fmt::format("'{}' and '{}' both state the static phase of the light that '{}' scatters at port '{}'",
                        by->body, phase.body, world.name_of(f.surface), world.ports()[f.port.value]),
            "keep one of them");
      if (!by) by = &phase;
    }
  }
}

// Known only after a trace: routes over several bodies.
void check_static_phases(ProjectionModel const& model, CouplingTable const& coupling) {
  if (model.noise.static_phases.empty() && !model.noise.scanned) return;
  try {
    known_phases(coupling, model.motion, model.noise.static_phases, *model.detector);
    scanned_routes(coupling, model.motion, model.noise, *model.detector);
  } catch (InputError const& e) {
    Node const table = model.scene.table("noise")["static_phase"];
    if (!table) throw;  // stated in another file
    table.problem(e.reason(), e.remedy());
    model.scene.throw_if_problems();
  }
}

Band band_of(ProjectionModel const& model) {
  FrequencyGrid const& grid = model.noise.grid;
  return {grid.centre(0), grid.centre(grid.size() - 1)};
}

// By body: whether it has surfaces; an elastic mode has those of its body.
std::vector<bool> with_surfaces(World const& world) {
  std::vector<bool> has(world.bodies().size());
  for (Surface const& s : world.surfaces())
    if (s.body.valid()) has.at(s.body.value) = true;
  for (std::size_t b = 0; b < world.bodies().size(); ++b)
    for (ElasticMode const& mode : world.bodies()[b].modes) has.at(mode.id.value) = has[b];
  return has;
}

MotionSet read_bodies(Node const& bodies, ProjectionInputs const& traced, bool of_run) {
  return read_motion(bodies, traced.bodies, of_run, traced.meets_light);
}

std::vector<std::string> names_in(Node const& table) {
  std::vector<std::string> names;
  for (auto const& [name, node] : table.items()) names.push_back(name);
  return names;
}

void read_light(ProjectionModel& model) {
  std::vector<std::string> ports;
  for (TracedPort const& port : model.traced.ports) ports.push_back(port.name);
  model.motion.light = read_modulation(model.scene.table("beams"), model.scene.table("ports"), ports);
}

std::unique_ptr<Interferometer> read_detector(ProjectionModel const& model, Node const& table) {
  std::unique_ptr<Interferometer> detector =
      make_interferometer(table, model.traced.ports, model.traced.wavelength, band_of(model), model.traced.optics);
  check_entrances(table, model.traced.ports);
  return detector;
}

// Without a preset it is the one of the run, with other responses at some ports.
void replace_interferometer(ProjectionModel& model, Node const& table) {
  if (table.has("preset") || !table.has("responses")) {
    model.detector = read_detector(model, table);
  } else if (model.detector) {
    model.detector = with_responses(std::move(model.detector), table, model.traced.ports, band_of(model));
    table.refuse_unknown("interferometer with the responses of ports alone");
  } else {
    table.problem("the run has no interferometer whose responses could be replaced", "add a 'preset'");
  }
}

std::vector<MaterialSpread> material_spreads(World const& world) {
  std::vector<MaterialSpread> all;
  for (PlacedMaterial const& m : placed_materials(world))
    all.push_back(
        {m.name, m.spread.status, m.spread.low, m.spread.high, m.spread.factor, m.spread.of_reflection, m.groups});
  return all;
}

double scattered_share(World const& world, std::string const& material) {
  double share = not_a_number;
  for (MaterialInfo const& info : world.materials)
    if (info.name == material) share = scattered_share(world, info);
  return share;
}

// Which light is not counted, and which sources of materials have no status.
std::vector<std::string> limits_of(Scene const& scene, World const& world) {
  std::vector<std::string> lines;
  if (!world.edges.groups.empty())
    lines.push_back("diffraction at the inner edges of 'edges': routes of kind edge, upper bounds");
  if (world.wave.present && world.wave.ring) {
    lines.push_back(
        "the field of 'wave' gives losses and levers of its cavity, and no noise: it has three mirrors or more");
  } else if (world.wave.present) {
    lines.push_back(world.wave.groups.empty()
                        ? "light below the crossover angle of 'wave' is in the loss of the cavity"
                          " alone: the table names no 'baffles'"
                        : "diffraction at the inner edges of 'wave': routes of kind wave and speckle; "
                          "light that they scatter back: routes of kind halo");
    lines.push_back("the crossover angle of 'wave' was not varied: straytrace wave SCENE --seam");
  } else if (world.edges.groups.empty()) {
    lines.push_back("diffraction at inner edges is not counted: the scene has neither table 'edges' nor 'wave'");
  }
  if (counts_rims(scene)) lines.push_back("rims in the main beam: routes of kind rim, by the motion of their bodies");
  bool const ghosts = read_ghosts(scene).has_value();
  lines.push_back(ghosts                       ? "ghost beams: routes of kind ghost, by the beam tree"
                  : scene.root().has("ghosts") ? "ghost beams are not counted: the scene says 'ghosts: off'"
                                               : "ghost beams are not counted: the scene has no table 'ghosts'");
  if (ghosts)
    for (BeamLaunch const& launch : launches(world))
      if (launch.through_input_mirror())
        lines.push_back(
            fmt::format("ghosts behind '{}' are not counted: light from the splitter interferes there", launch.name));
  for (auto const& [name, material] : scene.table("materials").items())
    if (Node const source = material["source"]; source && !material.has("status"))
      lines.push_back(fmt::format("material {}: {}", name, source.as_word()));
  return lines;
}

// Facts of the traced world, before the tables of motion and interferometer are read.
ProjectionInputs bodies_and_ports(Scene const& scene, World const& world) {
  ProjectionInputs traced;
  traced.bodies = world.body_names();
  traced.meets_light = with_surfaces(world);
  traced.wavelength = world.wavelength;
  traced.ports = traced_ports(scene, world);
  traced.optics = drawn_optics(scene.table("interferometer"), world);
  return traced;
}

// The rest, of a model without problems.
void complete_inputs(Model& model) {
  ProjectionInputs& traced = model.traced;
  traced.optics = named_optics(model.scene.table("interferometer"), traced.optics);
  traced.materials = material_spreads(model.world);
  for (MaterialSpread const& m : traced.materials) traced.scattered.push_back(scattered_share(model.world, m.name));
  traced.notes = model.world.notes;
  traced.limits = limits_of(model.scene, model.world);
  traced.warnings = model.warnings = model.scene.warnings();
  traced.warnings_json = model.warnings_json = warnings_as_json(model.scene);
}

}  // namespace

Model read_model(std::string const& file, std::vector<std::string> const& overrides, FileTexts const* texts) {
  Model model;
  model.scene = read_scene(file, overrides, texts);
  model.world = build_lit_world(model.scene);
  model.traced = bodies_and_ports(model.scene, model.world);
  model.motion = read_bodies(model.scene.table("bodies"), model.traced, false);
  read_light(model);
  plan_waves(model);
  read_noise(model, model.scene);
  bool const noiseless = model.world.ports().empty() && model.scene.root().has("receivers") &&
                         !model.scene.root().has("interferometer") && !model.scene.root().has("ports");
  bool const without = !noiseless && !model.scene.root().has("interferometer");
  bool const ports = !model.scene.table("ports").items().empty();
  if (without && ports && !model.scene.root().data()->misspelt)  // otherwise 'interferometer' may be misspelt
    model.scene.root().problem(
        "the scene has ports but no 'interferometer' to convert their light to strain",
        "add 'interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, "
        "input_transmission: 1.4 %}', or count watts on 'receivers'");
  else if (!without && !noiseless)
    model.detector = read_detector(model, model.scene.table("interferometer"));
  if (model.detector) {
    refuse_input_mirrors(model.scene, model.world);
    check_network_beams(model.scene, *model.detector);
  }
  if (model.detector && model.motion.inputs.empty() && model.motion.light.tones.empty() && model.scene.table("bodies"))
    model.scene.table("bodies").warning("no body moves, so there is no noise", "give a body a 'motion'");
  read_orders(model);
  read_report(model);
  read_sensors(model.scene, names_in(model.scene.table("ports")), names_in(model.scene.table("receivers")));
  read_ghosts(model.scene);
  counts_rims(model.scene);
  read_order(model.scene);
  warn_of_ghosts_left_out(model.scene, model.world);
  if (Node const table = model.scene.root()["scan"])
    table.problem("a model does not take a table 'scan'",
                  "name parameters on the command line: straytrace scan MODEL NAME=lo..hi:n");
  model.scene.throw_if_problems();
  if (model.detector) check_rims(model.scene, model.world, *model.detector);
  check_static_phases(model);
  model.scene.throw_if_problems();
  if (model.world.wave.present && !model.world.wave.ring) begin_rays_at_crossover(model.world);
  warn_of_gaps(model.motion, model.noise, model.scene.table("bodies"), model.world.wavelength);
  warn_of_other_detector(model, model.scene.table("noise")["compare"]);
  warn_of_uncounted_ghosts(model);
  complete_inputs(model);
  return model;
}

ProjectionModel read_projection_model(std::string const& file, std::vector<std::string> const& overrides,
                                      FileTexts const& texts, ProjectionInputs const& traced) {
  ProjectionModel model;
  model.scene = read_scene(file, overrides, &texts);
  model.traced = traced;
  model.motion = read_bodies(model.scene.table("bodies"), traced, false);
  read_light(model);
  read_noise(model, model.scene);
  if (Node const table = model.scene.table("interferometer")) model.detector = read_detector(model, table);
  read_report(model);
  model.scene.throw_if_problems();
  model.warnings = traced.warnings;
  model.warnings_json = traced.warnings_json;
  return model;
}

MotionSet read_motion_file(Scene const& scene) {
  constexpr double usual_wavelength = 1064e-9;  // m
  Node const bodies = scene.table("bodies"), noise = scene.table("noise");
  for (auto const& [name, node] : bodies.items())
    if (node.kind() == Node::Kind::table) node.has("pivot");
  MotionSet motion = read_motion(bodies, bodies_and_modes(bodies));
  ProjectionModel settings;
  read_noise(settings, scene);
  scene.throw_if_problems();
  warn_of_gaps(motion, settings.noise, bodies, usual_wavelength);
  return motion;
}

void warn_of_gaps(MotionSet const& motion, NoiseSettings const& noise, Node const& table, double wavelength) {
  Band const band{noise.grid.edges.front(), noise.grid.edges.back()};
  for (Problem& p : warnings_of_gaps(motion.files, band, wavelength)) {
    if (p.place.line == 0) p.place = table.place();
    table.document()->add(std::move(p));
  }
}

void replace_motion(ProjectionModel& model, std::string const& file, FileTexts const* texts, FileTexts* read,
                    bool responses) {
  Scene const other = read_scene(file, {}, texts);
  Node const bodies = other.table("bodies"), noise = other.table("noise");
  if (bodies) {
    LightModulation light = std::move(model.motion.light);  // of the beams, which stay
    model.motion = read_bodies(bodies, model.traced, true);
    model.motion.light = std::move(light);
  }
  if (noise) read_noise(model, other);
  Node const interferometer = other.table("interferometer");
  if (interferometer)
    replace_interferometer(model, interferometer);
  else if (noise && model.detector)  // its files must cover the new band too
    model.detector = read_detector(model, model.scene.table("interferometer"));
  if (responses && !(interferometer && interferometer.has("responses")))
    other.root().problem("this file contains no responses", "write 'interferometer: {responses: {PORT: {...}}}'");
  else if (responses && (bodies || noise))
    (bodies ? bodies : noise)
        .problem("a file of responses must not contain other tables",
                 "give 'bodies' and 'noise' in the file of --motion");
  else if (!bodies && !interferometer && !noise && other.root().healthy())
    other.root().problem("this file replaces nothing", "give 'bodies' (also 'interferometer', 'noise')");
  other.throw_if_problems();
  model.scene.throw_if_problems();
  if (!bodies)  // the files stand in another scene
    for (MotionFile& measured : model.motion.files) measured.place = {};
  if (noise || interferometer) warn_of_other_detector(model, noise ? noise["compare"] : interferometer);
  if (bodies || noise) warn_of_gaps(model.motion, model.noise, bodies ? bodies : noise, model.traced.wavelength);
  model.warnings = (bodies ? "" : model.warnings) + other.warnings();
  model.warnings_json = (bodies ? "" : model.warnings_json) + warnings_as_json(other);
  if (!read) return;
  for (auto const& [name, text] : other.files())
    if (auto const [at, added] = read->emplace(name, text); !added && at->second != text)
      throw InputError(fmt::format("the run already contains a different file '{}'", name), "rename the new file");
}

std::string Model::hash() const {
  std::vector<std::string> parts{world.fingerprint()};
  if (arm && !arm->rims.empty()) std::ranges::move(wave_inputs(*this), std::back_inserter(parts));  // paths start in it
  return model_hash(parts);
}

NoiseBudget ProjectionModel::project(CouplingTable const& coupling) const {
  if (!detector)
    throw InputError(
        "without an interferometer there is no noise to project",
        "add 'ports' and 'interferometer' to the scene, or look at the receivers: straytrace paths RUN --by receiver");
  check_static_phases(*this, coupling);
  NoiseBudget budget = project_noise(coupling, motion, *detector, noise);
  if (!noise.delay)
    if (DelayEffect const e = delay_effect(coupling, motion, *detector, budget); e.matters())
      budget.warnings.push_back(fmt::format(
          "light meets the bodies of a path at different times, which is neglected: it changes h by a factor {:.3g} at "
          "{:.4g} Hz, to first order in the motion; 'delay: yes' in 'noise' includes it (docs/theory/time_domain.md, "
          "eq. N.29)",
          e.factor, e.hz));
  budget.design = design;
  budget.margin = noise.margin;
  return budget;
}

NoiseBudget ProjectionModel::project_with_bands(CouplingTable const& coupling) const {
  NoiseBudget budget = project(coupling);
  ModulatedLight const light(coupling, motion);
  add_input_band(budget, light.table(), light.motion(), *detector, noise, traced.materials);
  if (!noise.static_phases.empty()) return budget;
  if (!noise.delay) {
    add_speckle_band(budget, light.table(), light.motion(), *detector);
  } else {
    DelayedPaths const late = with_delays(light.table(), light.motion(), noise.grid.edges.back());
    add_speckle_band(budget, late.table, late.motion, *detector);
  }
  return budget;
}

std::vector<std::string> ProjectionModel::assumptions() const {
  std::vector<std::string> lines = traced.notes;
  if (detector) {
    lines.push_back("frozen geometry: paths do not move while the surfaces shake (docs/theory/phase.md, eq. 2.6)");
    if (noise.delay)
      lines.push_back("delays: light meets each body before it rejoins (docs/theory/time_domain.md, eq. N.29)");
    lines.push_back("scalar light; each route with a diffuse vertex has an independent random static phase");
    if (noise.scanned)
      lines.push_back(
          fmt::format("mean over {} positions of '{}', a quarter of the wavelength: the routes that it moves as of one "
                      "point-like scatterer each",
                      noise.scanned->count, noise.scanned->body));
    for (StaticPhase const& s : noise.static_phases)
      lines.push_back(
          fmt::format("static phase of routes that '{}' moves: {:g} deg, as of one point-like scatterer each; "
                      "no speckle band",
                      s.body, s.phase * 180 / pi));
  }
  lines.insert(lines.end(), traced.limits.begin(), traced.limits.end());
  return lines;
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<char const*, 11> form_names{"named",  "number", "whole", "amplitude", "quantity", "word",
                                                 "choice", "switch", "table", "list",      "numbers"};

Json asked_as_json(KeyRequest const& how, bool by_key) {
  Json out;
  auto const form = std::size_t(how.form);
  out["type"] = form_names[form];
  bool const number = form >= std::size_t(KeyRequest::Form::number) && form <= std::size_t(KeyRequest::Form::quantity);
  if (number || how.form == KeyRequest::Form::numbers) {
    out["dimension"] = how.form == KeyRequest::Form::quantity ? "any" : name_of(how.dimension);
    out["units"] = how.form == KeyRequest::Form::quantity ? "" : accepted_units(how.dimension);
    out["unit"] = example_unit(how.dimension);
  }
  if (std::isfinite(how.low)) out["low"] = how.low;
  if (std::isfinite(how.high)) out["high"] = how.high;
  if (number && std::isfinite(how.fallback)) out["default"] = how.fallback;
  if (!how.word.empty()) out["default"] = how.word;
  if (how.count > 0) out["count"] = how.count;
  if (!how.choices.empty()) out["choices"] = how.choices;
  if (!how.doc.empty()) out["doc"] = how.doc;
  bool const one = (how.form == KeyRequest::Form::word || how.form == KeyRequest::Form::choice) && how.word.empty();
  if (by_key && (one || how.form == KeyRequest::Form::amplitude || (number && std::isnan(how.fallback))))
    out["required"] = true;
  return out;
}

Json value_as_json(ModelValue const& v) {
  Json out;
  if (!v.key.empty()) out["key"] = v.key;
  if (v.given())
    out["from"] = v.origin;
  else
    out["from"] = "default";
  if (v.kind == Node::Kind::scalar && v.written != v.value) out["written"] = v.written;
  if (v.kind == Node::Kind::scalar || !v.value.empty()) out["value"] = v.value;
  if (v.quantity && std::isfinite(v.quantity->si)) out["si"] = v.quantity->si;
  out["asked"] = asked_as_json(v.how, v.by_key);
  if (!v.role.empty()) out["role"] = v.role;
  if (v.listed) out["names"] = true;
  if (v.kind != Node::Kind::table && v.kind != Node::Kind::list) return out;
  Json& children = out[v.kind == Node::Kind::table ? "keys" : "elements"] = Json::array();
  for (ModelValue const& c : v.children) children.push_back(value_as_json(c));
  return out;
}

}  // namespace

Json model_as_json(Scene const& scene) {
  Json out{{"file", scene.main_file()}, {"model", value_as_json(model_tree(scene))}};
  Json& placed = out["placed"] = Json::array();
  std::set<std::string> told;
  for (PlacedValue const& p : placed_values(scene)) {
    if (!told.insert(p.group).second) continue;
    placed.push_back({{"group", p.group}, {"first", p.name}, {"face", value_as_json(p.face)}});
  }
  return out;
}

}  // namespace straytrace::session
