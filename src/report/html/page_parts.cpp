// SPDX-License-Identifier: BSD-3-Clause
// What a page says of fields of cavities, halos and materials.
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/math/constants.hpp"
#include "base/math/samples.hpp"
#include "io/markup.hpp"
#include "report/html/page_json.hpp"
#include "report/scene_picture.hpp"
#include "wave/arm/wave_record.hpp"
#include "world/build/read_materials.hpp"
#include "world/model/material.hpp"

namespace straytrace::report {
namespace {

using wave::PolarIrradiance;
using wave::Travel;
using wave::WaveRecord;

constexpr int rings_of_map = 80, points_of_profile = 400, points_of_scatter = 48, planes_of_rims = 5;

// A plane lit from one side.
struct LitPlane {
  std::string name, towards;
  double place = 0, rim = 0;  // m
  std::size_t from = 0;       // mirror that the light comes from
  bool mirror = false;
  PolarIrradiance const* light = nullptr;
};

// Irradiance over coarser rings, by area.
std::vector<float> coarser(PolarIrradiance const& light, int merged, double scale) {
  std::vector<float> values;
  for (int ring = 0; ring < light.rings; ring += merged)
    for (int sector = 0; sector < light.sectors; ++sector) {
      double sum = 0, area = 0;
      for (int r = ring; r < std::min(ring + merged, light.rings); ++r) {
        sum += light.radius(r) * double(light.mean[std::size_t(r * light.sectors + sector)]);
        area += light.radius(r);
      }
      values.push_back(float(scale * sum / area));
    }
  return values;
}

double over_azimuth(PolarIrradiance const& light, int ring) {
  auto const first = light.mean.begin() + std::ptrdiff_t(ring) * light.sectors;
  double sum = 0;
  for (auto at = first; at != first + light.sectors; ++at) sum += double(*at);
  return sum / light.sectors;
}

PageJson plane_json(WaveRecord const& w, LitPlane const& plane, ScatteredLight const& scattered) {
  double const scale = w.power > 0 ? w.power : 1;
  PolarIrradiance const& light = *plane.light;
  int const merged = (light.rings + rings_of_map - 1) / rings_of_map;
  std::vector<float> const values = coarser(light, merged, scale);
  std::vector<double> radius, profile, at, mean;
  for (int ring = 0; ring < light.rings; ring += (light.rings + points_of_profile - 1) / points_of_profile) {
    radius.push_back(light.radius(ring));
    profile.push_back(scale * over_azimuth(light, ring));
  }
  double const distance = plane.from == 0 ? plane.place : w.length - plane.place;
  for (int i = 1; i <= points_of_scatter; ++i) {
    at.push_back(light.rings * light.step * i / points_of_scatter);
    mean.push_back(scale * scattered(plane.from, distance, at.back()));
  }
  return {{"name", plane.name},
          {"towards", plane.towards},
          {"z", number(plane.place)},
          {"rim", number(plane.rim)},
          {"mirror", plane.mirror},
          {"crossover", number(w.crossover * distance)},
          {"rings", int(values.size()) / light.sectors},
          {"sectors", light.sectors},
          {"step", number(light.step * merged)},
          {"values", base64(values.data(), values.size() * sizeof(float))},
          {"radius", numbers(radius)},
          {"profile", numbers(profile)},
          {"scattered_radius", numbers(at)},
          {"scattered", numbers(mean)}};
}

// Both mirrors, and edges spread evenly over those whose light the grid holds, or over all.
std::vector<LitPlane> chosen_planes(WaveRecord const& w) {
  std::vector<LitPlane> all;
  auto const add = [&](std::size_t plane, Travel travel, std::string const& name, double place, double rim,
                       bool mirror) {
    PolarIrradiance const& light = w.irradiance.of(int(plane), travel);
    bool const forward = travel == Travel::towards_mirror2;
    if (!light.mean.empty())
      all.push_back({name, w.mirrors[forward ? 1 : 0].name, place, rim, forward ? 0u : 1u, mirror, &light});
  };
  add(w.rims.size() + 1, Travel::towards_mirror2, w.mirrors[1].name, w.length, w.mirrors[1].radius, true);
  add(0, Travel::towards_mirror1, w.mirrors[0].name, 0, w.mirrors[0].radius, true);
  std::vector<std::size_t> rims;
  for (std::size_t i = 0; i < w.rims.size(); ++i)
    if (!w.rims[i].draws.empty()) rims.push_back(i);
  if (rims.empty())
    for (std::size_t i = 0; i < w.rims.size(); ++i) rims.push_back(i);
  std::size_t const count = std::min<std::size_t>(rims.size(), planes_of_rims);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t const i = rims[count > 1 ? k * (rims.size() - 1) / (count - 1) : 0];
    for (Travel const travel : {Travel::towards_mirror2, Travel::towards_mirror1})
      add(i + 1, travel, w.rims[i].name, w.rims[i].centre.z, w.rims[i].radius, false);
  }
  return all;
}

// |A|^2 over all draws, with tolerances without the edges as in the scene: across the beam the mean of x and y.
std::vector<double> squares(wave::RimRecord const& rim, bool across) {
  std::vector<double> all;
  bool const tolerances = std::ranges::any_of(rim.draws, [](wave::RimDrawRecord const& d) { return d.tolerance > 0; });
  for (wave::RimDrawRecord const& draw : rim.draws) {
    if (tolerances && draw.tolerance == 0) continue;
    auto const& lever = draw.response.levers.displacement;
    all.push_back(across ? (std::norm(lever[0]) + std::norm(lever[1])) / 2 : std::norm(lever[2]));
  }
  return all;
}
double rms(std::vector<double> const& squares) {
  double sum = 0;
  for (double x : squares) sum += x;
  return squares.empty() ? not_a_number : std::sqrt(sum / double(squares.size()));
}
// Root of a percentile of some values; NaN of one.
double root_percentile(std::vector<double> values, double share) {
  if (values.size() < 2) return not_a_number;
  std::ranges::sort(values);
  return std::sqrt(nearest_rank(values, share));
}

PageJson rims_json(WaveRecord const& w) {
  std::vector<double> z, towards1, towards2, across, along, low, high, speckle, speckle_along;
  std::size_t solved = 0;
  for (wave::RimRecord const& rim : w.rims) {
    std::vector<double> const seen = squares(rim, true);
    z.push_back(rim.centre.z);
    towards1.push_back(rim.towards_mirror1);
    towards2.push_back(rim.towards_mirror2);
    across.push_back(rms(seen));
    along.push_back(rms(squares(rim, false)));
    low.push_back(root_percentile(seen, 0.05));
    high.push_back(root_percentile(seen, 0.95));
    speckle.push_back(std::sqrt(rim.speckle.transverse));
    speckle_along.push_back(std::sqrt(rim.speckle.longitudinal));
    solved += rim.draws.empty() ? 0 : 1;
  }
  return {{"z", numbers(z)},           {"towards1", numbers(towards1)}, {"towards2", numbers(towards2)},
          {"across", numbers(across)}, {"along", numbers(along)},       {"low", numbers(low)},
          {"high", numbers(high)},     {"speckle", numbers(speckle)},   {"speckle_along", numbers(speckle_along)},
          {"solved", solved}};
}

PageJson diodes_json(WaveRecord const& w) {
  double const scale = w.power > 0 ? w.power : 1;
  PageJson rows = PageJson::array();
  for (wave::DiodeRecord const& d : w.diodes)
    rows.push_back({{"name", d.name},
                    {"x", number(d.centre[0])},
                    {"y", number(d.centre[1])},
                    {"power", number(scale * d.power)},
                    {"mean", number(scale * d.mean)},
                    {"spread", number(scale * d.spread)}});
  return rows;
}

PageJson wave_ledger_json(WaveRecord const& w) {
  double towards1 = 0, towards2 = 0;
  for (wave::RimRecord const& rim : w.rims) {
    towards1 += rim.towards_mirror1;
    towards2 += rim.towards_mirror2;
  }
  PageJson rows = PageJson::array();
  auto const add = [&](std::string const& name, double share) {
    rows.push_back({{"name", name}, {"share", number(share)}});
  };
  for (wave::MirrorRecord const& m : w.mirrors) add("past the rim of " + m.name + ", and scattered", m.lost);
  if (!w.rims.empty()) {
    add("on baffles, towards " + w.mirrors[1].name, towards2);
    add("on baffles, towards " + w.mirrors[0].name, towards1);
  }
  add("at angles that reach no opening", w.beyond_band);
  return rows;
}

// Over the draws of the heights; empty of one.
PageJson loss_of_draws_json(WaveRecord const& w) {
  std::vector<double> losses;
  for (wave::HeightsRecord const& d : w.heights) losses.push_back(d.loss);
  if (losses.size() < 2) return PageJson(nullptr);
  wave::Spread const s = wave::spread_of(losses);
  return {{"draws", losses.size()}, {"median", number(s.median)}, {"low", number(s.low)}, {"high", number(s.high)}};
}

PageJson bands_json(WaveRecord const& w) {
  if (!w.bands) return PageJson(nullptr);
  std::vector<double> from, to, scattered, loss;
  for (wave::HeightBand const& b : w.bands->bands) {
    from.push_back(b.from);
    to.push_back(b.to);
    scattered.push_back(b.scattered[0] + b.scattered[1]);
    loss.push_back(b.loss);
  }
  return {{"from", numbers(from)},
          {"to", numbers(to)},
          {"scattered", numbers(scattered)},
          {"loss", numbers(loss)},
          {"resolved", number(wave::resolved_loss_of_bands * w.heights.front().loss)},
          {"smooth", number(w.bands->smooth)},
          {"beyond", number(w.bands->beyond)}};
}

}  // namespace

PageJson wave_json(WaveRecord const& w, ScatteredLight const& scattered) {
  PageJson planes = PageJson::array(), modes = PageJson::array();
  for (LitPlane const& plane : chosen_planes(w)) planes.push_back(plane_json(w, plane, scattered));
  for (wave::ModeLine const& m : w.modes)
    modes.push_back({{"order", m.order},
                     {"n", m.hermite.one},
                     {"m", m.hermite.two},
                     {"shared", number(m.hermite.shared)},
                     {"in_order", number(m.in_order)},
                     {"loss", number(m.loss)},
                     {"phase", number(m.phase)},
                     {"alike", m.alike}});
  return {{"beam", w.beam},
          {"power", w.power > 0 ? number(w.power) : PageJson(nullptr)},
          {"length", number(w.length)},
          {"points", w.grid.points},
          {"window", number(w.grid.window)},
          {"crossover", number(w.crossover)},
          {"loss", number(w.loss())},
          {"smooth_loss", number(w.perfect_loss)},
          {"loss_of_draws", loss_of_draws_json(w)},
          {"by_frequency", bands_json(w)},
          {"finer_grid", w.grid_check ? PageJson{{"points", w.grid_check->points}, {"loss", number(w.grid_check->loss)}}
                                      : PageJson(nullptr)},
          {"mirrors", {w.mirrors[0].name, w.mirrors[1].name}},
          {"planes", planes},
          {"ledger", wave_ledger_json(w)},
          {"edges", rims_json(w)},
          {"photodiodes", diodes_json(w)},
          {"modes", modes}};
}

// Light of a cavity at small angles on the surfaces of a scene, for the page.

namespace {

// Sector, radii and places along the axis of both ends [m], the places from that of the first, and the irradiance.
std::vector<float> patches_of(HaloSurface const& surface, double place, double power) {
  std::vector<float> values;
  for (HaloPatch const& p : surface.patches)
    for (double const x :
         {double(p.sector), p.inner, p.outer, p.inner_place - place, p.outer_place - place, power * p.irradiance})
      values.push_back(float(x));
  return values;
}

}  // namespace

PageJson halo_json(World const& world, wave::ArmCavity const& arm, wave::WaveRecord const& w) {
  constexpr int most_patches = 60000, fewest_rings = 4, most_rings = 32;
  int const sides = 2 * int(arm.rims.size()), sectors = w.irradiance.of(1, wave::Travel::towards_mirror2).sectors;
  int const rings = std::clamp(most_patches / (sides * sectors), fewest_rings, most_rings);
  std::vector<HaloSurface> const surfaces = HaloLight(world, arm, w.irradiance).surfaces(rings);
  auto const [low, high] = halo_scale(surfaces);
  double const power = w.power > 0 ? w.power : 1;
  auto const vector = [](Vec3 v) { return PageJson{v.x, v.y, v.z}; };
  PageJson list = PageJson::array();
  for (HaloSurface const& s : surfaces) {
    bool const forward = s.travel == wave::Travel::towards_mirror2;
    double const place = s.patches.front().inner_place;
    std::vector<float> const patches = patches_of(s, place, power);
    list.push_back({{"name", world.name_of(s.surface)},
                    {"towards", w.mirrors[forward ? 1 : 0].name},
                    {"forward", forward},
                    {"power", number(power * s.share)},
                    {"place", place},
                    {"patches", base64(patches.data(), patches.size() * sizeof(float))}});
  }
  return {{"beam", w.beam},
          {"in_watts", w.power > 0},
          {"crossover", number(w.crossover)},
          {"low", number(power * low)},
          {"high", number(power * high)},
          {"sectors", sectors},
          {"origin", vector(arm.frame.origin)},
          {"axes", {vector(arm.frame.x), vector(arm.frame.y), vector(arm.frame.z)}},
          {"surfaces", list}};
}

using nlohmann::json;

std::vector<double> material_offsets(int per_decade, double low, double high) {
  std::vector<double> all;
  int const count = int(std::lround(std::log10(high / low) * per_decade));
  for (int i = 0; i <= count; ++i) all.push_back(low * std::pow(10, double(i) / per_decade));
  return all;
}

namespace {

json curve_json(WorldView const& world, Optic const& optic, double degrees, int side, int per_decade, double& most) {
  json curve{{"deg", degrees}, {"side", side}, {"offset", json::array()}, {"bsdf", json::array()}};
  most = 0;
  for (double offset : material_offsets(per_decade, 1e-5, 1.99)) {
    double const value = bsdf_at(world, optic, degrees, offset, side);
    if (value < 0) break;
    curve["offset"].push_back(offset);
    curve["bsdf"].push_back(value);
    most = std::fmax(most, value);
  }
  return curve;
}

// Of all laws of a material that are read from files.
json points_json(Node const& material) {
  json points = json::array();
  for (Node const& law : material.list("scatter")) {
    if (law.kind() != Node::Kind::table || !law.has("model") || law.word("model") != "table") continue;
    for (MeasuredPoint const& p : measured_points(law))
      points.push_back({{"deg", std::asin(p.sin_i) * 180 / pi}, {"offset", p.offset}, {"bsdf", p.value}});
  }
  return points;
}

}  // namespace

json material_json(WorldView const& world, MaterialInfo const& info, std::vector<std::string> const& notes,
                   int per_decade) {
  Optic const& optic = world.optics[info.optic];
  json out{{"material", info.name}, {"source", info.source}, {"notes", notes}};
  out["laws"] = json::array();
  for (std::size_t i = 0; i < info.laws.size(); ++i)
    out["laws"].push_back({{"model", info.laws[i].model},
                           {"parameters", info.laws[i].parameters},
                           {"source", info.laws[i].source},
                           {"wavelength", info.laws[i].wavelength},
                           {"through", optic.through[i]}});
  out["tis"] = json::array();
  for (double degrees : material_angles) {
    MaterialShares const r = shares_at(world, optic, degrees);
    out["tis"].push_back({{"deg", degrees},
                          {"scattered", r.scattered},
                          {"laws", r.laws},
                          {"reflect", r.reflect},
                          {"transmit", r.transmit},
                          {"absorbed", r.absorbed}});
  }
  out["bsdf"] = json::array();
  for (int side : {1, -1})
    for (double degrees : material_incidences) {
      double most = 0;
      json const curve = curve_json(world, optic, degrees, side, per_decade, most);
      if (most > 0) out["bsdf"].push_back(curve);
    }
  return out;
}

json materials_json(Scene const& scene, World const& world) {
  json all = json::array();
  constexpr int per_decade = 10;
  Node const materials = scene.table("materials");
  for (MaterialInfo const& info : world.materials) {
    std::vector<std::string> notes;
    for (std::string const& note : world.notes)
      if (note.starts_with("material " + info.name + ":")) notes.push_back(note.substr(11 + info.name.size()));
    json entry = material_json(world.view(), info, notes, per_decade);
    ScatterSpread const& s = info.spread;
    entry["status"] = s.status;
    entry["low"] = s.low;
    entry["high"] = s.high;
    entry["factor"] = s.factor;
    entry["points"] = materials && materials.has(info.name) ? points_json(materials[info.name]) : json::array();
    all.push_back(std::move(entry));
  }
  return all;
}

}  // namespace straytrace::report
