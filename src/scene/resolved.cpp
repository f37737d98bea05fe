// SPDX-License-Identifier: BSD-3-Clause
#include "scene/resolved.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/document.hpp"
#include "scene/axes.hpp"
#include "scene/merge.hpp"
#include "scene/scope.hpp"

namespace straytrace {
namespace {

// One line in flow style.
std::string flow(NodeData const& n) {
  if (n.kind == Node::Kind::scalar) return yaml_text(n.text);
  std::string out;
  for (NodeData::Entry const& e : n.entries)
    out += fmt::format("{}{}: {}", out.empty() ? "" : ", ", yaml_text(e.key), flow(*e.value));
  for (auto const& e : n.elements) out += fmt::format("{}{}", out.empty() ? "" : ", ", flow(*e));
  if (n.kind == Node::Kind::list) return "[" + out + "]";
  return n.kind == Node::Kind::table ? "{" + out + "}" : "\"?\"";
}

std::string section(std::string const& key, NodeData const& n) {
  std::string out = yaml_text(key) + ":";
  if (n.kind == Node::Kind::scalar || (n.entries.empty() && n.elements.empty()))
    return fmt::format("{} {}\n", out, flow(n));
  out += '\n';
  for (NodeData::Entry const& e : n.entries) out += fmt::format("  {}: {}\n", yaml_text(e.key), flow(*e.value));
  for (auto const& e : n.elements) out += fmt::format("  - {}\n", flow(*e));
  return out;
}

std::string instance_line(Scene::Instance const& i, Scope const* model) {
  std::string out = fmt::format("  - {{name: {}, group: {}", yaml_text(i.name), yaml_text(i.group));
  if (i.repeat_axis >= 0) out += fmt::format(", {}: {} m", axes[static_cast<std::size_t>(i.repeat_axis)], i.offset);
  Scope const* own = i.node.scope().get();
  if (own && own != model)
    for (auto const& [name, value] : own->own) out += fmt::format(", {}: {}", name, si_text(value));
  return out + "}\n";
}

}  // namespace

std::string yaml_text(std::string const& text) {
  constexpr std::string_view not_first = "-?:,[]{}#&*!|>'\"%@`~=<. ", nowhere = ":#,[]{}\"'";
  bool const control =
      std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
  bool const special = text.empty() || control || not_first.find(text.front()) != std::string_view::npos ||
                       text.back() == ' ' || text.find_first_of(nowhere) != std::string::npos || text == "null" ||
                       text == "Null" || text == "NULL";
  if (!special) return text;
  std::string out = "\"";
  for (char const c : text) {
    if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else if (c == '"' || c == '\\')
      out += {'\\', c};
    else
      out += c;
  }
  return out + '"';
}

std::string si_text(std::optional<Value> const& value) {
  if (!value) return "\"?\"";
  Quantity const& q = value->quantity;
  std::string text = with_unit(fmt::format("{}", q.si), dim::plain);
  if (q.dimension == dim::angle)
    text += " rad";  // the example unit of angles is not the SI unit
  else
    text = with_unit(text, q.dimension);
  switch (q.amplitude) {
    case Amplitude::peak:
      return text + " peak";
    case Amplitude::peak_to_peak:
      return text + " pp";
    case Amplitude::rms:
      return text + " rms";
    case Amplitude::none:
      break;
  }
  return text;
}

std::string resolved_text(Node const& root, std::vector<Scene::Instance> const& instances) {
  Scope const* model = root.scope().get();
  std::string out = "straytrace: 1\n";
  if (!root.data()) return out;
  std::vector<NodeData::Entry> entries = root.data()->entries;
  auto const rank = [](NodeData::Entry const& e) {
    return e.key == "title" ? 0 : e.key == "notes" ? 1 : e.key == "params" ? 2 : 3;
  };
  std::stable_sort(entries.begin(), entries.end(), [&](auto const& a, auto const& b) { return rank(a) < rank(b); });
  for (NodeData::Entry const& e : entries) {
    if (e.key != "params") {
      NodeData own = *e.value;
      if (e.key == "parts")
        std::erase_if(own.entries,
                      [&](auto const& part) { return part.place.file == builtin_source(root.place().file); });
      if (e.key != "parts" || !own.entries.empty()) out += section(e.key, own);
      continue;
    }
    out += "params:\n";
    for (NodeData::Entry const& p : e.value->entries)
      out += fmt::format("  {}: {}\n", yaml_text(p.key), si_text(find_parameter(model, p.key).value));
  }
  if (!instances.empty()) out += "instances:\n";
  for (Scene::Instance const& i : instances) out += instance_line(i, model);
  return out;
}

}  // namespace straytrace
