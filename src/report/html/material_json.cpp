// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "report/html/page_json.hpp"
#include "world/build/read_laws.hpp"
#include "world/model/material.hpp"

namespace straytrace::report {

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
