// SPDX-License-Identifier: BSD-3-Clause
#include "world/build/file_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input/document.hpp"
#include "base/text/words.hpp"
#include "world/import/mesh_doctor.hpp"

namespace straytrace {

bool matches(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, mark = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      mark = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++mark;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

namespace {

constexpr std::string_view by_colour = "color ";

bool is_colour(std::string_view text) {
  return text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdef", 1) == text.npos;
}

std::string some_of(std::vector<std::string> const& names) {
  constexpr std::size_t shown = 8;
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < shown; ++i) out += fmt::format("{}'{}'", i ? ", " : "", names[i]);
  return names.size() > shown ? out + fmt::format(" and {} more", names.size() - shown) : out;
}

std::string last_piece(std::string const& name) { return name.substr(name.rfind('/') + 1); }

// What rules of a file can name.
std::vector<std::string> words_of(std::vector<PartLabel> const& parts) {
  std::vector<std::string> words;
  auto const add = [&](std::string const& word) {
    if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  };
  for (PartLabel const& p : parts) add(last_piece(p.name));
  for (PartLabel const& p : parts) add(p.name);
  for (PartLabel const& p : parts) add(p.material);
  for (PartLabel const& p : parts) add(p.colour.empty() ? "" : std::string(by_colour) + p.colour);
  return words;
}

}  // namespace

bool PartRules::Rule::fits(PartLabel const& part) const {
  if (!colour.empty()) return colour == part.colour;
  return matches(pattern, part.name) || matches(pattern, last_piece(part.name)) ||
         (!part.material.empty() && matches(pattern, part.material));
}

void PartRules::add(std::string const& pattern, Node const& says, bool complain) {
  Rule rule{pattern, "", says};
  std::string const low = lower_case(pattern);
  if (low.starts_with(by_colour) || low.starts_with("colour ")) {
    rule.colour = low.substr(low.find(' ') + 1);
    if (!is_colour(rule.colour)) {
      if (complain)
        says.problem(fmt::format("'{}' is not a colour", shortened(pattern)),
                     "write \"color #rrggbb\", as inspect prints it");
      rule.used = true;
    }
  }
  rules_.push_back(std::move(rule));
}

PartRules::PartRules(Scene::Instance const& instance, std::string_view key, bool first_time) {
  bool const materials = key == "surfaces";
  Node const table = instance.node.has(key) ? instance.node[key] : instance.placement[key];
  bool const rows = table && table.kind() == Node::Kind::table;
  if (table && !rows && materials)
    table.problem("'surfaces' names a material for each part", "write {\"dump*\": NAME, default: NAME}");
  if (rows)
    for (auto const& [pattern, node] : table.items())
      if (pattern != "default") add(pattern, node, first_time);
  if (rows && table.has("default")) rules_.push_back({"*", "", table["default"], true});
  if (!materials) return;
  Node const material = instance.node.has("material") ? instance.node["material"] : instance.placement["material"];
  if (material) rules_.push_back({"*", "", material, true});  // of everything not named
}

Node PartRules::of(PartLabel const& part) {
  Rule* chosen = nullptr;
  for (Rule& rule : rules_) {
    if (!rule.fits(part)) continue;
    rule.used = true;
    if (!chosen) chosen = &rule;
  }
  return chosen ? chosen->says : Node();
}

std::uint32_t PartRules::optic(PartLabel const& part, Registry const& names) {
  Node const material = of(part);
  if (!material) {
    std::string const shown = part.name.empty() ? part.material : part.name;
    if (std::find(bare_.begin(), bare_.end(), shown) == bare_.end()) bare_.push_back(shown);
    return names.black;
  }
  std::string const name = material.as_word();
  if (auto const hit = names.materials.find(name); hit != names.materials.end()) return hit->second;
  std::vector<std::string> known;
  for (auto const& entry : names.materials) known.push_back(entry.first);
  std::string const near = nearest_word(name, known);
  if (!name.empty())
    material.problem(
        fmt::format("material '{}' is not defined", name),
        near.empty() ? fmt::format("defined: {}", fmt::join(known, ", ")) : fmt::format("did you mean '{}'?", near));
  return names.black;
}

void PartRules::report(Scene::Instance const& instance, std::string const& name,
                       std::vector<PartLabel> const& parts) const {
  std::vector<std::string> const words = words_of(parts);
  std::string const all = words.empty() ? "it names no parts and no materials; write 'default' only"
                                        : fmt::format("it has: {}", some_of(words));
  for (Rule const& r : rules_) {
    if (r.used) continue;
    std::string const near = nearest_word(r.pattern, words);
    r.says.problem(fmt::format("no part, material or colour of '{}' matches '{}'", name, r.pattern),
                   near.empty() ? all : fmt::format("did you mean '{}'?", near));
  }
  if (bare_.empty()) return;
  instance.placement.problem(fmt::format("parts of '{}' have no material: {}", name, some_of(bare_)),
                             fmt::format("write surfaces: {{{}default: NAME}}",
                                         bare_.front().empty() ? "" : fmt::format("\"{}\": NAME, ", bare_.front())));
}

double read_file_unit(Scene::Instance const& instance, Box const& box, double stated, std::string const& source,
                      bool first_time) {
  Node const units = instance.node.has("units") ? instance.node["units"] : instance.placement["units"];
  Node const& owner = units ? units : instance.placement;
  std::string const text = units ? units.as_word() : "";
  std::string const sizes =
      fmt::format("its bounding box would be {} as mm and {} as m", size_text(box, 1e-3), size_text(box, 1));
  auto const refuse = [&](std::string const& why, std::string const& remedy) {
    if (first_time) owner.problem(why, remedy);
    return 0.0;
  };
  std::string const missing = fmt::format("'{}' has no 'units'", instance.group);
  if (!units && stated > 0) return refuse(missing, fmt::format("write units: from_file ({})", source));
  if (!units) return refuse(fmt::format("{}: {}", missing, sizes), "write units: mm");
  if (text == "from_file") return stated > 0 ? stated : refuse(fmt::format("{}: {}", source, sizes), "write units: mm");
  auto const unit = parse_unit(text);
  if (!unit || !(unit->dimension == dim::length))
    return refuse(fmt::format("'{}' is not a unit of length: {}", text, sizes), "write units: mm");
  return unit->si;
}

void warn_of_file(Node const& file, std::string const& what, std::string const& suggestion) {
  if (Document* const document = file.document())
    document->add({document->place_in_file(file, file.text(), 0, 0), what, suggestion, Severity::warning});
}

}  // namespace straytrace
