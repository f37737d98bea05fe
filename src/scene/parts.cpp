// SPDX-License-Identifier: BSD-3-Clause
#include "scene/parts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace straytrace {
namespace {

// `limits` and `words` are about parameters of the part.
void check_limits(Node const& part) {
  Node const params = part["params"];
  for (char const* key : {"limits", "words"})
    for (auto const& [name, node] : part.table(key).items()) {
      if (!params.has(name))
        node.problem(fmt::format("'{}' is not a parameter of the part", name), "name one of its 'params'");
      if (node.kind() != Node::Kind::table || std::string_view(key) == "words") continue;
      for (char const* known : {"above", "at_least", "at_most", "because"}) node.has(known);
      node.refuse_unknown(fmt::format("the limits of '{}'", name));
    }
}

}  // namespace

bool is_entry_key(std::string_view key) {
  return std::find(entry_keys.begin(), entry_keys.end(), key) != entry_keys.end();
}

bool name_allowed(Node const& at, std::string const& name) {
  bool const bad =
      name.empty() || std::any_of(name.begin(), name.end(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || std::string_view("/*[]>\"'").find(c) != std::string_view::npos;
      });
  if (bad)
    at.problem(fmt::format("'{}' cannot be a name", shortened(name)), "leave out the characters / * [ ] > and quotes");
  return !bad;
}

void check_parts(SceneDocument& document, Node const& parts) {
  for (auto const& [name, part] : parts.items()) {
    if (part.kind() != Node::Kind::table) {
      if (part)
        part.problem(fmt::format("part '{}' needs a table with 'faces'", name),
                     "write '{faces: {front: {shape: ...}}}'");
      continue;
    }
    bool const named = name_allowed(part, name);
    Node const faces = part.table("faces"), params = part.table("params");
    if (named && !part.has("faces"))
      part.problem(fmt::format("part '{}' has no faces", name),
                   "add 'faces: {front: {shape: {disk: {outer_radius: 10 cm}}}}'");
    else if (faces.kind() == Node::Kind::table && faces.items().empty())
      faces.problem(fmt::format("part '{}' has no faces", name), "add 'front: {shape: ...}'");
    for (auto const& [face, data] : faces.items()) {
      if (!name_allowed(data, face)) continue;
      if (data.kind() != Node::Kind::table && data)
        data.problem(fmt::format("face '{}' needs a table of keys", face), "write '{shape: {...}, material: ...}'");
    }
    if (params.kind() == Node::Kind::table)
      for (NodeData::Entry const& p : params.data()->entries)
        if (is_entry_key(p.key))
          document.add({p.place,
                        fmt::format("'{}' is a key of every scene entry and cannot name a parameter of a part", p.key),
                        "choose another name", Severity::error, p.width});
    check_limits(part);
    for (char const* known : {"note", "source", "medium"}) part.has(known);
    part.refuse_unknown(fmt::format("part '{}'", name));
  }
}

std::size_t FaceCounter::count(Node const& use, std::size_t limit) {
  std::string const& name = use.text();
  if (auto const hit = done_.find(name); hit != done_.end()) return hit->second;
  bool const circle = std::find(chain_.begin(), chain_.end(), name) != chain_.end();
  if (circle || chain_.size() >= deepest_part) {
    use.problem(circle ? fmt::format("part '{}' contains itself", name)
                       : fmt::format("parts are nested more than {} deep", deepest_part),
                "use another part here");
    return 0;
  }
  Node const faces = parts_[name]["faces"];
  if (faces.kind() != Node::Kind::table) return 1;  // reported where it is written or used
  chain_.push_back(name);
  std::size_t sum = 0;
  bool sound = true;
  for (auto const& [face, data] : faces.items()) {
    Node const inner = data.kind() == Node::Kind::table ? data["use"] : Node();
    std::size_t const n = inner ? count(inner, limit) : 1;
    sound = sound && n > 0;
    sum = std::min(limit + 1, sum + n);
  }
  chain_.pop_back();
  return done_[name] = sound ? sum : 0;
}

}  // namespace straytrace
