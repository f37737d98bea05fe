// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/errors.hpp"
#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "base/units/quantity.hpp"
#include "cli/wave/wave_output.hpp"
#include "results/text/columns.hpp"
#include "session/scan/scan_points.hpp"

namespace straytrace::cli {
namespace {

constexpr double rounding = 1e-12;  // of the power; smaller shares are rounding

std::string share_text(double share, double scale = 1) {
  return share > rounding ? fmt::format("{:.4g}", share * scale) : fmt::format("below {:.4g}", rounding * scale);
}

// Of the eigenvalues of both directions, relative.
double mismatch_of(RingWaves const& waves) { return std::abs(waves.levers.eigenvalue / waves.mode.eigenvalue - 1.0); }

// Phase of a mode over that of the fundamental one by the ray matrix of the cavity, -0.5 to 0.5 turns.
double expected_phase(RingCavity const& ring, ModeLine const& mode) {
  double const turns = -(mode.hermite.one * ring.gouy[0] + mode.hermite.two * ring.gouy[1]) / (2 * pi);
  return turns - std::round(turns);
}

double place_of(RingCavity const& ring, std::size_t stop) {
  double sum = 0;
  for (std::size_t i = 0; i <= stop; ++i) sum += ring.trip.stops[i].leg;
  return sum;
}

std::string stops_text(RingWaves const& waves, World const& world) {
  RingCavity const& ring = waves.ring;
  double const power = world.wave.beam < world.beam_powers.size() ? world.beam_powers[world.wave.beam] : 0;
  Columns table{
      {"loss per round trip", "z/m", "incidence/deg", "radius/mm", "heights/nm rms", "scatters", "share", "W"},
      {true},
      {}};
  RingGridCheck const* const check = waves.grid_check ? &*waves.grid_check : nullptr;
  if (check) table.titles.push_back("finer grid");
  auto const add = [&](std::vector<std::string> row, double share, double change) {
    row.push_back(share_text(share));
    row.push_back(power > 0 ? share_text(share, power) : "-");
    if (check) row.push_back(share > rounding ? fmt::format("{:+.1e}", change) : "-");
    table.rows.push_back(std::move(row));
  };
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    RingStop const& stop = ring.stops[i];
    add({stop.mirror ? "past the rim of " + world.name_of(stop.surface) + ", and scattered"
                     : "on " + world.name_of(stop.surface),
         fmt::format("{:.6g}", place_of(ring, i)), stop.mirror ? fmt::format("{:.4g}", stop.incidence * 180 / pi) : "-",
         fmt::format("{:.4g} x {:.4g}", 1e3 * stop.arriving[0].radius, 1e3 * stop.arriving[1].radius),
         stop.mirror ? fmt::format("{:.3g}", 1e9 * stop.roughness) : "-",
         stop.mirror ? fmt::format("{:.3g}", stop.scattered) : "-"},
        waves.losses.taken[i], check ? check->losses.taken[i] : 0);
  }
  double const beyond = waves.losses.beyond_band, loss = waves.mode.loss();
  add({"at angles that reach no opening", "", "", "", "", ""}, beyond, check ? check->losses.beyond_band : 0);
  add({"all", "", "", "", "", ""}, loss, check ? check->loss : 0);
  return "\nIn the order of the light: radius of the mode in the plane of incidence and across it, rms heights below "
         "and "
         "power scattered\n"
         "beyond the crossover angle, and power lost.\n\n" +
         aligned(table);
}

std::string ring_modes_text(RingWaves const& waves) {
  if (waves.modes.empty()) return {};
  Columns table{{"mode", "shared", "loss", "phase/turns", "by ray matrix"}, {true}, {}};
  for (ModeLine const& m : waves.modes)
    table.rows.push_back({fmt::format("HG{}{}", m.hermite.one, m.hermite.two), fmt::format("{:.4f}", m.hermite.shared),
                          share_text(m.loss), phase_text(m.phase), phase_text(expected_phase(waves.ring, m))});
  return "\nModes next to Hermite-Gauss modes, first index in the plane of incidence, and the power shared with them; "
         "phase of the\n"
         "round trip over that of the fundamental mode.\n\n" +
         aligned(table);
}

// Of edges and mirrors in the order of the light.
std::string levers_text(RingWaves const& waves, World const& world) {
  Columns table{{"edge or mirror", "body", "|A_x|/(1/m)", "|A_y|", "|A_z|", "about x/(1/rad)", "y", "z", "radius"},
                {true, true},
                {}};
  for (SurfaceLevers const& s : waves.levers.surfaces) {
    BodyId const body = world.surfaces()[s.surface.value].body;
    std::vector<std::string> row{world.name_of(s.surface), body.valid() ? world.bodies()[body.value].name : "-"};
    for (auto const& part : {s.levers.displacement, s.levers.rotation})
      for (int axis = 0; axis < 3; ++axis) row.push_back(fmt::format("{:.3g}", std::abs(part[axis])));
    row.push_back(s.mirror ? "-" : fmt::format("{:.3g}", std::abs(s.widening)));
    table.rows.push_back(std::move(row));
  }
  return fmt::format(
             "\nStray field over the main field per round trip, per displacement along the axes of the scene, per "
             "rotation "
             "about the\n"
             "centre of an edge or the vertex of a mirror, and per change of the radius of an edge (eq. W.56, W.57). "
             "The "
             "eigenvalue of\n"
             "the field the other way around, which they contain, is that of the mode to {:.1e}.\n\n",
             mismatch_of(waves)) +
         aligned(table);
}

std::string grid_text(RingWaves const& waves) {
  if (!waves.grid_check)
    return "\nThe grid was not checked; --grid-check solves again on a grid of 1.4 times the points.\n";
  RingGridCheck const& g = *waves.grid_check;
  std::string text =
      fmt::format("\n{} points change the loss by {:+.2g} of itself", g.points, g.loss / waves.mode.loss());
  if (!std::isnan(g.phase)) text += fmt::format(", phases of modes by up to {:.1g} turns", g.phase);
  if (!std::isnan(g.edges)) text += fmt::format(", |A| of edges by up to {:.2g} of their rms", g.edges);
  if (!std::isnan(g.mirrors)) text += fmt::format(", of mirrors by {:.2g}", g.mirrors);
  return text + ".\n";
}

nlohmann::ordered_json grid_check_json(std::optional<RingGridCheck> const& check) {
  if (!check) return {};
  return {{"points", check->points},
          {"loss", check->loss},
          {"loss_by_stop", check->losses.taken},
          {"beyond_band", check->losses.beyond_band},
          {"phase_turns", number_json(check->phase)},
          {"edges_relative", number_json(check->edges)},
          {"mirrors_relative", number_json(check->mirrors)}};
}

nlohmann::ordered_json levers_json(RingWaves const& waves, World const& world) {
  nlohmann::ordered_json surfaces = nlohmann::ordered_json::array(), bodies = surfaces;
  std::vector<std::optional<RimLevers>> of_body(world.bodies().size());
  for (SurfaceLevers const& s : waves.levers.surfaces) {
    BodyId const body = world.surfaces()[s.surface.value].body;
    nlohmann::ordered_json entry{{"name", world.name_of(s.surface)},
                                 {"kind", s.mirror ? "mirror" : "baffle"},
                                 {"reference_m", {s.reference.x, s.reference.y, s.reference.z}}};
    add_levers(entry, s.levers);
    if (!s.mirror) entry["radius_per_m"] = {s.widening.real(), s.widening.imag()};
    surfaces.push_back(std::move(entry));
    if (!body.valid()) continue;
    RimLevers const about = levers_about(s, world.bodies()[body.value].pivot);
    RimLevers& sum = of_body[body.value] ? *of_body[body.value] : of_body[body.value].emplace();
    for (int axis = 0; axis < 3; ++axis) {
      sum.displacement[axis] += about.displacement[axis];
      sum.rotation[axis] += about.rotation[axis];
    }
  }
  for (std::size_t i = 0; i < of_body.size(); ++i) {
    if (!of_body[i]) continue;
    nlohmann::ordered_json entry{{"name", world.bodies()[i].name}};
    add_levers(entry, *of_body[i]);
    bodies.push_back(std::move(entry));
  }
  return {{"surfaces", surfaces}, {"bodies", bodies}, {"reverse_mismatch", mismatch_of(waves)}};
}

}  // namespace

std::string ring_text(RingWaves const& waves, World const& world) {
  RingCavity const& ring = waves.ring;
  Grid const& grid = ring.trip.grid;
  std::string const text = fmt::format(
      "cavity {}: {:.6g} m per round trip, grid of {} x {} points over {:.4g} m{}, which carries angles up to {:.4g} "
      "urad\n"
      "crossover angle {:.4g} urad\n",
      world.wave.beam_name, ring.length(), grid.points, grid.points, grid.window,
      ring.scaled ? " at the start, which follows the beam" : "", 1e6 * grid.largest_angle(ring.trip.wavelength),
      1e6 * ring.crossover);
  return text + stops_text(waves, world) + ring_modes_text(waves) + levers_text(waves, world) + grid_text(waves);
}

nlohmann::ordered_json ring_json(RingWaves const& waves, World const& world) {
  RingCavity const& ring = waves.ring;
  auto const known = [](double x) {  // null: rounding
    return x > rounding ? nlohmann::ordered_json(x) : nlohmann::ordered_json();
  };
  nlohmann::ordered_json stops = nlohmann::ordered_json::array(), modes = stops;
  for (std::size_t i = 0; i < ring.stops.size(); ++i) {
    RingStop const& stop = ring.stops[i];
    nlohmann::ordered_json entry{{"name", world.name_of(stop.surface)},
                                 {"kind", stop.mirror ? "mirror" : "baffle"},
                                 {"z_m", place_of(ring, i)},
                                 {"mode_radii_m", {stop.arriving[0].radius, stop.arriving[1].radius}},
                                 {"power_share_lost", known(waves.losses.taken[i])}};
    if (stop.mirror) {
      entry["incidence_rad"] = stop.incidence;
      entry["height_rms_m"] = stop.roughness;
      entry["scattered_beyond"] = stop.scattered;
    }
    stops.push_back(std::move(entry));
  }
  for (ModeLine const& m : waves.modes)
    modes.push_back({{"order", m.order},
                     {"n", m.hermite.one},
                     {"m", m.hermite.two},
                     {"shared", m.hermite.shared},
                     {"shared_order", m.in_order},
                     {"loss", known(m.loss)},
                     {"phase_turns", m.phase},
                     {"phase_by_ray_matrix_turns", expected_phase(ring, m)}});
  return {{"beam", world.wave.beam_name},
          {"length_m", ring.length()},
          {"points", ring.trip.grid.points},
          {"window_m", ring.trip.grid.window},
          {"scaled", ring.scaled},
          {"crossover_rad", ring.crossover},
          {"loss", known(waves.mode.loss())},
          {"residual", waves.mode.residual},
          {"round_trips", waves.mode.round_trips},
          {"beyond_band", known(waves.losses.beyond_band)},
          {"grid_check", grid_check_json(waves.grid_check)},
          {"stops", stops},
          {"modes", modes},
          {"levers", levers_json(waves, world)}};
}

namespace {

constexpr char example[] = "write for example --detuning -0.5..0.5:1001 (free spectral ranges) or -200Hz..200Hz:401";

constexpr double most_detuning = 1e-4;  // of the frequency of the light

ScanAxis axis_of(std::string const& option) {
  std::vector<InputError> errors;
  std::vector<ScanAxis> const axes = parse_axes({option}, false, errors);
  if (!errors.empty()) throw InputError(errors.front().reason(), example);
  return axes.front();
}

// Of a value in a list that did not become a finite number.
std::string fault_of(std::string const& value, double number) {
  if (std::isinf(number)) return fmt::format("'{}' is outside the range of double precision", value);
  char const* const fault = leading_number(value) ? "has another unit than the first value" : "is not a number";
  return fmt::format("'{}' {}", value, fault);
}

double in_orders(DrivenPowers const& p) {
  double sum = 0;
  for (double share : p.orders) sum += share;
  return sum;
}

// Those of a list that is too long for a table: where the circulating power has a maximum, largest first.
std::vector<std::size_t> resonances(std::vector<DrivenPowers> const& all) {
  std::vector<std::size_t> peaks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    bool const above_last = i == 0 || all[i].circulating > all[i - 1].circulating,
               above_next = i + 1 == all.size() || all[i].circulating >= all[i + 1].circulating;
    if (above_last && above_next) peaks.push_back(i);
  }
  std::ranges::stable_sort(peaks, std::ranges::greater{}, [&](std::size_t i) { return all[i].circulating; });
  return peaks;
}

Columns table_of(DrivenScan const& driven, World const& world, std::vector<std::size_t> const& rows) {
  Columns table{{"detuning/FSR", "Hz", "circulating", "reflected", "transmitted"}, {}, {}};
  std::size_t const ports = driven.detunings.front().ports.size();
  if (ports > 1) {
    table.titles.pop_back();
    for (std::size_t i = 0; i < ports; ++i) table.titles.push_back("by " + world.name_of(driven.surfaces[i + 1]));
  }
  std::size_t const orders = driven.detunings.front().orders.size();
  for (std::size_t n = 0; n < orders; ++n) table.titles.push_back(fmt::format("order {}", n));
  table.titles.emplace_back("higher");
  for (std::size_t i : rows) {
    DrivenPowers const& p = driven.detunings[i];
    std::vector<std::string> row{fmt::format("{:+.6f}", p.detuning),
                                 fmt::format("{:+.6g}", p.detuning * driven.free_spectral_range),
                                 fmt::format("{:.5g}", p.circulating), fmt::format("{:.5g}", p.reflected)};
    for (double power : p.ports) row.push_back(fmt::format("{:.4g}", power));
    for (double share : p.orders) row.push_back(fmt::format("{:.3g}", share));
    row.push_back(fmt::format("{:.3g}", std::max(1 - in_orders(p), 0.0)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<double> parse_detunings(std::string const& text, double round_trip, double wavelength) {
  std::string const option = "--detuning=" + text;
  ScanAxis const axis = axis_of(option);
  std::vector<InputError> errors;
  auto const refuse = [&](std::string const& why, std::string const& remedy = example) {
    errors.emplace_back(fmt::format("'{}': {}", option, why), remedy);
  };
  auto const unit = axis.unit.empty() ? std::nullopt : parse_unit(axis.unit);
  if (!axis.unit.empty() && (!unit || unit->dimension != dim::frequency))
    refuse(fmt::format("'{}' is not a unit of frequency", axis.unit));
  if (axis.range && axis.numbers.front() > axis.numbers.back()) refuse("the range runs downwards");
  double const largest = most_detuning * round_trip / wavelength;
  std::vector<double> detunings;
  for (std::size_t i = 0; i < axis.numbers.size(); ++i) {
    double const number = axis.numbers[i];
    detunings.push_back(unit ? to_si(number, *unit) * round_trip / speed_of_light : number);
    bool const inside = axis.range && i > 0 && i + 1 < axis.numbers.size();  // of a range only the ends are reported
    if (!std::isfinite(number))
      refuse(fault_of(axis.values[i], number));
    else if (!inside && std::fabs(detunings.back()) > largest)
      refuse(fmt::format("'{}' is more than {:g} of the frequency of the light, and the field is computed at one "
                         "wavelength",
                         axis.values[i], most_detuning),
             fmt::format("stay within {:.3g} free spectral ranges, {:.3g} Hz", largest,
                         most_detuning * speed_of_light / wavelength));
  }
  throw_all(errors);
  return detunings;
}

std::string driven_text(DrivenScan const& driven, World const& world, std::size_t show) {
  auto const name = [&](std::size_t i) { return world.name_of(driven.surfaces[i]); };
  std::string others;
  for (std::size_t i = 1; i < driven.surfaces.size(); ++i)
    others += fmt::format("{}{}: {:.4g}", i > 1 ? ", " : "", name(i), driven.coatings[i].transmission);
  std::string text = fmt::format(
      "\nField driven through {}, which transmits {:.4g} ({}), per input power. Free spectral range {:.6g} Hz; {} "
      "round\n"
      "trips; at the worst detuning the field is known to {:.1g} of itself.\n",
      name(0), driven.coatings[0].transmission, others, driven.free_spectral_range, driven.round_trips,
      std::max(driven.error, 1e-15));
  if (driven.input_orders.empty()) {
    text += "The input is the mode of the cavity.\n";
  } else {
    text += fmt::format("The input shares with the modes of the mirrors");
    for (std::size_t n = 0; n < driven.input_orders.size(); ++n)
      text += fmt::format("{} {:.5g} in order {}", n ? "," : "", driven.input_orders[n], n);
    text += fmt::format("; {:.5g} of it falls on {}.\n", driven.entered, name(0));
  }
  std::vector<std::size_t> rows(driven.detunings.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  bool const all = rows.size() <= show;
  if (!all) rows = resonances(driven.detunings);
  std::size_t const found = rows.size();
  if (found > show) rows.resize(show);
  if (!all)
    text += fmt::format("Maxima of the circulating power over {} detunings, largest first{}; --csv has all.\n",
                        driven.detunings.size(), found > show ? fmt::format(", {} of {}", show, found) : "");
  return text + "\n" + aligned(table_of(driven, world, rows));
}

nlohmann::ordered_json driven_json(DrivenScan const& driven, World const& world) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (DrivenPowers const& p : driven.detunings)
    points.push_back({{"detuning", p.detuning},
                      {"detuning_hz", p.detuning * driven.free_spectral_range},
                      {"circulating", p.circulating},
                      {"reflected", p.reflected},
                      {"transmitted", p.transmitted},
                      {"ports", p.ports},
                      {"orders", p.orders},
                      {"field_error", p.error}});
  nlohmann::ordered_json mirrors = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < driven.surfaces.size(); ++i)
    mirrors.push_back({{"name", world.name_of(driven.surfaces[i])},
                       {"transmission", driven.coatings[i].transmission},
                       {"loss", driven.coatings[i].loss}});
  return {{"mirrors", mirrors},
          {"free_spectral_range_hz", driven.free_spectral_range},
          {"entered", driven.entered},
          {"input_orders", driven.input_orders},
          {"round_trips", driven.round_trips},
          {"field_error", driven.error},
          {"detunings", points}};
}

std::string driven_csv(DrivenScan const& driven, World const& world) {
  std::string text = "detuning,detuning [Hz],circulating,reflected,transmitted";
  std::size_t const ports = driven.detunings.front().ports.size();
  for (std::size_t i = 0; ports > 1 && i < ports; ++i) text += ",by " + world.name_of(driven.surfaces[i + 1]);
  for (std::size_t n = 0; n < driven.detunings.front().orders.size(); ++n) text += fmt::format(",order {}", n);
  text += ",field error\n";
  for (DrivenPowers const& p : driven.detunings) {
    text += fmt::format("{},{},{},{},{}", p.detuning, p.detuning * driven.free_spectral_range, p.circulating,
                        p.reflected, p.transmitted);
    for (std::size_t i = 0; ports > 1 && i < ports; ++i) text += fmt::format(",{}", p.ports[i]);
    for (double share : p.orders) text += fmt::format(",{}", share);
    text += fmt::format(",{}\n", p.error);
  }
  return text;
}

}  // namespace straytrace::cli
