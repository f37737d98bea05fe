// SPDX-License-Identifier: BSD-3-Clause
// straytrace wave: the field of a cavity at small angles, where its light goes, and what its rims couple back.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numeric>

#include "base/errors.hpp"
#include "base/math/constants.hpp"
#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "results/text/columns.hpp"
#include "session/diagnostics.hpp"
#include "session/light/cavity_waves.hpp"
#include "session/model.hpp"

namespace straytrace::cli {
namespace {

struct WaveOptions : SceneOptions {
  std::size_t show = 12;
  unsigned threads = 0;
  int order = 2;
};

constexpr double rounding_of_shares = 1e-12;  // of the power; smaller ones are rounding

double sum(std::vector<double> const& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Root mean square over the draws of the tolerances of |A| along an axis; NaN where the grid does not hold the light.
double lever_rms(RimResult const& rim, std::size_t axis) {
  if (rim.responses.empty()) return NAN;
  std::size_t const first = rim.responses.size() > 1 ? 1 : 0;  // with tolerances, of their draws alone
  double squares = 0;
  for (std::size_t i = first; i < rim.responses.size(); ++i)
    squares += std::norm(rim.responses[i].levers.displacement[axis]);
  return std::sqrt(squares / double(rim.responses.size() - first));
}
double expected_lever(RimResult const& rim, std::size_t axis) {
  return std::sqrt(axis < 2 ? rim.speckle.transverse : rim.speckle.longitudinal);
}
char const* method(RimResult const& rim) { return rim.responses.empty() ? "speckle" : "wave"; }
// The largest transverse lever, by the method of the rim.
double transverse(RimResult const& rim) {
  if (rim.responses.empty()) return expected_lever(rim, 0);
  return std::hypot(lever_rms(rim, 0), lever_rms(rim, 1)) / std::sqrt(2.0);
}

// W; 0: not stated.
double arm_power(World const& world) {
  return world.wave.beam < world.beam_powers.size() ? world.beam_powers[world.wave.beam] : 0;
}

void print_cavity(ArmWaves const& waves, World const& world) {
  ArmCavity const& arm = waves.arm;
  Grid const& grid = arm.cavity.grid;
  auto const in_band = std::ranges::count_if(arm.rims, &ArmRim::in_band);
  std::cout << fmt::format(
      "cavity {}: {:.6g} m, grid of {} x {} points over {:.4g} m, which carries angles up to {:.4g} urad\n"
      "crossover angle {:.4g} urad: {} of {} rims are within it, seen from both mirrors\n",
      world.wave.beam_name, arm.cavity.length, grid.points, grid.points, grid.window,
      1e6 * grid.largest_angle(arm.cavity.wavelength), 1e6 * arm.crossover, in_band, arm.rims.size());
  for (ArmMirror const& m : arm.mirrors)
    std::cout << fmt::format(
        "mirror {}: radius of the mode {:.4g} mm; heights below the crossover angle {:.3g} nm rms; scatters "
        "{:.3g} beyond it\n",
        world.name_of(m.surface), 1e3 * m.spot, 1e9 * m.roughness, m.scattered);
}

void print_losses(ArmWaves const& waves, World const& world) {
  double const loss = waves.mode.loss(), power = arm_power(world);
  PowerLedger const& l = waves.ledger;
  Columns table{{"loss per round trip", "share", "W"}, {true}, {}};
  auto const row = [&](std::string const& what, double share) {
    bool const known = share > rounding_of_shares;
    std::string const below = known ? "" : "below ";
    double const size = known ? share : rounding_of_shares;
    table.rows.push_back(
        {what, fmt::format("{}{:.4g}", below, size), power > 0 ? fmt::format("{}{:.4g}", below, size * power) : "-"});
  };
  row("past the rim of " + world.name_of(waves.arm.mirrors[0].surface) + ", and scattered", l.mirror1);
  row("past the rim of " + world.name_of(waves.arm.mirrors[1].surface) + ", and scattered", l.mirror2);
  if (!waves.arm.rims.empty()) {
    row(fmt::format("on baffles, towards {}", world.name_of(waves.arm.mirrors[1].surface)), sum(l.towards_mirror2));
    row(fmt::format("on baffles, towards {}", world.name_of(waves.arm.mirrors[0].surface)), sum(l.towards_mirror1));
  }
  row("at angles that reach no opening", l.beyond_band);
  row("all", loss);
  std::cout << '\n' << aligned(table);
  if (!std::isnan(waves.perfect_loss))
    std::cout << fmt::format(
        "smooth mirrors without baffles lose {} (eq. W.10)\n",
        waves.perfect_loss > rounding_of_shares ? fmt::format("{:.4g}", waves.perfect_loss) : "below 1e-12");
}

void print_modes(ArmWaves const& waves) {
  if (waves.modes.empty()) return;
  Columns table{{"mode", "shared", "loss", "phase/turns"}, {true}, {}};
  for (ModeLine const& m : waves.modes)
    table.rows.push_back({fmt::format("HG{}{}", m.n, m.m), fmt::format("{:.4f}", m.overlap),
                          fmt::format("{:.4g}", m.loss), fmt::format("{:+.5f}", m.phase)});
  std::cout << "\nModes of the mirrors without baffles next to Hermite-Gauss modes, and the power shared with them; "
               "phase of the\n"
               "round trip over that of the fundamental mode.\n\n"
            << aligned(table);
}

std::vector<std::size_t> strongest(ArmWaves const& waves) {
  std::vector<std::size_t> order(waves.rims.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return transverse(waves.rims[i]); });
  return order;
}

void print_rims(ArmWaves const& waves, World const& world, std::size_t show) {
  if (waves.rims.empty()) return;
  Columns table{
      {"rim of", "z/m", "urad from 1", "from 2", "method", "|A_x|/(1/m)", "|A_y|", "|A_z|", "speckle, across", "along"},
      {true, false, false, false, true},
      {}};
  auto const number = [](double x) { return std::isnan(x) ? "-" : fmt::format("{:.3g}", x); };
  std::vector<std::size_t> const order = strongest(waves);
  for (std::size_t i = 0; i < std::min(show, order.size()); ++i) {
    ArmRim const& rim = waves.arm.rims[order[i]];
    RimResult const& found = waves.rims[order[i]];
    table.rows.push_back({world.name_of(rim.surface), fmt::format("{:.6g}", rim.centre.z), number(1e6 * rim.angle1),
                          number(1e6 * rim.angle2), method(found), number(lever_rms(found, 0)),
                          number(lever_rms(found, 1)), number(lever_rms(found, 2)), number(expected_lever(found, 0)),
                          number(expected_lever(found, 2))});
  }
  std::cout << "\nStray field over the main field per round trip, per displacement of a rim (eq. W.14), largest first. "
               "speckle:\n"
               "expected rms over random mirrors with the BSDF models of the materials (eq. W.22); it stands for a "
               "rim whose light\n"
               "the grid does not hold.\n\n"
            << aligned(table);
  if (order.size() > show) std::cout << fmt::format("and {} more; --show N has more rows\n", order.size() - show);
}

nlohmann::ordered_json complex_json(std::complex<double> z) { return {z.real(), z.imag()}; }

nlohmann::ordered_json rim_json(ArmWaves const& waves, World const& world, std::size_t i) {
  ArmRim const& rim = waves.arm.rims[i];
  RimResult const& found = waves.rims[i];
  nlohmann::ordered_json out{{"rim_of", world.name_of(rim.surface)},
                             {"z_m", rim.centre.z},
                             {"radius_m", rim.rim.radius},
                             {"angle1_rad", rim.angle1},
                             {"angle2_rad", rim.angle2},
                             {"method", method(found)},
                             {"power_share_towards_mirror2", waves.ledger.towards_mirror2[i]},
                             {"power_share_towards_mirror1", waves.ledger.towards_mirror1[i]},
                             {"speckle_across_rms_per_m", expected_lever(found, 0)},
                             {"speckle_along_rms_per_m", expected_lever(found, 2)}};
  nlohmann::ordered_json draws = nlohmann::ordered_json::array();
  for (RimResponse const& r : found.responses) {
    nlohmann::ordered_json draw{{"displacement_per_m", nlohmann::ordered_json::array()},
                                {"rotation_per_rad", nlohmann::ordered_json::array()}};
    for (int axis = 0; axis < 3; ++axis) {
      draw["displacement_per_m"].push_back(complex_json(r.levers.displacement[axis]));
      draw["rotation_per_rad"].push_back(complex_json(r.levers.rotation[axis]));
    }
    draws.push_back(std::move(draw));
  }
  out["levers"] = std::move(draws);  // as drawn, then with each draw of the tolerances
  return out;
}

nlohmann::ordered_json as_json(ArmWaves const& waves, World const& world) {
  ArmCavity const& arm = waves.arm;
  nlohmann::ordered_json mirrors = nlohmann::ordered_json::array(), modes = mirrors, rims = mirrors;
  for (std::size_t i : {0, 1})
    mirrors.push_back({{"name", world.name_of(arm.mirrors[i].surface)},
                       {"mode_radius_m", arm.mirrors[i].spot},
                       {"height_rms_m", arm.mirrors[i].roughness},
                       {"scattered_beyond", arm.mirrors[i].scattered},
                       {"power_share_lost", i == 0 ? waves.ledger.mirror1 : waves.ledger.mirror2}});
  for (ModeLine const& m : waves.modes)
    modes.push_back({{"n", m.n}, {"m", m.m}, {"shared", m.overlap}, {"loss", m.loss}, {"phase_turns", m.phase}});
  for (std::size_t i = 0; i < waves.rims.size(); ++i) rims.push_back(rim_json(waves, world, i));
  auto const known = [](double x) {  // null: not known, or rounding
    return x > rounding_of_shares ? nlohmann::ordered_json(x) : nlohmann::ordered_json();
  };
  return {{"beam", world.wave.beam_name},
          {"length_m", arm.cavity.length},
          {"points", arm.cavity.grid.points},
          {"window_m", arm.cavity.grid.window},
          {"crossover_rad", arm.crossover},
          {"loss", waves.mode.loss()},
          {"loss_of_smooth_mirrors", known(waves.perfect_loss)},
          {"residual", waves.mode.residual},
          {"round_trips", waves.mode.round_trips},
          {"beyond_band", known(waves.ledger.beyond_band)},
          {"mirrors", mirrors},
          {"modes", modes},
          {"rims", rims}};
}

int wave(WaveOptions const& options) {
  Model const model = read_model(options.input, options.overrides);
  print_warnings(model.scene, options);
  if (!model.world.wave.present)
    throw InputError(fmt::format("{} has no table 'wave'", options.input),
                     "add for example 'wave: {beam: arm, baffles: \"baffles*\"}'");
  ArmWaves const waves = solve_waves(model.world, options.threads, options, options.order);
  for (std::string const& warning : waves.arm.warnings) print_warning(warning, options);
  if (options.json()) {
    std::cout << as_json(waves, model.world).dump() << '\n';
    return done;
  }
  print_cavity(waves, model.world);
  print_losses(waves, model.world);
  print_modes(waves);
  print_rims(waves, model.world, options.show);
  return done;
}

}  // namespace

void add_wave(CLI::App& app, int& exit_code) {
  auto const options = std::make_shared<WaveOptions>();
  WaveOptions& o = *options;
  auto* const command = app.add_subcommand(
      "wave", "Compute the field of a cavity at small angles: its losses, its modes, and what its rims couple back.");
  add_scene_options(*command, o);
  command->add_option("--show", o.show, "rows of rims")->check(whole_between(1, 1e6, "20"));
  command->add_option("--order", o.order, "highest order of the modes listed")->check(whole_between(0, 8, "2"));
  command->add_option("--threads", o.threads, "0: all cores")->check(whole_between(0, 4096, "8"));
  command->footer(
      "Examples:\n"
      "  straytrace wave examples/et_hf_wave.yaml\n"
      "  straytrace wave examples/et_hf_wave.yaml --format json");
  command->callback([options, &exit_code] { exit_code = wave(*options); });
}

}  // namespace straytrace::cli
