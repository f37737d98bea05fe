// SPDX-License-Identifier: BSD-3-Clause
#include "app/model_json.hpp"

#include <array>
#include <cmath>
#include <set>

namespace straytrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<char const*, 11> form_names{"named",  "number", "whole", "amplitude", "quantity", "word",
                                                 "choice", "switch", "table", "list",      "numbers"};

Json asked_as_json(Asked const& how, bool by_key) {
  Json out;
  auto const form = std::size_t(how.form);
  out["type"] = form_names[form];
  bool const number = form >= std::size_t(Asked::Form::number) && form <= std::size_t(Asked::Form::quantity);
  if (number || how.form == Asked::Form::numbers) {
    out["dimension"] = how.form == Asked::Form::quantity ? "any" : name_of(how.dimension);
    out["units"] = how.form == Asked::Form::quantity ? "" : accepted_units(how.dimension);
    out["unit"] = example_unit(how.dimension);
  }
  if (std::isfinite(how.low)) out["low"] = how.low;
  if (std::isfinite(how.high)) out["high"] = how.high;
  if (number && std::isfinite(how.fallback)) out["default"] = how.fallback;
  if (!how.word.empty()) out["default"] = how.word;
  if (how.count > 0) out["count"] = how.count;
  if (!how.choices.empty()) out["choices"] = how.choices;
  bool const one = (how.form == Asked::Form::word || how.form == Asked::Form::choice) && how.word.empty();
  if (by_key && (one || how.form == Asked::Form::amplitude || (number && std::isnan(how.fallback))))
    out["required"] = true;
  return out;
}

Json value_as_json(ModelValue const& v) {
  Json out;
  if (!v.key.empty()) out["key"] = v.key;
  if (v.given())
    out["from"] = v.origin;
  else
    out["from"] = "default";
  if (v.kind == Node::Kind::scalar && v.written != v.value) out["written"] = v.written;
  if (v.kind == Node::Kind::scalar || !v.value.empty()) out["value"] = v.value;
  if (v.quantity && std::isfinite(v.quantity->si)) out["si"] = v.quantity->si;
  out["asked"] = asked_as_json(v.how, v.by_key);
  if (!v.role.empty()) out["role"] = v.role;
  if (v.listed) out["names"] = true;
  if (v.kind != Node::Kind::table && v.kind != Node::Kind::list) return out;
  Json& children = out[v.kind == Node::Kind::table ? "keys" : "elements"] = Json::array();
  for (ModelValue const& c : v.children) children.push_back(value_as_json(c));
  return out;
}

}  // namespace

Json model_as_json(Scene const& scene) {
  Json out{{"file", scene.main_file()}, {"model", value_as_json(model_tree(scene))}};
  Json& placed = out["placed"] = Json::array();
  std::set<std::string> told;
  for (PlacedValue const& p : placed_values(scene)) {
    if (!told.insert(p.group).second) continue;
    placed.push_back({{"group", p.group}, {"first", p.name}, {"face", value_as_json(p.face)}});
  }
  return out;
}

}  // namespace straytrace
