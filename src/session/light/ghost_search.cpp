// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/ghost_search.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "session/light/ghost_noise.hpp"

namespace straytrace::session {
namespace {

// Why ghosts of a beam have no h; empty if they can have one.
std::string no_strain(Model const& model, BeamLaunch const& launch, std::optional<PortId> port) {
  if (launch.through_input_mirror())
    return fmt::format(
        "Light from the splitter interferes behind '{}', which passes {:.2g}: its ghosts have no share at a port and "
        "no h. With 'lit' for its beam and an interferometer whose network is solved, they are those of the network.",
        launch.name, launch.passes);
  if (!port) return "This beam meets no port, so there is no h: see 'ports'.";
  if (!model.detector) return "The scene has no 'interferometer', so there is no h.";
  return {};
}

std::optional<PortId> port_of(World const& world, BeamLaunch const& launch, MainBeam const& main) {
  if (launch.through_input_mirror()) return {};
  return ghost_port(world, launch, main);
}

void warn_of_floor(GhostReport& report) {
  double const left = report.energy_balance.floor * report.passes,
               found = report.recoupled_with + report.recoupled_against;
  if (left <= found) return;
  report.warnings.push_back(fmt::format(
      "{:.2g} of the light below the floor could recouple, more than the {:.2g} found: lower 'floor'", left, found));
}

void add_notes(GhostReport& report, World const& world, MainBeam const& main, GhostFamilies const& families,
               std::string const& no_h) {
  if (!main.complete())
    report.notes.push_back(fmt::format(
        "The main beam meets more than {} surfaces: ghosts that align beyond them do not count as recoupled.",
        MainBeam::most_nodes));
  if (families.left_out > 0)
    report.notes.push_back(
        fmt::format("{} beyond the first {} families {} left out of the sums at the port; "
                    "their shares sum to {:.3g}.",
                    counted(families.left_out, "ghost"), GhostFamilies::most, families.left_out == 1 ? "is" : "are",
                    families.left_out_share));
  for (World::FacePort const& face : world.face_ports())
    if (families.port() == face.first || families.port() == face.second)
      report.notes.push_back(
          fmt::format("Faces that '{}' and '{}' meet return one field; h here is that of one side, a run has both (eq. "
                      "N.20).",
                      world.ports()[face.first.value], world.ports()[face.second.value]));
  if (!no_h.empty()) report.notes.push_back(no_h);
}

constexpr std::uint64_t between_looks = 4096;  // beams

class Counter {
 public:
  Counter(GhostSearch const& search, BeamLaunch const& launch, char const* doing)
      : search_(search), launch_(launch), doing_(doing) {}
  void operator()() {
    if (++ended_ % between_looks == 0 && search_.progress) search_.progress(launch_, ended_, doing_);
  }

 private:
  GhostSearch const& search_;
  BeamLaunch const& launch_;
  char const* doing_;
  std::uint64_t ended_ = 0;
};

void sum_families(GhostSearch const& search, GhostFamilies& families, GhostReport& report) {
  for (GhostFamily const& f : families.all()) {
    report.share += f.share();
    report.coherent += f.coherent();
    report.incoherent += f.incoherent;
    report.worst += f.worst();
  }
  report.families = families.all().size();
  report.warnings = ghost_classes(search.model.world, families).warnings;
  if (report.has_noise && report.families > 0) report.strain = project_ghosts(search.model, families);
}

GhostReport begun(GhostSearch const& search, BeamLaunch const& launch) {
  World const& world = search.model.world;
  GhostReport report;
  report.beam = launch.name;
  report.power = world.beam_power * world.footprints()[launch.footprint].share;
  report.passes = launch.passes;
  report.floor = search.settings.floor;
  report.sum = search.settings.sum;
  report.limits = search.settings.limits(launch);
  report.limits.stop = search.stop;
  report.rank = search.rank;
  report.groups = world.groups();
  report.bodies = world.body_names();
  return report;
}

}  // namespace

GhostReport ghost_report(GhostSearch const& search, BeamLaunch const& launch,
                         std::function<void(GhostTable const&, Ghost const&)> const& each) {
  World const& world = search.model.world;
  GhostReport report = begun(search, launch);
  MainBeam const main(world, launch, report.limits);
  GhostFamilies families(world, launch, main, port_of(world, launch, main), search.settings.sum);
  std::string no_h = no_strain(search.model, launch, families.port());
  report.has_port = families.port().has_value();
  report.has_noise = no_h.empty();
  if (report.has_port) {
    report.port = world.ports()[families.port()->value];
    Counter count(search, launch, "families");
    BeamEnergyBalance const first = find_ghosts(world, launch, report.limits, main, [&](Ghost const& g) {
      families.add(g);
      count();
    });
    if (first.stopped > 0) {  // the table is of the same beams
      report.limits.beams = first.beams;
      report.limits.stop = nullptr;
    }
    sum_families(search, families, report);
  }
  if (report.rank == GhostRank::strain && report.families == 0) {
    report.rank = GhostRank::power;
    if (no_h.empty()) no_h = "No ghost has an h.";
    no_h += " Rows are ranked by power.";
  }
  GhostTable table(world, launch, families, report.rank, search.show);
  Counter count(search, launch, "table");
  report.energy_balance = find_ghosts(world, launch, report.limits, main, [&](Ghost const& g) {
    table.add(g);
    if (each) each(table, g);
    count();
  });
  if (double const off = std::fabs(report.energy_balance.total() - 1); !(off < 1e-10))
    throw NumericalError(fmt::format("the energy balance of the beam '{}' is violated: {:.3g}", launch.name, off));
  table.fill(report);
  add_notes(report, world, main, families, no_h);
  warn_of_floor(report);
  return report;
}

void require_strain(GhostSearch const& search, std::vector<BeamLaunch> const& beams) {
  std::string reasons;
  for (BeamLaunch const& launch : beams) {
    MainBeam const main(search.model.world, launch, search.settings.limits(launch));
    std::string const no_h = no_strain(search.model, launch, port_of(search.model.world, launch, main));
    if (no_h.empty()) return;
    reasons += fmt::format("\n  beam '{}': {}", launch.name, no_h);
  }
  throw InputError("--by strain needs h, but no ghost has one", "use --by recoupled" + reasons);
}

namespace {

std::string power_of(GhostReport const& r) {
  double const share = std::accumulate(r.power_by_order.begin() + 1, r.power_by_order.end(), 0.0);
  return r.power > 0 ? fmt::format("{:.2g} W", share * r.power) : fmt::format("{:.2g} of the launched light", share);
}

std::string strain_of(GhostReport const& r) {
  double const h = r.strain[0];
  return h > 0 ? fmt::format(", which makes h({:g} Hz) = {:.2g} /sqrt(Hz)", ghost_frequencies[0], h) : "";
}

}  // namespace

void warn_of_uncounted_ghosts(Model const& model) {
  if (!model.detector || model.scene.root().has("ghosts")) return;
  GhostSearch const search{model, quick_search(), GhostRank::power, 1, nullptr, {}};
  auto const beams = model.scene.table("beams").items();
  for (BeamLaunch const& launch : launches(model.world)) {
    if (launch.through_input_mirror()) continue;
    GhostReport const r = ghost_report(search, launch, {});
    if (!(r.share > 0)) continue;
    beams.at(model.world.beams[launch.beam].entry)
        .second.warning(
            fmt::format("ghost beams are not counted: to order {} they take {} of '{}', and bring {:.2g} of the main "
                        "mode back to port '{}'{}",
                        r.limits.order, power_of(r), r.beam, r.share, r.port, strain_of(r)),
            "add 'ghosts: {order: 2}' to count them, or 'ghosts: off' where you know that they do not matter; "
            "straytrace ghosts lists them");
  }
}

}  // namespace straytrace::session
