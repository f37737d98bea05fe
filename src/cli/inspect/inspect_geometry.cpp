// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <set>

#include "base/errors.hpp"
#include "base/text/json_text.hpp"
#include "base/units/quantity.hpp"
#include "cli/inspect/inspect.hpp"
#include "report/scene_picture.hpp"
#include "results/curves/curve_file.hpp"
#include "results/text/picture.hpp"
#include "world/import/geometry_file.hpp"

namespace straytrace::cli {
namespace {

std::string last_piece(std::string const& name) { return name.substr(name.rfind('/') + 1); }

std::string faces_text(GeometryPart const& p) {
  std::string out;
  for (auto const& [kind, n] : p.faces) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", n, kind);
  return out;
}

// "dump_1" and "dump_2" are one rule, "dump*".
std::vector<std::string> patterns_of(std::vector<GeometryPart> const& parts) {
  std::map<std::string, std::set<std::string>> by_stem;
  std::vector<std::string> order;
  for (GeometryPart const& p : parts) {
    std::string const name = last_piece(p.name);
    std::string stem = name;
    while (!stem.empty() && (std::isdigit(static_cast<unsigned char>(stem.back())) || stem.back() == '_'))
      stem.pop_back();
    if (stem.empty()) stem = name;
    if (by_stem[stem].empty()) order.push_back(stem);
    by_stem[stem].insert(name);
  }
  std::vector<std::string> patterns;
  for (std::string const& stem : order)
    patterns.push_back(by_stem[stem].size() > 1 ? stem + "*" : *by_stem[stem].begin());
  return patterns;
}

std::string quoted(std::string const& text) { return json_text(nlohmann::json(text)); }

// Ready to paste into a scene.
std::string entry(std::string const& file, GeometryFile const& g, std::string const& units) {
  std::string const unit = !units.empty() ? units : g.unit_known ? "from_file" : "mm";
  std::string out = fmt::format(
      "scene:\n  - name: NAME\n    file: {}\n    units: {}\n    at: [0 m, 0 m, 0 m]\n    body: BODY\n    surfaces:\n",
      quoted(file), unit);
  for (std::string const& p : patterns_of(g.parts)) out += fmt::format("      {}: MATERIAL\n", quoted(p));
  std::set<std::string> colours;
  for (GeometryPart const& p : g.parts)
    if (!p.colour.empty()) colours.insert(p.colour);
  for (std::string const& c : colours) out += fmt::format("      # or by colour: \"color {}\": MATERIAL\n", c);
  return out + "      default: MATERIAL\n    # lenses and windows: medium: {\"PART\": fused_silica}\n";
}

void print_text(std::string const& file, GeometryFile const& g, std::string const& units) {
  std::cout << fmt::format(
      "{}: {}\nunit   {}\nsize   {}, from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) {}\n", file, g.format,
      g.unit, g.unit_known ? size_text(g.box, 1) : "see unit", g.box.lower.x, g.box.lower.y, g.box.lower.z,
      g.box.upper.x, g.box.upper.y, g.box.upper.z, g.unit_known ? "m" : "in the unit of the file");
  std::size_t width = 30;
  for (GeometryPart const& p : g.parts) width = std::max(width, p.name.size());
  std::cout << fmt::format("\n{:<{}}  {:<9}{:>12}  faces\n", "part", width, "colour",
                           g.unit_known ? "area [m2]" : "area");
  for (GeometryPart const& p : g.parts)
    std::cout << fmt::format("{:<{}}  {:<9}{:>12.6g}  {}{}{}\n", p.name, width, p.colour.empty() ? "-" : p.colour,
                             p.area, faces_text(p), p.material.empty() ? "" : ", material '" + p.material + "'",
                             p.closed.empty() ? "" : ", " + p.closed);
  for (MeshFault const& n : g.notes) std::cout << fmt::format("\nnote: {}\n      {}\n", n.what, n.suggestion);
  std::cout << "\nIntersections of parts are not checked. For a scene:\n\n" << entry(file, g, units);
}

void print_json(std::string const& file, GeometryFile const& g, std::string const& units) {
  auto const triple = [](Vec3 v) { return nlohmann::json{v.x, v.y, v.z}; };
  nlohmann::json parts = nlohmann::json::array(), notes = nlohmann::json::array();
  for (GeometryPart const& p : g.parts)
    parts.push_back({{"name", p.name},
                     {"material", p.material},
                     {"colour", p.colour},
                     {"faces", p.faces},
                     {"area", p.area},
                     {"closed", p.closed}});
  for (MeshFault const& n : g.notes) notes.push_back({{"what", n.what}, {"suggestion", n.suggestion}});
  std::cout << json_text(nlohmann::json{{"file", file},
                                        {"format", g.format},
                                        {"unit", g.unit},
                                        {"unit_known", g.unit_known},
                                        {"lower", triple(g.box.lower)},
                                        {"upper", triple(g.box.upper)},
                                        {"parts", parts},
                                        {"notes", notes},
                                        {"entry", entry(file, g, units)}})
            << '\n';
}

// From above and in front, z up as in CAD programs.
void draw(GeometryFile const& g, std::string const& plot, PrintOptions const& options) {
  constexpr double field = pi / 6;
  Vec3 const middle = 0.5 * (g.box.lower + g.box.upper);
  double const reach = 0.5 * length(g.box.upper - g.box.lower) / std::sin(field / 2);
  Camera const camera = looking_at(middle + reach * unit({0.5, -0.8, 0.6}), middle, {0, 0, 1}, field, 1000, 750);
  LookSettings settings{{}, looks_of(g.world.view()), 0};
  std::fill(settings.looks.begin(), settings.looks.end(), Look::solid);
  Drawn const drawn = draw_shaded(g.world, camera, settings);
  write_png(plot, {camera.columns, camera.rows, drawn.rgb});
  if (options.json()) return;
  std::cout << "\npicture: " << plot << '\n';
  for (LegendEntry const& e : drawn.legend) std::cout << fmt::format("  {} {:7} {}\n", e.colour, e.name, e.what);
}

}  // namespace

int inspect_geometry(std::string const& file, std::string const& units, std::string const& plot,
                     PrintOptions const& options) {
  if (!plot.empty()) check_ending(plot, {".png"}, "--plot");
  GeometryFile const g = read_geometry(file, units == "from_file" ? "" : units);
  std::string const name = std::filesystem::path(file).filename().string();
  if (options.json())
    print_json(name, g, units);
  else
    print_text(name, g, units);
  if (!plot.empty()) draw(g, plot, options);
  return done;
}

}  // namespace straytrace::cli
