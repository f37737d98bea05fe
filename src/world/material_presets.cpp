// SPDX-License-Identifier: BSD-3-Clause
#include "world/material_presets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/embedded.hpp"
#include "base/uncertainty.hpp"
#include "scene/library.hpp"

namespace straytrace {
namespace {

// One value, or low, mid, high.
bool read_case_values(Node const& node, Dimension dimension, double (&into)[3]) {
  if (node.kind() == Node::Kind::list) {
    auto const given = node.as_numbers(dimension, 3);
    if (given.size() != 3) return false;
    std::copy(given.begin(), given.end(), into);
  } else {
    std::fill(into, into + 3, node.as_number(dimension));
  }
  if (into[0] >= 0 && into[0] <= into[1] && into[1] <= into[2]) return true;
  if (node.healthy())
    node.problem("a bracket is low, mid, high, in this order", "write [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]");
  return false;
}

std::vector<MaterialPreset> presets_of_library() {
  FileTexts texts;
  std::string include;
  for (EmbeddedFile const& file : embedded_files())
    if (file.name.starts_with("library/materials/")) {
      texts[std::string(file.name)] = file.text;
      include += (include.empty() ? "" : ", ") + std::string(file.name);
    }
  texts["presets"] = fmt::format("straytrace: 1\ninclude: [{}]\nscene: [{{name: all, file: all}}]\n", include);
  Scene const scene = read_scene("presets", {}, &texts);
  std::vector<MaterialPreset> all;
  for (auto const& [name, node] : scene.table("materials").items())
    if (Node const table = node["preset"]; table.kind() == Node::Kind::table)
      if (auto const preset = read_preset_numbers(name, table)) all.push_back(*preset);
  return all;
}

}  // namespace

std::optional<MaterialPreset> read_preset_numbers(std::string const& name, Node const& table) {
  using Gives = MaterialPreset::Gives;
  MaterialPreset p;
  p.name = name;
  p.status = read_status(table);
  p.wavelength = table.word("wavelength", "wavelength not given");
  p.source = table.word("source", "source not given");
  if (table.has("note")) p.note = table.word("note");
  bool const brdf = table.has("brdf"), tis = table.has("tis"), at_75 = table.has("tis_at_75_deg");
  bool const mirror = !brdf && !tis && table.has("reflect");
  if (!brdf && !tis && !mirror) {
    table.problem("a table 'preset' has numbers", "write {brdf: [1e-3 /sr, 3e-3 /sr, 1e-2 /sr]}, 'tis' or 'reflect'");
    return {};
  }
  p.gives = brdf ? Gives::brdf : mirror ? Gives::reflect : at_75 ? Gives::tis_75 : Gives::tis;
  bool whole = read_case_values(table[brdf     ? "brdf"
                                      : mirror ? "reflect"
                                               : "tis"],
                                brdf ? dim::brdf : dim::plain, p.values);
  if (p.gives == Gives::tis_75) whole = read_case_values(table["tis_at_75_deg"], dim::plain, p.at_75) && whole;
  if (!mirror) p.reflect = table.number("reflect", dim::plain, 0, 0, 1);
  p.through = table.number("through", dim::plain, 0, 0, 1);
  table.refuse_unknown("'preset'");
  return whole ? std::optional(p) : std::nullopt;
}

std::span<MaterialPreset const> material_presets() {
  static std::vector<MaterialPreset> const all = presets_of_library();
  return all;
}

}  // namespace straytrace
