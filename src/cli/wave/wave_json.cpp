// SPDX-License-Identifier: BSD-3-Clause
#include "cli/wave/wave_output.hpp"

namespace straytrace::cli {
namespace {

using Json = nlohmann::ordered_json;

Json complex_json(std::complex<double> z) { return {z.real(), z.imag()}; }
Json share_json(double x) { return x > rounding_of_shares ? Json(x) : Json(); }  // null: not known, or rounding

Json spread_json(Spread const& s) {
  return {{"mean", s.mean}, {"median", s.median}, {"percentile_5", s.low}, {"percentile_95", s.high}};
}

}  // namespace

void add_levers(Json& out, RimLevers const& levers) {
  out["displacement_per_m"] = out["rotation_per_rad"] = Json::array();
  Json& displacement = out["displacement_per_m"];
  Json& rotation = out["rotation_per_rad"];
  for (int axis = 0; axis < 3; ++axis) {
    displacement.push_back(complex_json(levers.displacement[axis]));
    rotation.push_back(complex_json(levers.rotation[axis]));
  }
}

namespace {

// As drawn in the scene (tolerance 0), then with each draw of the tolerances and of the roll, in each draw of the
// heights.
Json levers_json(RimResult const& rim) {
  Json all = Json::array();
  for (std::size_t heights = 0; heights < rim.draws.size(); ++heights)
    for (std::size_t i = 0; i < rim.draws[heights].responses.size(); ++i) {
      RimResponse const& r = rim.draws[heights].responses[i];
      Json draw{{"heights", heights}, {"tolerance", i}};
      add_levers(draw, r.levers);
      draw["radius_per_m"] = complex_json(r.widening);
      all.push_back(std::move(draw));
    }
  return all;
}

Json rim_json(ArmWaves const& waves, World const& world, std::size_t i) {
  ArmRim const& rim = waves.arm.rims[i];
  RimResult const& found = waves.rims[i];
  RoundHole const& hole = waves.arm.cavity.baffles[i].rim;
  int const plane = int(i) + 1;
  Json out{{"name", world.name_of(rim.surface)},
           {"z_m", rim.centre.z},
           {"radius_m", rim.rim.radius},
           {"angle1_rad", rim.angle1},
           {"angle2_rad", rim.angle2},
           {"method", method_of(found)},
           {"power_share_towards_mirror2", waves.ledger.towards_mirror2[i]},
           {"power_share_towards_mirror1", waves.ledger.towards_mirror1[i]},
           {"sector_shares_towards_mirror2", waves.irradiance.of(plane, Travel::towards_mirror2).beyond(hole)},
           {"sector_shares_towards_mirror1", waves.irradiance.of(plane, Travel::towards_mirror1).beyond(hole)},
           {"speckle_across_rms_per_m", std::sqrt(found.speckle.transverse)},
           {"speckle_along_rms_per_m", std::sqrt(found.speckle.longitudinal)}};
  if (!found.draws.empty()) {
    out["across_per_m"] = spread_json(lever_spread(found, false));
    out["along_per_m"] = spread_json(lever_spread(found, true));
  }
  out["levers"] = levers_json(found);
  return out;
}

Json ledger_json(PowerLedger const& l) {
  return {{"mirror1", l.mirror1},
          {"mirror2", l.mirror2},
          {"towards_mirror2", l.towards_mirror2},
          {"towards_mirror1", l.towards_mirror1},
          {"beyond_band", l.beyond_band}};
}

Json grid_check_json(std::optional<GridCheck> const& check) {
  if (!check) return {};
  return {{"points", check->points},
          {"loss", check->loss},
          {"loss_by_surface", ledger_json(check->ledger)},
          {"across_relative", number_json(check->across)},
          {"along_relative", number_json(check->along)},
          {"expected_relative", number_json(check->expected)}};
}

Json bands_json(ArmWaves const& waves) {
  HeightBands const& f = *waves.bands;
  Json bands = Json::array();
  for (HeightBand const& b : f.bands)
    bands.push_back({{"from_per_m", b.from}, {"to_per_m", b.to}, {"scattered", b.scattered}, {"loss", b.loss}});
  return {{"smooth", f.smooth}, {"bands", bands}, {"beyond", f.beyond}, {"all", waves.draws.front().loss}};
}

Json draw_json(ArmDraw const& d) {
  return {{"loss", d.loss},
          {"residual", d.residual},
          {"round_trips", d.round_trips},
          {"height_rms_m", d.roughness},
          {"loss_by_surface", ledger_json(d.ledger)}};
}

Json diodes_json(ArmWaves const& waves) {
  Json all = Json::array();
  for (std::size_t i = 0; i < waves.diodes.size(); ++i) {
    Photodiode const& d = waves.arm.diodes[i];
    DiodeResult const& found = waves.diodes[i];
    all.push_back({{"name", d.name},
                   {"radius_m", d.radius},
                   {"azimuth_rad", d.azimuth},
                   {"area_m2", d.area()},
                   {"power_shares", found.draws},
                   {"power_share_mean", found.mean},
                   {"power_share_spread", found.spread}});
  }
  return all;
}

}  // namespace

nlohmann::ordered_json wave_json(ArmWaves const& waves, World const& world) {
  ArmCavity const& arm = waves.arm;
  Json mirrors = Json::array(), modes = mirrors, rims = mirrors, draws = mirrors;
  std::vector<double> losses;
  for (std::size_t i : {0, 1}) {
    mirrors.push_back({{"name", world.name_of(arm.mirrors[i].surface)},
                       {"mode_radius_m", arm.mirrors[i].spot},
                       {"height_rms_m", arm.mirrors[i].roughness},
                       {"scattered_beyond", arm.mirrors[i].scattered},
                       {"centroid_m", waves.spots[i].found},
                       {"axis_m", waves.spots[i].expected},
                       {"power_share_lost", i == 0 ? waves.ledger.mirror1 : waves.ledger.mirror2}});
    add_levers(mirrors.back(), waves.draws[0].mirrors[i].whole);  // about the vertex (eq. W.25)
  }
  for (ModeLine const& m : waves.modes)
    modes.push_back({{"order", m.order},
                     {"n", m.hermite.one},
                     {"m", m.hermite.two},
                     {"shared", m.hermite.shared},
                     {"p", m.laguerre.one},
                     {"l", m.laguerre.two},
                     {"shared_laguerre", m.laguerre.shared},
                     {"shared_order", m.in_order},
                     {"loss", m.loss},
                     {"phase_turns", m.phase},
                     {"alike", m.alike}});
  for (std::size_t i = 0; i < waves.rims.size(); ++i) rims.push_back(rim_json(waves, world, i));
  for (ArmDraw const& d : waves.draws) draws.push_back(draw_json(d)), losses.push_back(d.loss);
  Spread const loss = spread_of(losses);
  Json out{{"beam", world.wave.beam_name},
           {"length_m", arm.cavity.length},
           {"points", arm.cavity.grid.points},
           {"window_m", arm.cavity.grid.window},
           {"crossover_rad", arm.crossover},
           {"loss", loss.mean},
           {"loss_of_draws", spread_json(loss)},
           {"loss_of_smooth_mirrors", share_json(waves.perfect_loss)},
           {"residual", waves.draws.front().residual},
           {"round_trips", waves.draws.front().round_trips},
           {"beyond_band", share_json(waves.ledger.beyond_band)},
           {"grid_check", grid_check_json(waves.grid_check)},
           {"mirrors", mirrors},
           {"modes", modes},
           {"draws", draws},
           {"edges", rims},
           {"photodiodes", diodes_json(waves)}};
  if (waves.bands) out["by_frequency"] = bands_json(waves);
  return out;
}

}  // namespace straytrace::cli
