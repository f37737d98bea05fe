// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "world/read_parts.hpp"

namespace straytrace {
namespace {

std::optional<PoolRef> read_lambertian(Node const& law, World& world) {
  bool const by_brdf = law.has("brdf");
  if (by_brdf && law.has("tis")) law.problem("'tis' and 'brdf' say the same thing twice", "keep one of them");
  double const reflectance =
      by_brdf ? pi * law.number("brdf", dim::brdf, required, 0, 1 / pi) : law.number("tis", dim::plain, required, 0, 1);
  return world.add_law(Lambertian{reflectance});
}

std::optional<PoolRef> read_power_law(Node const& law, World& world) {
  PowerLaw p;
  p.exponent = law.number("exponent", dim::plain, 2, 0, 8);
  p.above = law.number("above", dim::angle, required, 1e-9, 1.5);
  if (law.has("tis")) {
    if (law.has("kappa")) law.problem("'tis' and 'kappa' say the same thing twice", "keep one of them");
    if (p.exponent != 2) law.problem("a total is defined for exponent 2 only (physics.md eq. 3.19)", "give 'kappa'");
    double const tis = law.number("tis", dim::plain, required, 0, 1);
    p.kappa = p.above > 0 ? tis * statistical_kappa(p.above) / (2 * pi) : 0;
  } else {
    p.kappa = law.number("kappa", dim::brdf, required, 0, 1e3);
  }
  if (!(p.above > 0 && p.kappa >= 0 && std::isfinite(p.exponent))) return {};
  p.prepare();
  return world.add_law(p);
}

std::optional<PoolRef> read_abg(Node const& law, World& world) {
  Abg p;
  p.a = law.number("a", dim::brdf, required, 0, 1e6);
  p.b = law.number("b", dim::plain, required, 1e-12, 1e6);
  p.g = law.number("g", dim::plain, required, 0, 8);
  if (!(p.a >= 0 && p.b > 0)) return {};
  p.prepare();
  return world.add_law(p);
}

std::optional<PoolRef> read_law(Node const& law, World& world) {
  static constexpr std::array<std::string_view, std::tuple_size_v<LawTypes>> models = {Lambertian::key, PowerLaw::key,
                                                                                       Abg::key};
  static constexpr std::array<std::optional<PoolRef> (*)(Node const&, World&), models.size()> readers = {
      read_lambertian, read_power_law, read_abg};
  if (law.kind() != Node::Kind::table) {
    law.problem("a scatter law is a table", "write {model: lambertian, tis: 1 %}");
    return {};
  }
  std::string const model = law.choice("model", models);
  std::optional<PoolRef> ref;
  for (std::size_t i = 0; i < models.size(); ++i)
    if (model == models[i]) ref = readers[i](law, world);
  law.has("source");
  if (!model.empty()) law.refuse_unknown(fmt::format("scatter law '{}'", model));
  return ref;
}

// physics.md eq. 3.1, at every incidence of the albedo table.
void check_energy(std::string const& name, Node const& node, Optic const& optic, double transmit, LawPool const& laws) {
  for (int i = AlbedoTable::size - 1; i >= 0; --i) {
    double const cosine = AlbedoTable::cosine(i);
    double const scattered = scatter_albedo(laws, optic, cosine);
    if (!(optic.reflect + transmit + scattered > 1 + 1e-9)) continue;  // NaN: a value is missing, and reported
    node.problem(
        fmt::format("material '{}' makes light: at {:.0f} deg of incidence it reflects {:.6g}, transmits {:.6g} "
                    "and scatters {:.6g}, together more than 1",
                    name, std::acos(cosine) * 180 / pi, optic.reflect, transmit, scattered),
        "lower one of them; what is left over is absorbed");
    return;
  }
}

}  // namespace

void read_materials(Scene const& scene, World& world, Registry& names) {
  names.black = world.add_optic({});
  for (auto const& [name, node] : scene.table("materials").items()) {
    Optic optic;
    double transmit = 0;
    if (Node const s = node.table("specular")) {
      optic.reflect = s.number("reflect", dim::plain, 0, 0, 1);
      transmit = s.number("transmit", dim::plain, 0, 0, 1);  // leaves the scene: booked as absorbed
      s.refuse_unknown("'specular'");
    }
    auto const laws = node.list("scatter");
    if (laws.size() > Optic::most_laws)
      node.problem(fmt::format("more than {} scatter laws in one material", Optic::most_laws), "join some of them");
    for (Node const& law : laws) {
      auto const ref = read_law(law, world);
      if (ref && optic.laws < Optic::most_laws) optic.law[optic.laws++] = *ref;
    }
    node.has("source");
    node.refuse_unknown(fmt::format("material '{}'", name));
    check_energy(name, node, optic, transmit, world.view().laws);
    names.materials[name] = world.add_optic(optic);
  }
}

}  // namespace straytrace
