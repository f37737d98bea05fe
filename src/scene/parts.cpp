// SPDX-License-Identifier: BSD-3-Clause
#include "scene/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace straytrace::scene {
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

bool is_entry_key(std::string_view key) { return std::ranges::find(entry_keys, key) != entry_keys.end(); }

bool name_allowed(Node const& at, std::string const& name) {
  bool const bad =
      name.empty() || std::ranges::any_of(name, [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || std::string_view("/*[]>\"'").find(c) != std::string_view::npos;
      });
  if (bad)
    at.problem(fmt::format("'{}' is not a valid name", shortened(name)), "remove the characters / * [ ] > and quotes");
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
  bool const circle = std::ranges::find(chain_, name) != chain_.end();
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

namespace {

constexpr double rounding = 1e-12;  // relative: a lens may be exactly as wide as its sphere

struct Rule {
  std::string_view key, in_words;
  int sign;  // +1: the value is not below the bound
};
constexpr std::array rules{Rule{"above", "more than", 1}, Rule{"at_least", "at least", 1},
                           Rule{"at_most", "at most", -1}};

bool keeps(Rule const& rule, double value, double bound) {
  double const over = rule.sign * (value - bound);
  return rule.key == "above" ? over > 0 : over >= -rounding * std::fabs(bound);
}

// In a common unit, with four digits, rounded so that the printed value is allowed.
std::string readable(double si, Dimension d, int sign) {
  double const unit = d == dim::length && std::fabs(si) < 1 ? 1e-3 : d == dim::angle ? pi / 180 : 1;
  double const x = si / unit;
  double const step = x == 0 ? 1 : std::pow(10, std::floor(std::log10(std::fabs(x))) - 3);
  std::string const number = fmt::format("{:.6g}", x == 0 ? 0 : sign * std::ceil(sign * x / step - 1e-9) * step);
  return unit == 1e-3 ? number + " mm" : with_unit(number, d);
}

}  // namespace

bool within_limits(Node const& entry, std::string const& name, Node const& part,
                   std::shared_ptr<Scope const> const& scope) {
  Node const limits = part["limits"];
  if (limits.kind() != Node::Kind::table) return true;
  for (auto const& [parameter, limit] : limits.items()) {
    auto const value = find_parameter(scope.get(), parameter).value;
    if (!value || limit.kind() != Node::Kind::table) continue;  // reported already
    for (Rule const& rule : rules) {
      if (!limit.has(rule.key)) continue;
      Node const written = limit[rule.key];
      Quantity const bound = Node(written.data(), scope, limit.document()).as_quantity();
      double const is = value->quantity.si;
      if (!std::isfinite(bound.si) || keeps(rule, is, bound.si)) continue;
      Node const given = entry[parameter];
      std::string const least = readable(bound.si, bound.dimension, rule.sign);
      (given ? given : entry)
          .problem(fmt::format("'{}' of '{}' must be {} {} here, it is {}", parameter, name, rule.in_words, least,
                               readable(is, bound.dimension, 1)),
                   limit.word("because", "change it or the other parameters of the part"));
      return false;
    }
  }
  return true;
}

}  // namespace straytrace::scene
