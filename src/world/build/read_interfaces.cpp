// SPDX-License-Identifier: BSD-3-Clause
// `specular` of a material: one of fixed shares, Fresnel, a film, a coating table (docs/reference/interfaces).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/input/document.hpp"
#include "base/math/constants.hpp"
#include "io/delimited_text.hpp"
#include "optics/coating/coating.hpp"
#include "optics/coating/film.hpp"
#include "optics/coating/specular.hpp"
#include "optics/scatter/angle_weight.hpp"
#include "world/build/read_parts.hpp"

namespace straytrace::world {
namespace {

// Shares of power against the angle of incidence and the wavelength, from the scene or a file.
struct ShareTable {
  std::vector<double> angle;                           // rad
  std::vector<double> wavelength;                      // m, of each row; empty: the same shares at every wavelength
  std::map<std::string, std::vector<double>> columns;  // power shares, one per angle; known names only
  std::vector<std::uint32_t> line;                     // of each row in the file; empty for a table in the scene
  std::string file;
};

// Columns of shares besides `angle` and `wavelength`.
std::vector<std::string> const& share_columns() {
  static std::vector<std::string> const names = {"reflect",    "reflect_s",  "reflect_p", "transmit",
                                                 "transmit_s", "transmit_p", "scatter",   "absorb"};
  return names;
}

// "angle", "wavelength" and shares, each with its unit.
bool check_share_column(Node const& node, std::string const& file, CsvTable::Column const& column) {
  auto const& known = share_columns();
  std::string const& name = column.name;
  bool const angle = name == "angle", wavelength = name == "wavelength";
  if (!angle && !wavelength && std::ranges::find(known, name) == known.end()) {
    node.file_problem(
        file, column.line, column.at, fmt::format("unknown column '{}'", shortened(name)),
        did_you_mean(name, known,
                     "known columns: angle, wavelength, reflect, reflect_s, reflect_p, transmit, transmit_s, "
                     "transmit_p, scatter, absorb; separate them by commas"));
    return false;
  }
  Dimension const wanted = angle ? dim::angle : wavelength ? dim::length : dim::plain;
  if (column.unit.dimension == wanted) return true;
  node.file_problem(file, column.line, column.at, wrong_unit(column, wanted),
                    angle        ? "write 'angle [deg]'"
                    : wavelength ? "write 'wavelength [nm]'"
                                 : fmt::format("write '{}' or '{} [%]'", name, name));
  return false;
}

// Text file: one row per angle and wavelength.
ShareTable read_share_file(Node const& node, std::string const& file) {
  CsvTable const table = read_csv_table(node, file, Comments::anywhere, "angle [deg], reflect, transmit [%]");
  if (table.columns.empty()) return {};
  bool sound = table.whole;
  for (CsvTable::Column const& column : table.columns) sound &= check_share_column(node, file, column);
  if (table.find("angle") < 0) {
    node.file_problem(file, table.columns[0].line, 1, "no column of angles", "name one column 'angle [deg]'");
    sound = false;
  }
  if (!sound) return {};
  ShareTable shares;
  shares.file = file;
  for (CsvTable::Row const& row : table.rows) {
    for (std::size_t i = 0; i < row.values.size(); ++i) {
      std::string const& name = table.columns[i].name;
      (name == "angle"        ? shares.angle
       : name == "wavelength" ? shares.wavelength
                              : shares.columns[name])
          .push_back(row.values[i]);
    }
    shares.line.push_back(row.line());
  }
  return shares;
}

// `node`: the name of a file, or a table with `file`, or with `angle` and lists. Empty after a problem.
ShareTable read_share_table(Node const& node) {
  if (node.has("file")) {
    Node const name = node["file"];
    std::string const file = name.as_word();
    return file.empty() ? ShareTable{} : read_share_file(name, file);
  }
  ShareTable table;
  auto const angles = node["angle"].as_list();
  if (angles.size() < 2) {
    node.problem("a coating needs at least two angles",
                 "write {angle: [0 deg, 60 deg, 90 deg], reflect: [0.01, 0.05, 1]}, {file: NAME}, or a preset");
    return {};
  }
  table.angle = node["angle"].as_numbers(dim::angle, angles.size());
  for (std::string const& name : share_columns())
    if (node.has(name)) table.columns[name] = node[name].as_numbers(dim::plain, angles.size());
  if (node.has("wavelength")) {
    table.wavelength = node["wavelength"].as_numbers(dim::length, angles.size());
    if (table.wavelength.size() != table.angle.size()) return {};
  }
  for (auto const& [name, column] : table.columns)
    if (column.size() != table.angle.size()) return {};
  return table.angle.size() == angles.size() ? table : ShareTable{};
}

bool same_wavelength(double a, double b) { return std::fabs(a - b) <= 1e-9 * b; }

double share_at(ShareTable const& t, std::size_t row, char const* both, char const* own) {
  auto const pick = [&](char const* name) {
    auto const found = t.columns.find(name);
    return found == t.columns.end() ? 0 : found->second[row];
  };
  return pick(both) + pick(own);
}

// Reports a problem at the place of the row.
void row_problem(Node const& node, ShareTable const& t, std::size_t row, std::string what, std::string suggestion) {
  if (t.file.empty())
    node.problem(std::move(what), std::move(suggestion));
  else
    node["file"].file_problem(t.file, t.line[row], 1, std::move(what), std::move(suggestion));
}

// Empty when the table is wrong; the problem is reported.
std::vector<CoatingRow> rows_of(Node const& node, ShareTable const& t) {
  std::vector<CoatingRow> rows;
  bool const absorbs = t.columns.contains("absorb");
  for (std::size_t i = 0; i < t.angle.size(); ++i) {
    CoatingRow r{t.angle[i],
                 share_at(t, i, "reflect", "reflect_s"),
                 share_at(t, i, "reflect", "reflect_p"),
                 share_at(t, i, "transmit", "transmit_s"),
                 share_at(t, i, "transmit", "transmit_p"),
                 share_at(t, i, "scatter", "")};
    double const absorbed = share_at(t, i, "absorb", ""), degrees = t.angle[i] * 180 / pi;
    if (absorbs) r.scatter = 1 - 0.5 * (r.reflect_s + r.reflect_p + r.transmit_s + r.transmit_p) - absorbed;
    double const least = std::min({r.reflect_s, r.reflect_p, r.transmit_s, r.transmit_p, r.scatter + 1e-9, absorbed});
    double const sum =
        absorbed + std::max(r.reflect_s + r.transmit_s, r.reflect_p + r.transmit_p) + (absorbs ? 0 : r.scatter);
    if (!std::isfinite(sum) || !std::isfinite(least) || std::isnan(degrees)) return {};
    if (i > 0 && !(t.angle[i] > t.angle[i - 1]))
      row_problem(node, t, i,
                  fmt::format("angle {:.6g} deg does not come after {:.6g} deg", degrees, t.angle[i - 1] * 180 / pi),
                  "sort the rows by increasing angle of incidence");
    else if (least < 0 || sum > 1 + 1e-9)
      row_problem(
          node, t, i,
          fmt::format("the coating violates energy conservation: at {:.6g} deg it reflects {:.6g}, transmits {:.6g} "
                      "and scatters {:.6g}",
                      degrees, 0.5 * (r.reflect_s + r.reflect_p), 0.5 * (r.transmit_s + r.transmit_p), r.scatter),
          "no share may be negative, and for s and p each they must not exceed 1 together");
    else {
      r.scatter = std::max(0.0, r.scatter);
      rows.push_back(r);
      continue;
    }
    return {};
  }
  return rows;
}

bool check_columns(Node const& node, ShareTable const& t) {
  for (std::string const share : {"reflect", "transmit"}) {
    bool const s = t.columns.contains(share + "_s"), p = t.columns.contains(share + "_p");
    if (s != p || (s && t.columns.contains(share))) {
      node.problem(fmt::format("'{0}' is given for one polarisation only, or twice", share),
                   fmt::format("give '{0}', or '{0}_s' and '{0}_p'", share));
      return false;
    }
  }
  if (t.columns.contains("scatter") && t.columns.contains("absorb")) {
    node.problem("'scatter' and 'absorb' set the same share twice", "keep one; the other is the remainder");
    return false;
  }
  return true;
}

// The part of the table for one wavelength.
ShareTable rows_at(ShareTable const& t, double wavelength) {
  ShareTable part;
  part.file = t.file;
  for (std::size_t i = 0; i < t.angle.size(); ++i) {
    if (!same_wavelength(t.wavelength[i], wavelength)) continue;
    part.angle.push_back(t.angle[i]);
    for (auto const& [name, column] : t.columns) part.columns[name].push_back(column[i]);
    if (i < t.line.size()) part.line.push_back(t.line[i]);
  }
  return part;
}

// Rows of one wavelength, checked; empty after a problem.
std::vector<CoatingRow> checked_rows(Node const& node, ShareTable const& table) {
  auto rows = rows_of(node, table);
  if (rows.empty()) return rows;
  if (rows.size() >= 2 && rows.front().angle >= 0 && rows.front().angle <= 15 * degree &&
      std::fabs(rows.back().angle - pi / 2) <= 1e-9)
    return rows;
  std::string const at = table.wavelength.empty() ? "" : fmt::format(" at {:.6g} nm", table.wavelength.front() * 1e9);
  node.problem(fmt::format("the table runs from {:.6g} to {:.6g} deg{}", rows.front().angle / degree,
                           rows.back().angle / degree, at),
               "begin at 15 deg or below, and end at 90 deg: there every smooth surface reflects all");
  return {};
}

// Between two wavelengths, at every angle that one of them has: shares are mixed, which conserves power.
std::vector<CoatingRow> mixed(std::vector<CoatingRow> const& low, std::vector<CoatingRow> const& high, double share,
                              bool scatters) {
  Storage storage;
  Coating const a = make_coating(low, scatters, storage), b = make_coating(high, scatters, storage);
  std::vector<double> angles;
  for (auto const* rows : {&low, &high})
    for (CoatingRow const& r : *rows) angles.push_back(r.angle);
  std::ranges::sort(angles);
  angles.erase(std::unique(angles.begin(), angles.end(), [](double x, double y) { return y - x < 1e-9; }),
               angles.end());
  std::vector<CoatingRow> rows;
  for (double const angle : angles) {
    double const cosine = angle >= pi / 2 - 1e-9 ? 0 : std::cos(angle);
    auto const x = a.table.at(cosine), y = b.table.at(cosine);
    double share_of[Coating::columns];
    for (int i = 0; i < Coating::columns; ++i)
      share_of[i] = std::max(0.0, (1 - share) * x.value[i] + share * y.value[i]);
    rows.push_back({angle, share_of[Coating::reflect_s], share_of[Coating::reflect_p], share_of[Coating::transmit_s],
                    share_of[Coating::transmit_p], share_of[Coating::scatter]});
  }
  return rows;
}

// Every wavelength of the table is checked; that of the light picks, linear between two of them.
std::vector<CoatingRow> rows_for_light(Node const& node, ShareTable const& table, double light, bool scatters) {
  if (table.wavelength.empty()) return checked_rows(node, table);
  std::map<double, std::vector<CoatingRow>> known;
  for (double const wavelength : table.wavelength) {
    bool const seen =
        std::ranges::any_of(known, [&](auto const& entry) { return same_wavelength(entry.first, wavelength); });
    if (seen) continue;
    ShareTable part = rows_at(table, wavelength);
    part.wavelength = {wavelength};
    auto rows = checked_rows(node, part);
    if (rows.empty()) return {};
    known[wavelength] = std::move(rows);
  }
  auto above = known.begin();
  while (above != known.end() && above->first < light && !same_wavelength(above->first, light)) ++above;
  if (above != known.end() && same_wavelength(above->first, light)) return above->second;
  if (above == known.begin() || above == known.end()) {
    node.problem(fmt::format("the light has {:.6g} nm, and the table covers {:.6g} to {:.6g} nm", light * 1e9,
                             known.begin()->first * 1e9, known.rbegin()->first * 1e9),
                 "add rows for the wavelength of the beams, or remove the column if it has no effect");
    return {};
  }
  auto const below = std::prev(above);
  return mixed(below->second, above->second, (light - below->first) / (above->first - below->first), scatters);
}

std::optional<Coating> coating_table(Node const& node, World& world) {
  ShareTable const table = read_share_table(node);
  node.has("source");
  node.refuse_unknown("'coating'");
  if (table.angle.empty() || !check_columns(node, table)) return {};
  for (double const wavelength : table.wavelength)
    if (!(wavelength > 0)) {
      node.problem("a wavelength that is not above 0", "write the wavelength in vacuum, such as 1064 nm");
      return {};
    }
  bool const scatters = table.columns.contains("scatter") || table.columns.contains("absorb");
  auto const rows = rows_for_light(node, table, world.wavelength, scatters);
  if (rows.empty()) return {};
  return make_coating(rows, scatters, world.storage);
}

std::optional<Coating> coating_preset(Node const& node, World& world) {
  std::vector<std::string> names;
  for (CoatingPreset const& p : coating_presets()) {
    if (node.text() == p.name) return make_coating(p.rows, true, world.storage);
    names.emplace_back(p.name);
  }
  node.problem(fmt::format("coating '{}' is not defined", node.text()),
               did_you_mean(node.text(), names,
                            fmt::format("write '{}' or a table {{angle: ..., reflect: ...}}", names.front())));
  return {};
}

// Empty after a problem.
std::optional<Coating> read_coating(Node const& specular, World& world) {
  Node const c = specular["coating"];
  return c.kind() == Node::Kind::scalar ? coating_preset(c, world) : coating_table(specular.table("coating"), world);
}

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
      if (s.has("extinction")) s.problem("'extinction' needs 'index'", "give 'index', the real part, too");
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
        entry.problem("a layer is a list of index and thickness",
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

void set_interface(Optic& optic, PoolRef ref) {
  optic.has_interface = true;
  optic.interface = ref;
}

// Direction of the grooves: `around` the axis of the shape, or of the scene.
bool read_groove_direction(Node const& grating, Optic& optic) {
  Node const node = grating["grooves"];
  if (!node) {
    grating.problem("key 'grooves' (their direction) is missing",
                    "write grooves: around, or a direction of the scene, grooves: [0, 1, 0]");
    return false;
  }
  if (node.kind() == Node::Kind::scalar) {
    static constexpr std::string_view words[] = {"around"};
    optic.lay = Lay::around;
    return grating.choice("grooves", words) == "around";
  }
  auto const given = read_direction(node);
  optic.lay = Lay::given;
  optic.lay_direction = given.value_or(Vec3{0, 1, 0});
  return given.has_value();
}

// One row of `orders`; false after a problem.
bool read_order(Node const& row, Grating& grating) {
  if (row.kind() != Node::Kind::table) {
    row.problem("an order is a table", "write {order: -1, reflect: 90 %}");
    return false;
  }
  GratingOrder o{row.number("order", dim::plain, required, -1000, 1000), row.number("reflect", dim::plain, 0, 0, 1),
                 row.number("transmit", dim::plain, 0, 0, 1)};
  row.refuse_unknown("an order of a grating");
  if (!std::isfinite(o.order + o.reflect + o.transmit)) return false;
  if (o.order != std::floor(o.order)) {
    row["order"].problem(fmt::format("order {:g} is not a whole number", o.order), "write -1, 0, 1, 2 ...");
    return false;
  }
  for (std::int64_t i = 0; i < grating.count; ++i)
    if (grating.order[i].order == o.order) {
      row.problem(fmt::format("order {:g} is there twice", o.order), "give 'reflect' and 'transmit' in one row");
      return false;
    }
  if (std::fabs(o.order) * grating.turn >= 2)
    row.warning(
        fmt::format("order {:g} propagates in vacuum at no incidence: its efficiency counts as absorbed", o.order),
        "check the sign of the exponent of 'density', or remove the order");
  grating.order[grating.count++] = o;
  return true;
}

void read_grating(Node const& node, World& world, Optic& optic) {
  Grating grating;
  if (node.has("density") == node.has("period")) {
    node.problem(node.has("period") ? "'density' and 'period' both set the distance of the lines"
                                    : "a grating needs 'density' or 'period'",
                 "write density: 1200 /mm, or period: 833 nm");
    grating.density = not_a_number;
  } else if (node.has("density")) {
    grating.density = node.number("density", dim::per_metre, required, 1e-3, 1e9);
  } else {
    grating.density = 1 / node.number("period", dim::length, required, 1e-9, 1e3);
  }
  grating.turn = grating.density * world.wavelength;
  bool whole = std::isfinite(grating.turn) && read_groove_direction(node, optic);
  auto const rows = node.list("orders");
  if (rows.empty() || rows.size() > std::size_t(Grating::most_orders)) {
    node.problem(rows.empty() ? "a grating needs the efficiencies of its orders"
                              : fmt::format("more than {} orders", int(Grating::most_orders)),
                 "write orders: [{order: 0, reflect: 5 %}, {order: -1, reflect: 90 %}]");
    whole = false;
  } else {
    for (Node const& row : rows) whole = read_order(row, grating) && whole;
  }
  node.refuse_unknown("'grating'");
  double const sum = grating.reflectance() + grating.transmittance();
  if (sum > 1 + 1e-9) {
    node.problem(fmt::format("the grating violates energy conservation: its orders carry {:.6g} of the light", sum),
                 "lower some of them; the remainder is absorbed");
    whole = false;
  }
  if (!whole) return;
  set_interface(optic, world.add_interface(grating));
  optic.diffracts = true;
}

void read_fixed(Node const& s, Optic& optic) {
  optic.reflect = s.number("reflect", dim::plain, 0, 0, 1);
  optic.transmit = s.number("transmit", dim::plain, 0, 0, 1);
}

void read_word(Node const& s, World& world, Optic& optic) {
  static constexpr std::string_view known = "write 'fresnel', 'absorber', or a table such as {reflect: 99 %}";
  if (s.text() == "fresnel")
    set_interface(optic, world.add_interface(Fresnel{}));
  else if (s.text() != "absorber")
    s.problem(fmt::format("interface '{}' is not defined", s.text()), std::string(known));
}

}  // namespace

void read_specular(Node const& material, World& world, Registry const& names, Optic& optic) {
  Node const s = material["specular"];
  if (!s) return;
  if (s.kind() == Node::Kind::scalar) return read_word(s, world, optic);
  Node const table = material.table("specular");
  if (!table) return;
  Reader const reader{world, names};
  bool const fixed = s.has("reflect") || s.has("transmit"), film = s.has("film"), coating = s.has("coating"),
             grating = s.has("grating");
  bool const index = s.has("index") || s.has("extinction");
  if (fixed + film + coating + grating > 1 || (index && (fixed || coating || grating)))
    s.problem("two descriptions of one interface",
              "keep one: 'reflect' and 'transmit', 'film' (with or without 'index'), 'index', 'coating' or 'grating'");
  else if (film)
    set_interface(optic, reader.film(s.table("film"), reader.opaque(s)));
  else if (index)
    set_interface(optic, world.add_interface(Fresnel{reader.opaque(s)}));
  else if (coating) {
    auto const made = read_coating(s, world);
    if (made) set_interface(optic, world.add_interface(*made));
  } else if (grating) {
    read_grating(s.table("grating"), world, optic);
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
        "the coating states the total scatter",
        "give one BSDF model without a weight, whose total is then ignored, or remove 'scatter' or 'absorb' there");
    return;
  }
  if (optic.lay != Lay::free)
    return material.problem("the coating states the total scatter, but scatter by grooves depends on direction",
                            "remove 'scatter' or 'absorb' of the coating, or use another BSDF model");
  SpecularPool const interfaces = world.view().interfaces;
  AngleWeight const weight = weight_for_share(
      world.view().laws, optic.law[0], [&](double cosine) { return prescribed_scatter(interfaces, optic, cosine); });
  optic.weight[0] = world.storage.keep(std::vector<AngleWeight>{weight});
}

}  // namespace straytrace::world
