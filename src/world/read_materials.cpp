// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/uncertainty.hpp"
#include "optics/angle_weight.hpp"
#include "optics/coating_table.hpp"
#include "optics/scatter_share.hpp"
#include "optics/specular.hpp"
#include "world/material_presets.hpp"
#include "world/read_laws.hpp"

namespace straytrace {
namespace {

// Pairs [angle, weight], linear in the angle between them and constant outside.
View<AngleWeight const> read_weight(Node const& law, World& world, PoolRef ref) {
  std::vector<std::pair<double, double>> points;
  bool whole = true;
  for (Node const& pair : law.list("weight")) {
    auto const parts = pair.as_list();
    if (pair.kind() != Node::Kind::list || parts.size() != 2) {
      pair.problem("'weight' is a list of pairs of angle and weight", "write [[0 deg, 1], [80 deg, 3]]");
      return {};
    }
    double const angle = parts[0].as_number(dim::angle, 0, pi / 2), value = parts[1].as_number(dim::plain, 0, 1e6);
    whole = whole && std::isfinite(angle) && std::isfinite(value);
    if (whole && !points.empty() && angle <= points.back().first) {
      pair.problem("the angles of 'weight' do not increase", "sort the pairs");
      return {};
    }
    points.emplace_back(angle, value);
  }
  if (!whole || points.empty()) return {};
  auto const at = [&](double cosine) {
    double const angle = 2 * atan_positive(std::sqrt((1 - cosine) / (1 + cosine)));
    std::size_t i = 0;
    while (i < points.size() && points[i].first <= angle) ++i;
    if (i == 0) return points.front().second;
    if (i == points.size()) return points.back().second;
    double const share = (angle - points[i - 1].first) / (points[i].first - points[i - 1].first);
    return points[i - 1].second + share * (points[i].second - points[i - 1].second);
  };
  std::vector<AngleWeight> one{weight_of(world.view().laws, ref, at)};
  return world.storage.keep(std::move(one));
}

void read_law(Node const& law, LawReading& out, Optic& optic, MaterialInfo& info) {
  if (law.kind() != Node::Kind::table)
    return law.problem("a scatter law is a table", "write {model: lambertian, tis: 1 %}");
  static std::vector<std::string_view> const names = [] {
    std::vector<std::string_view> all;
    for (LawReader const& reader : law_readers) all.push_back(reader.model);
    return all;
  }();
  std::string const model = law.choice("model", names);
  std::size_t const before = out.laws.size();
  out.wavelength.clear();
  for (LawReader const& reader : law_readers)
    if (model == reader.model) reader.read(law, out);
  bool const through = law.flag("through", false);
  LawInfo about{model, law.word("source", "not given"),
                law.has("wavelength")    ? law["wavelength"].as_word()
                : out.wavelength.empty() ? "not given"
                                         : out.wavelength};
  for (std::size_t i = before; i < out.laws.size() && i < std::size_t(Optic::most_laws); ++i) {
    optic.law[i] = out.laws[i];
    optic.through[i] = through;
    optic.weight[i] = {};
    if (law.has("weight")) optic.weight[i] = read_weight(law, out.world, out.laws[i]);
    info.laws.push_back(about);
  }
  info.spread.widen(read_spread(law));
  if (!model.empty()) law.refuse_unknown(fmt::format("scatter law '{}'", model));
}

// Dust scatters all light at grazing: stated shares become a coating, which never sends out more than is left.
void yield_to_dust(MaterialInfo const& info, World& world, Optic& optic) {
  bool dusty = false;
  for (LawInfo const& law : info.laws) dusty = dusty || law.model == "dust";
  if (!dusty || optic.has_interface || !(optic.reflect + optic.transmit > 0)) return;
  double const r = optic.reflect, t = optic.transmit;
  CoatingRow const rows[] = {{0, r, r, t, t, 0}, {pi / 2, r, r, t, t, 0}};
  optic.interface = world.add_interface(make_coating(rows, false, world.storage));
  optic.has_interface = true;
}

// "assumed; SOURCE; NOTE", as a material says it beside its laws; empty when it does not.
std::string said_of(Node const& material) {
  std::string said = read_status(material);
  for (char const* key : {"source", "wavelength", "note"})
    if (Node const text = material[key]) said += (said.empty() ? "" : "; ") + text.as_word();
  return said;
}

Vec3 incoming(double cosine, double turn) {
  double const sine = std::sqrt((1 - cosine) * (1 + cosine));
  SinCos const azimuth = sincos_turn(turn);
  return {sine * azimuth.cos, sine * azimuth.sin, cosine};
}

// physics.md eq. 3.1, at every incidence of the albedo table, from vacuum into vacuum. What the quadrature behind a
// table adds to an albedo of 1 is no light.
void check_energy(std::string const& name, Node const& node, Optic const& optic, WorldView const& world) {
  constexpr double quadrature = 1e-4;
  for (int i = AlbedoTable::size - 1; i >= 0; --i) {
    double const cosine = AlbedoTable::cosine(i);
    double scattered = scatter_albedo(world.laws, optic, cosine);
    for (double const turn : {0.0, 0.125, 0.25})  // grooves: the direction counts
      if (optic.lay != Lay::free)
        scattered = std::max(scattered, scatter_albedo(world.laws, optic, incoming(cosine, turn)));
    SpecularShares const s = specular_shares(world.interfaces, optic, cosine, 1, 1, true, scattered);
    if (!(s.reflect + s.transmit + (1 - quadrature) * scattered > 1 + 1e-9))
      continue;  // NaN: a value is missing, and reported
    node.problem(
        fmt::format("material '{}' makes light: at {:.0f} deg of incidence it reflects {:.6g}, transmits {:.6g} "
                    "and scatters {:.6g}, together more than 1",
                    name, std::acos(cosine) * 180 / pi, s.reflect, s.transmit, scattered),
        "lower one of them; what is left over is absorbed");
    return;
  }
}

}  // namespace

void read_materials(Scene const& scene, World& world, Registry& names) {
  names.black = world.add_optic({});
  for (auto const& [name, node] : scene.table("materials").items()) {
    Optic optic;
    MaterialInfo info{name, node.word("source", "not given"), {}, 0, {}};
    read_specular(node, world, names, optic);
    optic.depolarise = node.number("depolarise", dim::plain, 1, 0, 1);
    LawReading reading{world, name, {}, &optic};
    std::string const said = said_of(node);
    node.has("like");  // taken over already
    if (node.has("preset")) {
      LawInfo const about = read_preset(node, reading, optic);
      for (std::size_t i = 0; i < reading.laws.size(); ++i) {
        optic.law[i] = reading.laws[i];
        info.laws.push_back(about);
      }
      info.spread = reading.spread;
      info.spread.factor = read_uncertainty(node["uncertainty"], info.spread.factor);
    } else {
      info.spread = read_spread(node);
      info.spread.status = read_status(node);
      if (node.has("status")) reading.note(said);
    }
    for (Node const& law : node.list("scatter")) read_law(law, reading, optic, info);
    if (reading.laws.size() > std::size_t(Optic::most_laws))
      node.problem(fmt::format("more than {} scatter laws in one material", int(Optic::most_laws)),
                   "join some of them");
    optic.laws = std::min(int(reading.laws.size()), Optic::most_laws);
    yield_to_dust(info, world, optic);
    prescribe_scatter(node, world, optic);
    node.refuse_unknown(fmt::format("material '{}'", name));
    check_energy(name, node, optic, world.view());
    info.optic = names.materials[name] = world.add_optic(optic);
    world.materials.push_back(std::move(info));
  }
}

}  // namespace straytrace
