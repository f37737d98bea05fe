// SPDX-License-Identifier: BSD-3-Clause
// `specular` of a material: one of fixed shares, Fresnel, a film, a coating table (docs/reference/interfaces).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "optics/film_table.hpp"
#include "optics/scatter_share.hpp"
#include "optics/specular.hpp"
#include "world/read_coating.hpp"
#include "world/read_parts.hpp"

namespace straytrace {
namespace {

constexpr double film_tolerance = 1e-6;  // of amplitudes, in tables
constexpr std::size_t most_layers = 10000;

struct Reader {
  World& world;
  Registry const& names;

  // A plain number, or the name of a medium.
  double index(Node const& node) const {
    if (node.kind() != Node::Kind::scalar || !is_medium(node.text(), names)) return node.as_number(dim::plain, 0, 10);
    auto const medium = find_medium(node, world, names);
    return medium ? medium->index : not_a_number;
  }

  Complex opaque(Node const& s) const {
    if (!s.has("index")) {
      if (s.has("extinction")) s.problem("'extinction' without 'index'", "give 'index', the real part, too");
      return {};
    }
    Complex const n{index(s["index"]), s.number("extinction", dim::plain, 0, 0, 1000)};
    if (n.re == 0 && n.im == 0) s.problem("an index of 0", "give the index of the body behind the surface");
    return n;
  }

  double thickness(Node const& node, double n, double design) const {
    if (node.kind() == Node::Kind::scalar && node.text() == "quarter") return design / (4 * n);
    if (node.kind() == Node::Kind::scalar && node.text() == "half") return design / (2 * n);
    return node.as_number(dim::length, 0, 1e-3);
  }

  void layers(Node const& list, double design, std::vector<FilmLayer>& into, int depth) const {
    for (Node const& entry : list.as_list()) {
      if (entry.kind() == Node::Kind::table) {
        std::size_t const first = into.size();
        auto const times = entry.whole("repeat", 1, 1, 1000);
        if (depth < 8) layers(entry["layers"], design, into, depth + 1);
        if (into.size() == first) entry.problem("nothing to repeat", "write {repeat: 10, layers: [[1.45, quarter]]}");
        entry.refuse_unknown("a block of layers");
        std::vector<FilmLayer> const block(into.begin() + std::ptrdiff_t(first), into.end());
        for (std::uint64_t k = 1; k < times && into.size() <= most_layers; ++k)
          into.insert(into.end(), block.begin(), block.end());
        continue;
      }
      auto const numbers = entry.as_list();
      if (entry.kind() != Node::Kind::list || numbers.size() < 2 || numbers.size() > 3) {
        entry.problem("a layer is a list of its index and its thickness",
                      "write [2.07, quarter], [1.45, 183 nm] or, with extinction, [2.07, quarter, 1e-6]");
        continue;
      }
      FilmLayer layer;
      layer.index.re = index(numbers[0]);
      if (numbers.size() == 3) layer.index.im = numbers[2].as_number(dim::plain, 0, 100);
      layer.thickness = thickness(numbers[1], layer.index.re, design);
      if (layer.index.re > 0 && std::isfinite(layer.thickness) && std::isfinite(layer.index.im)) into.push_back(layer);
      if (layer.index.re == 0) entry.problem("a layer of index 0", "give the index of the layer");
    }
  }

  PoolRef film(Node const& node, Complex behind) const {
    Film film;
    film.wavelength = world.wavelength;
    film.opaque = behind;
    std::vector<FilmLayer> stack;
    double const design = node.number("design", dim::length, world.wavelength, 1e-8, 1e-3);
    if (node["layers"].kind() != Node::Kind::list)
      node.problem("a film needs its layers, from the front inwards", "write 'film: {layers: [[1.38, quarter]]}'");
    else
      layers(node["layers"], design, stack, 0);
    if (stack.size() > most_layers) node.problem(fmt::format("more than {} layers", most_layers), "repeat fewer");
    double between = 0;
    if (node.has("between")) {
      auto const pair = node["between"].as_list();
      if (pair.size() != 2 || node["between"].kind() != Node::Kind::list)
        node["between"].problem("'between' takes two media", "write 'between: [vacuum, fused_silica]'");
      else
        between = pair_index(pair, film);
    }
    node.refuse_unknown("'film'");
    film.layers = world.storage.keep(std::move(stack));
    if (node.healthy() && between > 0) {
      double const front = film.front_index, back = film.back_index;
      if (std::isinf(tabulate(film, front, back, film_tolerance, world.storage)))
        node["between"].warning("the film changes too fast with the angle for a table", "remove 'between'");
    }
    return world.add_interface(film);
  }
  double pair_index(std::vector<Node> const& pair, Film& film) const {
    film.front_index = index(pair[0]);
    film.back_index = index(pair[1]);
    return std::fmin(film.front_index, film.back_index);
  }
};

void read_fixed(Node const& s, Optic& optic) {
  optic.reflect = s.number("reflect", dim::plain, 0, 0, 1);
  optic.transmit = s.number("transmit", dim::plain, 0, 0, 1);
}

void set_interface(Optic& optic, PoolRef ref) {
  optic.has_interface = true;
  optic.interface = ref;
}

void read_word(Node const& s, World& world, Optic& optic) {
  static constexpr std::string_view known = "write 'fresnel', 'absorber', or a table such as {reflect: 99 %}";
  if (s.text() == "fresnel")
    set_interface(optic, world.add_interface(Fresnel{}));
  else if (s.text() != "absorber")
    s.problem(fmt::format("no interface is called '{}'", s.text()), std::string(known));
}

}  // namespace

void read_specular(Node const& material, World& world, Registry const& names, Optic& optic) {
  Node const s = material["specular"];
  if (!s) return;
  if (s.kind() == Node::Kind::scalar) return read_word(s, world, optic);
  Node const table = material.table("specular");
  if (!table) return;
  Reader const reader{world, names};
  bool const fixed = s.has("reflect") || s.has("transmit"), film = s.has("film"), coating = s.has("coating");
  bool const index = s.has("index") || s.has("extinction");
  if (fixed + film + coating > 1 || (index && (fixed || coating)))
    s.problem("two descriptions of one interface",
              "keep one: 'reflect' and 'transmit', 'film' (with or without 'index'), 'index', or 'coating'");
  else if (film)
    set_interface(optic, reader.film(s.table("film"), reader.opaque(s)));
  else if (index)
    set_interface(optic, world.add_interface(Fresnel{reader.opaque(s)}));
  else if (coating) {
    auto const made = read_coating(s, world);
    if (made) set_interface(optic, world.add_interface(*made));
  } else {
    read_fixed(s, optic);
  }
  s.refuse_unknown("'specular'");
}

void prescribe_scatter(Node const& material, World& world, Optic& optic) {
  WorldView const view = world.view();
  if (prescribed_scatter(view.interfaces, optic, 1) < 0) return;
  if (optic.laws == 0) optic.law[optic.laws++] = world.add_law(Lambertian{1});
  if (optic.laws > 1 || optic.through[0] || optic.weight[0].size > 0) {
    material.problem(
        "the coating says how much is scattered in all",
        "give one law without a weight, whose total is then ignored, or remove 'scatter' or 'absorb' there");
    return;
  }
  if (optic.lay != Lay::free)
    return material.problem("the coating says how much is scattered in all, and grooves scatter by direction",
                            "remove 'scatter' or 'absorb' of the coating, or use another law");
  SpecularPool const interfaces = world.view().interfaces;
  AngleWeight const weight = weight_for_share(
      world.view().laws, optic.law[0], [&](double cosine) { return prescribed_scatter(interfaces, optic, cosine); });
  optic.weight[0] = world.storage.keep(std::vector<AngleWeight>{weight});
}

}  // namespace straytrace
