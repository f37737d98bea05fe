// SPDX-License-Identifier: BSD-3-Clause
#include "session/light/ghost_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <span>

#include "base/errors.hpp"
#include "base/text/words.hpp"
#include "noise/wrapped/phase_spectra.hpp"
#include "results/curves/band.hpp"
#include "trace/tally/coupling_table.hpp"

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

namespace {

constexpr char const* apart_text =
    "ghosts of this route; the powers of routes add: their static phases are independent (docs/theory/ghosts.md, "
    "eq. 10.5)";
constexpr char const* rest_text =
    "the weaker ghosts of equal phase sensitivities, named by the strongest of them; powers are added: their static "
    "phases are independent (docs/theory/ghosts.md, eq. 10.5)";
constexpr char const* fields_text =
    "ghosts with equal phase sensitivities; their fields add with the phases of the drawn geometry "
    "(docs/theory/ghosts.md, eq. 10.5)";

// The imaginary part of a lever is phase, felt in the mean half of the path ago; its real part moves the amplitude.
void add_levers(PathRecord& record, std::vector<OverlapLever> const& levers) {
  for (OverlapLever const& lever : levers) {
    PhaseSensitivity amplitude{lever.body, {}}, phase{lever.body, {}};
    for (std::size_t i = 0; i < lever.d.size(); ++i) {
      amplitude.d[i] = lever.d[i].real();
      phase.d[i] = lever.d[i].imag();
      phase.moment[i] = phase.d[i] * std::max(0.0, record.path_length) / (2 * speed_of_light);
    }
    auto const moves = [](PhaseSensitivity const& s) {
      return std::ranges::any_of(s.d, [](double d) { return d != 0; });
    };
    if (moves(amplitude)) record.amplitude_levers.push_back(amplitude);
    if (moves(phase)) phase_sensitivity_of(record.phase_sensitivities, lever.body).add(phase, 1);
  }
  std::ranges::sort(record.phase_sensitivities, {}, [](PhaseSensitivity const& s) { return s.body.value; });
}

PathRecord record_of(GhostFamily const& f, double share, double path_length, std::vector<OverlapLever> const& levers) {
  PathRecord record;
  record.coupling = record.weight = share;
  record.path_length = path_length;
  record.phase_sensitivities = f.phase_sensitivities;
  add_levers(record, levers);
  return record;
}
PathRecord record_of(GhostFamily const& f) { return record_of(f, f.share(), f.path_length, f.levers); }

// Number of families, strongest first, that add as fields.
std::size_t coherent_of(std::span<GhostFamily const* const> by_share) {
  bool const fields = by_share.size() > 1 && by_share.front()->sum == GhostSum::coherent;
  return fields ? std::min(by_share.size(), most_coherent) : 0;
}

// Rotates the two states of polarisation so that the first holds as much as possible: the part common to both is one
// field with one phase. Sums over the states, and so the spectra, stay.
void to_principal_states(std::vector<PathRecord>& records) {
  double first = 0, second = 0;
  std::complex<double> both = 0;
  for (PathRecord const& r : records) {
    first += std::norm(r.field[0]);
    second += std::norm(r.field[1]);
    both += std::conj(r.field[0]) * r.field[1];
  }
  double const angle = std::atan2(2 * std::abs(both), first - second) / 2;
  std::complex<double> const turn = std::polar(1.0, -std::arg(both));
  for (PathRecord& r : records) {
    auto const [a, b] = r.field;
    r.field = {std::cos(angle) * a + std::sin(angle) * turn * b, std::cos(angle) * turn * b - std::sin(angle) * a};
    if (std::norm(r.field[1]) < 1e-24 * r.weight) r.field[1] = 0;  // rounding
  }
}

void sort_folded(CouplingClass& c) { std::ranges::stable_sort(c.folded, std::greater{}, &FoldedRoute::mean); }

// The routes of families whose fields add: a row cannot be divided into them. Those beyond the most of a family have
// no route here, and the statement says so.
void list_parts(CouplingClass& c, std::span<GhostFamily const* const> members) {
  for (GhostFamily const* f : members) {
    c.folded_routes += f->routes();
    for (GhostPart const& part : f->parts) {
      std::uint64_t const hash = deterministic_class(ClassKind::ghost, part.steps, c.port, 1, {}, "").hash;
      c.folded.push_back({hash, part.steps, part.reverse * part.share, 0, true, "added as a field"});
    }
  }
  sort_folded(c);
  std::uint64_t const unlisted = c.folded_routes - c.folded.size();
  if (unlisted > 0) c.statement += fmt::format("; {} of the weakest are not listed by route", unlisted);
}

// All of them as one route, named by the strongest; its parts are in `folded`.
CouplingClass family_class(std::span<GhostFamily const* const> members, PortId port) {
  std::vector<PathRecord> records;
  std::uint64_t ghosts = 0;
  for (GhostFamily const* f : members) {
    records.push_back(record_of(*f));
    records.back().field = f->field;
    ghosts += f->ghosts;
  }
  to_principal_states(records);
  CouplingClass c = deterministic_class(
      ClassKind::ghost, members.front()->steps, port, 1, std::move(records),
      fmt::format("coherent family: {} ghosts of {} different phase sensitivities, whose fields add with the phases of "
                  "the drawn geometry, averaged over their common phase (docs/theory/ghosts.md, eq. 10.5); the "
                  "coupling is the sum of powers",
                  ghosts, members.size()));
  c.hash = ~c.hash;  // of the strongest alone it is another route
  list_parts(c, members);
  return c;
}

// A class for each route of the family, and one for the rest; of a coherent one a single class.
std::vector<CouplingClass> classes_of(GhostFamily const& f, PortId port) {
  std::vector<CouplingClass> all;
  if (f.sum == GhostSum::coherent) {
    all.push_back(deterministic_class(ClassKind::ghost, f.steps, port, 1, {record_of(f)}, fields_text));
    GhostFamily const* const one = &f;
    if (f.routes() > 1) list_parts(all.back(), {&one, 1});
    return all;
  }
  for (GhostPart const& part : f.parts)
    all.push_back(deterministic_class(ClassKind::ghost, part.steps, port, part.reverse,
                                      {record_of(f, part.share, part.path_length, part.levers)}, apart_text));
  if (f.others == 0) return all;
  all.push_back(deterministic_class(ClassKind::ghost, f.rest.steps, port, 1,
                                    {record_of(f, f.rest.share, f.rest.path_length, f.rest.levers)}, rest_text));
  all.back().hash = ~all.back().hash;  // not the route of that name alone
  all.back().folded_routes = f.others;
  return all;
}

// Powers of two classes that share a name add.
void merge_into(CouplingClass& sum, CouplingClass const& c) {
  sum.records.insert(sum.records.end(), c.records.begin(), c.records.end());
  sum.coupling.mean += c.coupling.mean;
  sum.folded_routes += c.folded_routes;
  sum.folded.insert(sum.folded.end(), c.folded.begin(), c.folded.end());
  sort_folded(sum);
}

}  // namespace

std::optional<GhostSettings> read_ghosts(Scene const& scene) {
  Node const table = scene.root()["ghosts"];
  GhostSettings settings;
  if (table.kind() != Node::Kind::table)
    return scene.root().flag("ghosts", false) ? std::optional(settings) : std::nullopt;
  settings.floor = table.number("floor", dim::plain, settings.floor, 1e-40, 1);
  if (table.has("order")) settings.order = std::uint32_t(table.whole("order", 1, 0, 1e6));
  static constexpr std::array<std::string_view, 2> sums = {"independent", "coherent"};
  settings.sum = table.choice("sum", sums, "independent") == "coherent" ? GhostSum::coherent : GhostSum::independent;
  table.refuse_unknown("'ghosts'");
  return settings;
}

namespace {

// The face of a ghost of one reflection, which returns along its own way; nothing of another.
std::optional<GroupId> only_face(CouplingClass const& c) {
  std::vector<PathStep> const& steps = c.steps;
  if (c.records.size() != 1 || steps.size() % 2 == 0 || !std::equal(steps.begin(), steps.end(), steps.rbegin()))
    return {};
  auto const reflects = [](PathStep const& s) { return s.event == Event::reflect; };
  PathStep const& middle = steps[steps.size() / 2];
  return reflects(middle) && std::ranges::count_if(steps, reflects) == 1 ? std::optional(middle.group) : std::nullopt;
}

// Whether two ghosts move by opposite phases, to a hundredth of the wave number: of the same face, and their overlaps
// add phases of their own (eq. N.27).
bool move_oppositely(CouplingClass const& a, CouplingClass const& b, double wavelength) {
  std::map<std::uint32_t, std::array<double, 6>> sum;
  for (CouplingClass const* c : {&a, &b})
    for (PhaseSensitivity const& s : c->records.front().phase_sensitivities)
      for (std::size_t i = 0; i < 6; ++i) sum[s.body.value][i] += s.d[i];
  double const small = 1e-2 * 2 * pi / wavelength;
  return std::ranges::all_of(sum, [&](auto const& of_body) {
    return std::ranges::all_of(of_body.second, [&](double d) { return std::fabs(d) < small; });
  });
}

double beam_share(World const& world, PortId port) {
  return std::ranges::find(world.footprints(), port, &Footprint::port)->share;
}

// Ghosts of faces that both beams meet become one class each: its coupling is |sigma|^2 for the light of the first.
// Eq. N.20 holds for |sigma| of both sides alike; their mean is used where they differ by the losses on the way.
void join_faces(World const& world, World::FacePort const& face, GhostClasses& all) {
  constexpr double alike = 0.1;  // relative
  double const first = std::pow(beam_share(world, face.first), 2), second = std::pow(beam_share(world, face.second), 2);
  std::vector<std::string> unlike;
  for (std::size_t i = 0; i < all.classes.size(); ++i) {
    CouplingClass& a = all.classes[i];
    auto const group = a.port == face.first ? only_face(a) : std::nullopt;
    if (!group) continue;
    auto const back = std::ranges::find_if(all.classes, [&](CouplingClass const& b) {
      return b.port == face.second && only_face(b) == group && move_oppositely(a, b, world.wavelength);
    });
    if (back == all.classes.end()) continue;
    double const here = a.coupling.mean / first, behind = back->coupling.mean / second, mean = std::sqrt(here * behind);
    if (std::fabs(here - behind) > alike * mean) {
      unlike.push_back(world.groups()[group->value]);
      continue;
    }
    PathRecord record = a.records.front();
    record.coupling = record.weight = first * mean;
    a = deterministic_class(ClassKind::ghost, a.steps, face.port, 1, {record},
                            fmt::format("a face that returns the light of '{}' and of '{}' as one field "
                                        "(docs/theory/recoupling.md, eq. N.20); the coupling is that of the first",
                                        world.ports()[face.first.value], world.ports()[face.second.value]));
    if (back < all.classes.begin() + std::ptrdiff_t(i)) --i;
    all.classes.erase(back);
  }
  if (!unlike.empty())
    all.warnings.push_back(fmt::format(
        "ghosts of {}: the two sides return light that differs by more than {:g} %; their powers are added, although "
        "the fields belong together (docs/theory/recoupling.md, eq. N.20)",
        fmt::join(unlike, ", "), 100 * alike));
}

}  // namespace

GhostClasses ghosts_beside(World const& world, GhostSettings const& settings) {
  GhostClasses all;
  for (BeamLaunch const& launch : launches(world)) {
    if (launch.through_input_mirror()) continue;
    TreeLimits const limits = settings.limits(launch);
    MainBeam const main(world, launch, limits);
    GhostFamilies families(world, launch, main, ghost_port(world, launch, main), settings.sum);
    if (!families.port()) continue;
    find_ghosts(world, launch, limits, main, [&](Ghost const& g) { families.add(g); });
    GhostClasses made = ghost_classes(world, families);
    std::move(made.classes.begin(), made.classes.end(), std::back_inserter(all.classes));
    for (std::string const& warning : made.warnings)
      all.warnings.push_back(fmt::format("ghosts of the beam '{}': {}", launch.name, warning));
  }
  for (World::FacePort const& face : world.face_ports()) {
    join_faces(world, face, all);
    auto const family_at = [&](PortId port) {
      return std::ranges::any_of(all.classes,
                                 [&](CouplingClass const& c) { return c.port == port && c.adds_fields(); });
    };
    if (family_at(face.first) && family_at(face.second))
      all.warnings.push_back(fmt::format(
          "with 'sum: coherent' the fields of ghosts add within '{}' and within '{}'; the powers of both add, although "
          "faces that both beams meet return one field (docs/theory/recoupling.md, eq. N.20): 'sum: independent' has "
          "it",
          world.ports()[face.first.value], world.ports()[face.second.value]));
  }
  return all;
}

namespace {

// Of the families of one port, the strongest first.
void add_classes(std::vector<GhostFamily const*> const& by_share, PortId port, GhostClasses& all) {
  std::size_t const fields = coherent_of(by_share);
  double summed = 0;
  if (fields > 0) {
    all.classes.push_back(family_class(std::span(by_share).first(fields), port));
    summed = all.classes.back().coupling.mean;
  }
  std::map<std::uint64_t, CouplingClass> apart;  // by route: families that share a name share a row, powers added
  double left = 0;
  for (GhostFamily const* f : std::span(by_share).subspan(fields)) {
    left += f->share();
    for (CouplingClass const& made : classes_of(*f, port)) {
      auto const [at, added] = apart.try_emplace(made.hash, made);
      if (!added) merge_into(at->second, made);
    }
  }
  for (auto& [hash, c] : apart) all.classes.push_back(std::move(c));
  if (fields > 0 && !apart.empty())
    all.warnings.push_back(
        fmt::format("{} different phase sensitivities: the fields of the strongest {} add; the others, {:.2g} of "
                    "the light, add in power; raise 'floor' or lower 'order' to leave them out",
                    by_share.size(), fields, left / (left + summed)));
}

}  // namespace

GhostClasses ghost_classes(World const& world, GhostFamilies const& families) {
  std::map<std::uint32_t, std::vector<GhostFamily const*>> by_port;
  for (GhostFamily const& f : families.all())
    if (f.share() > 0) by_port[f.port.value].push_back(&f);
  GhostClasses all;
  for (auto& [port, list] : by_port) {
    std::stable_sort(list.begin(), list.end(), [](auto* a, auto* b) { return a->share() > b->share(); });
    add_classes(list, {port}, all);
  }
  double shares = 0;
  for (GhostFamily const& f : families.all()) shares += f.share();
  for (auto const& [surface, change] : families.rims_left_out)
    if (change > 1e-6 * shares)
      all.warnings.push_back(
          fmt::format("'{}' cuts ghosts and moves, but is not round, so that h lacks the change of their amplitude; "
                      "all that it takes of them is {:.2g} of the main mode at the port (docs/theory/ghosts.md, "
                      "eq. N.27)",
                      world.name_of({surface}), change));
  return all;
}

GhostStrain project_ghosts(Model const& model, GhostFamilies& families) {
  CouplingTable table;
  table.groups = model.world.groups();
  table.bodies = model.world.body_names();
  table.ports = model.world.ports();
  table.wavelength = model.world.wavelength;
  NoiseSettings settings = model.noise;
  settings.grid = logarithmic_grid(5, 200, 60);
  // The strain is linear in the share: each family once with a share of 1, whatever its fields sum to.
  for (std::size_t i = 0; i < families.all().size(); ++i) {
    GhostFamily const& f = families.all()[i];
    PathRecord const record = record_of(f, 1, f.path_length, f.levers);
    CouplingClass one = deterministic_class(ClassKind::ghost, f.steps, f.port, 1, {record}, "");
    one.hash = i;
    table.classes.push_back(std::move(one));
  }
  NoiseBudget const budget = project_noise(table, model.motion, *model.detector, settings);
  GhostStrain square{};
  for (std::size_t i = 0; i < families.all().size(); ++i)
    for (std::size_t k = 0; k < ghost_frequencies.size(); ++k) {
      GhostFamily& f = families.all()[i];
      f.per_root_power[k] = strain_at(budget.routes[i], budget.grid, ghost_frequencies[k]).value;
      square[k] += f.share() * f.per_root_power[k] * f.per_root_power[k];
    }
  GhostStrain all;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = std::sqrt(square[k]);
  table.classes = ghost_classes(model.world, families).classes;
  if (std::none_of(table.classes.begin(), table.classes.end(), [](auto& c) { return c.adds_fields(); })) return all;
  NoiseTrace const total = project_noise(table, model.motion, *model.detector, settings).total;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = strain_at(total, settings.grid, ghost_frequencies[k]).value;
  return all;
}

}  // namespace straytrace::session
