// SPDX-License-Identifier: BSD-3-Clause
#include "session/report_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "report/html/page_json.hpp"
#include "report/scene_drawing.hpp"
#include "results/text/columns.hpp"
#include "results/text/picture.hpp"
#include "session/build_info.hpp"
#include "session/decide/what_if.hpp"
#include "session/light/first_order.hpp"
#include "session/light/ghost_search.hpp"
#include "session/session.hpp"
#include "trace/camera/first_order.hpp"
#include "wave/arm/wave_record.hpp"
#include "wave/heights/height_map.hpp"

namespace straytrace::session {
namespace {

constexpr std::size_t routes_in_budget = 8, maps_shown = 8, what_if_rows = 12;
constexpr std::uint64_t light_histories = 1 << 14;  // traced again for irradiance and first-order lists

// Paths with their part of the noise of the band, of the rows that cause 99 % of it.
std::vector<NoisyPath> noisy_paths(CouplingTable const& coupling, PathTable const& table, SteeredWorld const& world) {
  constexpr std::size_t most_rows = 24, most_paths = 4096;
  auto const classes = by_hash(coupling.classes);
  std::vector<NoisyPath> all;
  double before = 0;
  for (PathRow const& row : table.rows) {
    if (!row.resolved || !(row.share.value > 0) || before > 0.99 || row.rank > most_rows) break;
    before += row.share.value;
    std::vector<DrawnPath> const paths = paths_of(world, coupling.seed, *classes.at(row.hash), most_paths);
    double sum = 0;
    for (DrawnPath const& p : paths) sum += p.weight;
    auto const at = std::find(coupling.bodies.begin(), coupling.bodies.end(), row.body);
    BodyId const body = at == coupling.bodies.end() ? BodyId{} : BodyId{std::uint32_t(at - coupling.bodies.begin())};
    for (DrawnPath const& p : paths) all.push_back({p, row.share.value * p.weight / sum, body});
  }
  return all;
}

// A port has as many lists as lit surfaces.
std::string seen_from(World const& world, Footprint const& lit) {
  std::string const name = lit.port.valid() ? world.ports()[lit.port.value] : "";
  if (!lit.surface.valid()) return name;
  return fmt::format("{}{}the light on {}", name, name.empty() ? "" : ", by ", world.name_of(lit.surface));
}

PageJson first_order_json(Model const& model, std::vector<FirstOrderList> const& lists) {
  World const& world = model.world;
  PageJson all = PageJson::array();
  auto const with_error = [](Estimate const& e) {
    return resolved(e) ? PageJson{{"value", number(e.mean)}, {"sigma", number(e.std_error)}} : PageJson(nullptr);
  };
  for (FirstOrderList const& list : lists) {
    Ending const& e = list.ending;
    PageJson rows = PageJson::array();
    for (FirstOrderRow const& r : list.rows)
      rows.push_back(
          {{"name", world.groups()[r.group.value]},
           {"power", with_error(r.power)},
           {"seen", with_error(r.throughput)},
           {"product", resolved(r.power) && resolved(r.throughput)
                           ? PageJson{{"value", number(r.product.mean)}, {"sigma", number(r.product.std_error)}}
                           : PageJson(nullptr)}});
    Footprint const* const port = e.port ? &world.footprints()[e.index] : nullptr;
    all.push_back({{"ending", port ? seen_from(world, *port) : world.receiver_names()[e.index]}, {"rows", rows}});
  }
  return all;
}

PageJson ghosts_json(std::vector<GhostReport> const& reports) {
  PageJson all = PageJson::array();
  for (GhostReport const& r : reports) {
    all.push_back(read_json(ghost_json(r)));
    all.back()["table"] = ghost_page_table(r);
  }
  return all;
}

PageJson scripts_json() {
  return {{"plots", "D3 5 (Mike Bostock), BSD-3-Clause, https://d3js.org"},
          {"scene", "three.js r111 (three.js authors), MIT, https://threejs.org"}};
}

PageJson scene_part(Model const& model, std::vector<DrawnPath> const& paths, std::vector<GhostReport> const& ghosts) {
  PageJson j = scene_json(scene_drawing(model.world));
  j["paths"] = paths_json(model.world, paths);
  j["lit"] = report::lit_json(model.world);
  j["ghosts"] = ghosts_json(ghosts);
  PageJson beams = PageJson::array();
  for (LightBeam const& beam : model.world.beams) beams.push_back(beam.name);
  j["beams"] = beams;
  return j;
}

PageJson maps_part(SteeredWorld const& world, RunContent const& run, PathTable const& table) {
  std::vector<SurfaceMap> maps = noise_maps(world, noisy_paths(run.trace->coupling, table, world), maps_shown);
  if (!maps.empty()) add_light(world, run.trace->coupling.seed, light_histories, maps);
  return maps_json(maps, run.beam_power);
}

// Eq. W.17 with the BSDF of each mirror.
PageJson wave_part(World const& world, WaveRecord const& record) {
  std::array<Vec3, 2> travel;
  for (Footprint const& f : world.footprints())
    for (std::size_t i : {0, 1})
      if (f.standing && f.beam == world.wave.beam && f.surface == world.wave.mirrors[i].surface) travel[i] = f.travel;
  return report::wave_json(record, [&](std::size_t i, double distance, double off_axis) {
    MirrorRecord const& m = record.mirrors[i];
    ArmMirror const mirror{world.wave.mirrors[i].surface, m.radius, m.curvature, m.spot};
    MirrorBrdf const brdf(world, mirror, travel[i]);
    return mean_irradiance(brdf, m.spot, m.curvature, distance, off_axis);
  });
}

}  // namespace

std::vector<std::string> const& report_pictures() {
  static std::vector<std::string> const all = {"budget", "scene", "maps", "wave", "ghosts", "materials", "convergence"};
  return all;
}

std::vector<std::string> read_pictures(Node const& report) {
  std::vector<std::string> wanted;
  for (Node const& word : report.list("pictures")) {
    wanted.push_back(word.as_word());
    if (word.kind() != Node::Kind::scalar || std::ranges::count(report_pictures(), wanted.back()) > 0) continue;
    std::string const near = nearest_word(wanted.back(), report_pictures());
    word.problem(fmt::format("a report does not have a picture '{}'", wanted.back()),
                 fmt::format("{}write some of: {}", near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                             fmt::join(report_pictures(), ", ")));
  }
  return wanted;
}

bool ReportWanted::has(std::string const& picture) const {
  return pictures.empty() || std::find(pictures.begin(), pictures.end(), picture) != pictures.end();
}

std::vector<DrawnPath> paths_of_rows(CouplingTable const& coupling, PathTable const& table, World const& world,
                                     TracedAgain const& traced, std::vector<GhostReport> const& ghosts,
                                     std::size_t rows, std::size_t paths) {
  auto const classes = by_hash(coupling.classes);
  std::vector<DrawnPath> all;
  auto const add = [&](CouplingClass const& c) {
    std::vector<DrawnPath> const some =
        c.deterministic() ? computed_paths(world, c, ghosts, paths) : paths_of(traced(), coupling.seed, c, paths);
    all.insert(all.end(), some.begin(), some.end());
  };
  for (std::size_t i = 0; i < std::min(rows, table.rows.size()); ++i)
    if (auto const c = classes.find(table.rows[i].hash); c != classes.end()) add(*c->second);
  std::vector<CouplingClass const*> received;
  for (CouplingClass const& c : coupling.received) received.push_back(&c);
  std::stable_sort(received.begin(), received.end(),
                   [](auto const* a, auto const* b) { return a->coupling.mean > b->coupling.mean; });
  for (std::size_t i = 0; i < std::min(rows, received.size()); ++i) add(*received[i]);
  return all;
}

std::vector<GhostReport> ghosts_for_page(Model const& model, std::size_t rows) {
  GhostSearch search{model, read_ghosts(model.scene).value_or(quick_search()), GhostRank::power, rows, nullptr, {}};
  std::vector<GhostReport> all;
  for (BeamLaunch const& launch : launches(model.world)) all.push_back(ghost_report(search, launch, {}));
  return all;
}

Picture budget_svg(std::string const& run_file, std::string const& measured, std::string& message) {
  return {"svg+xml", svg_of_run(run_file, message, measured)};
}

std::string report_page(RunContent const& run, PathTable const& table, Model const& model, TracedAgain const& traced,
                        ReportWanted const& wanted, Picture const& picture) {
  HtmlPage page;
  page.title = !wanted.title.empty() ? wanted.title : run.title.empty() ? "straytrace run" : run.title;
  StaticReport fixed;
  if (run.noise) {
    fixed.verdict = verdict_sentence(*run.noise, run.noise->grid.edges.front(), run.noise->grid.edges.back());
    if (std::string const seam = seam_sentence(run); !seam.empty()) fixed.verdict += " " + seam;
    fixed.headline = headline(*run.noise, table);
  }
  fixed.picture = picture;
  fixed.text = text_report(run, table, model.paths_shown, model.assumptions());
  page.body = static_head(fixed) + static_body(fixed, table);
  std::vector<GhostReport> const ghosts =
      wanted.has("ghosts") || wanted.has("scene") ? ghosts_for_page(model, ghosts_shown) : std::vector<GhostReport>{};
  PageJson& j = page.data;
  j["kind"] = "report";
  j["provenance"] = provenance_json(run);
  if (run.noise && wanted.has("budget")) {
    j["budget"] = budget_json(*run.noise, table, routes_in_budget);
    j["budget"]["measured"] = wanted.measured.empty() ? PageJson::array() : read_json(wanted.measured);
    j["what_if"] =
        what_if_json(what_if_terms(model, run.trace->coupling, *run.noise, table, what_if_rows), *run.noise, table);
  }
  j["table"] = table_json(table);
  if (wanted.has("scene"))
    j["scene"] = scene_part(
        model, paths_of_rows(run.trace->coupling, table, model.world, traced, ghosts, wanted.rows, wanted.paths),
        ghosts);
  if (wanted.has("maps")) j["maps"] = maps_part(traced(), run, table);
  if (run.waves && model.world.wave.present && wanted.has("wave")) j["wave"] = wave_part(model.world, *run.waves);
  j["receivers"] = receivers_json(run, model.world);
  if (wanted.has("ghosts")) j["ghosts"] = ghosts_json(ghosts);
  FirstOrderSettings settings;
  settings.seed = run.trace->coupling.seed;
  settings.histories = light_histories;
  j["first_order"] = first_order_json(model, first_order(model.world, settings));
  if (wanted.has("materials")) j["materials"] = materials_json(model.scene, model.world);
  j["assumptions"] = model.assumptions();
  j["inputs"] = inputs_json(run);
  j["energy_balance"] = energy_balance_json(run);
  if (wanted.has("convergence")) j["convergence"] = convergence_json(run, table);
  j["warnings"] = run.all_warnings();
  j["libraries"] = scripts_json();
  page.plots = page.scene = true;
  page.scripts = {"base.js",  "plot.js", "heat.js", "filter.js", "table.js",   "scene.js", "stage.js",
                  "light.js", "maps.js", "wave.js", "lists.js",  "what_if.js", "report.js"};
  return html_text(page);
}

std::string view_page(Model const& model, TracedAgain const& traced, RunContent const* run, PathTable const* table,
                      ViewWanted const& wanted) {
  HtmlPage page;
  std::string const own = model.scene.title();
  page.title = !wanted.title.empty() ? wanted.title : own.empty() ? "straytrace scene" : own;
  page.body =
      "<noscript><p>This page draws a scene in three dimensions and needs scripts. For a static picture: "
      "straytrace render SCENE</p></noscript>\n";
  std::vector<GhostReport> const ghosts = ghosts_for_page(model, ghosts_shown);
  std::vector<DrawnPath> paths;
  if (run && table)
    paths = paths_of_rows(run->trace->coupling, *table, model.world, traced, ghosts, wanted.rows, wanted.paths);
  PageJson& j = page.data;
  j["kind"] = "view";
  j["scene"] = scene_part(model, paths, ghosts);
  Box const box = scene_drawing(model.world, 1).box;
  std::vector<RaySegment> rays;
  if (wanted.rays > 0) rays = sample_rays(traced(), box, model.seed, wanted.rays);
  j["scene"]["rays"] = rays_json(model.world, rays);
  if (wanted.halo) j["scene"]["halo"] = halo_json(model.world, *model.arm, *model.waves);
  if (run && table) j["table"] = table_json(*table);
  j["version"] = fmt::format("{} ({})", build_info::version, build_info::commit);
  j["model"] = model.hash();
  j["libraries"] = scripts_json();
  page.scene = true;
  page.scripts = {"base.js", "filter.js", "table.js", "scene.js", "stage.js", "light.js", "halo.js", "view.js"};
  return html_text(page);
}

}  // namespace straytrace::session
